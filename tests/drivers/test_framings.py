"""Decoders of rangefinder framings against the data sheets, noise and any way of splitting."""

from __future__ import annotations

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st
from woz_drivers.lines.line_decoder import MAX_LINE
from woz_drivers.rangefinder.wire import FRAMINGS, DistanceDecoder, Measurement

from tests.fakes.rangefinder import a02, maxbotix, tfmini

ANY_BYTES = st.binary(max_size=200)
NAMES = st.sampled_from(sorted(FRAMINGS))
#: Frames of each framing, built by the fake sensor, as one stream.
STREAMS = st.one_of(
    st.tuples(
        st.just("maxbotix"),
        st.lists(st.integers(0, 999).map(maxbotix), min_size=1, max_size=8).map(b"".join),
    ),
    st.tuples(
        st.just("lines"),
        st.lists(st.integers(0, 99999).map(lambda n: b"%d mm\r\n" % n), min_size=1).map(b"".join),
    ),
    st.tuples(
        st.just("tfmini"),
        st.lists(st.builds(tfmini, st.integers(0, 0xFFFF), st.integers(0, 0xFFFF)), min_size=1).map(
            b"".join
        ),
    ),
    st.tuples(st.just("a02"), st.lists(st.integers(0, 0xFFFF).map(a02), min_size=1).map(b"".join)),
)


def decoder(name: str, unit: str = "", min_strength: int = 100, column: int = 0) -> DistanceDecoder:
    framing = FRAMINGS[name]
    return framing.decoder(unit or framing.unit, min_strength, column)


def metres(measurements: list[Measurement]) -> list[float | None]:
    return [None if m.metres is None else round(m.metres, 6) for m in measurements]


@pytest.mark.parametrize(
    ("name", "unit", "data", "expected"),
    [
        ("maxbotix", "in", b"R012\rR254\r", [0.3048, 6.4516]),
        ("maxbotix", "cm", b"R107\r", [1.07]),
        ("maxbotix", "mm", b"R0300\rR5000\r", [0.3, 5.0]),
        ("maxbotix", "in", b"R040 P1\r", [1.016]),
        ("maxbotix", "cm", b"HRXL-MaxSonar\rR12\rR12345\rr100\rR100\r", [1.0]),
        ("lines", "cm", b"1\n123\n124.5\r\n", [1.23, 1.245]),
        ("lines", "cm", b"\n1230 mm\n123.4 cm\n1,5 m\n10\"\n", [1.23, 1.234, 1.5, 0.254]),
        ("lines", "mm", b"\nDistance: 812\ndist=81 cm\n10 in\n", [0.812, 0.81, 0.254]),
        ("lines", "cm", b"\nno echo\n-1\nnan\n1e3\n12.\n", [-0.01]),
        ("tfmini", "cm", tfmini(213), [2.13]),
        ("tfmini", "mm", tfmini(213), [0.213]),
        ("tfmini", "cm", bytes.fromhex("5959 2c01 e803 c409 97"), [3.0]),
        ("tfmini", "cm", bytes.fromhex("5959 2c01 e803 c409 98"), []),
        ("a02", "mm", bytes.fromhex("ff 07 a1 a7"), [1.953]),
        ("a02", "mm", b"\x00\xff" + a02(300) + a02(0xFFFF), [0.3, 65.535]),
    ],
)  # fmt: skip
def test_data_sheet_examples(
    name: str, unit: str, data: bytes, expected: list[float | None]
) -> None:
    assert metres(decoder(name, unit).feed(data)) == expected


@pytest.mark.parametrize(
    ("frame", "why"),
    [
        (tfmini(300, strength=99), "weak echo (strength 99)"),
        (tfmini(300, strength=0xFFFF), "saturated or error code"),
        (tfmini(0xFFFE, strength=500), "saturated or error code"),
        (tfmini(0, strength=500), "no echo"),
    ],
)
def test_a_lidar_that_doubts_itself_measures_nothing(frame: bytes, why: str) -> None:
    (measurement,) = decoder("tfmini").feed(frame)
    assert measurement.metres is None
    assert measurement.why == why


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("Distance (cm): 123", 1.23),
        ("Distância: 123 cm", 1.23),
        ("Dist[mm]=812", 0.812),
        ("distance in inches: 10", 0.254),
        ("Distance in front: 123", 1.23),
        ("HC-SR04 = 88 cm", 0.88),
        ("sensor 1: 98 cm", 0.98),
        ("The distance is 123 cm.", 1.23),
        ("Distance\t123,4 cm", 1.234),
        ("距离: 123 cm", 1.23),
        ('{"distance":123}', 1.23),
        ('{"distance_mm": 812, "temp": 21.5, "id": "A4"}', 0.812),
        ('{"range": "98 cm", "ok": true}', 0.98),
        ('{"value": 1.23, "unit": "m"}', 1.23),
    ],
)
@pytest.mark.parametrize("coding", ["utf-8", "latin-1"])
def test_what_people_print_from_an_arduino_is_read(line: str, expected: float, coding: str) -> None:
    data = line.encode(coding, "ignore")
    assert metres(decoder("lines").feed(b"\n" + data + b"\r\n")) == [expected]


@pytest.mark.parametrize(
    ("line", "why", "remedy"),
    [
        ("150,52", "'150,52' may be two numbers, or one with a decimal comma", "`column`"),
        ("1000, 87", "several numbers", "`column`"),
        ("123 98", "several numbers", "`column`"),
        ("123 cm 48.4 inch", "several numbers", "`column`"),
        ('{"left":123,"right":98}', "several numbers", "`column`"),
        ('{"distance":', "not the whole of an object", "print"),
        ("7134 us", "'7134 us' is no distance", "print"),
        ("1-23", "'1-23' is no distance", "print"),
        ("Out of range", "'Out of range' has no distance in it", "print"),
        ("\x81\x07 123", "is no text", "baud"),
        ("1" * 500, "no line ends within", "println"),
    ],
)
def test_what_is_no_distance_says_why(line: str, why: str, remedy: str) -> None:
    one = decoder("lines")
    assert one.feed(b"\n" + line.encode() + b"\n") == []
    assert why in one.trouble[0]
    assert remedy in one.trouble[1]


def test_one_number_of_several_is_read_by_its_column() -> None:
    assert metres(decoder("lines", column=2).feed(b"\n150,52\n1000; 87\n12 13 mm\n7\n")) == [
        *(0.52, 0.87, 0.013)
    ]
    assert metres(decoder("lines", column=1).feed(b'\n150,52,7\n{"a": 90, "b": 1}\n')) == [1.5, 0.9]


def test_a_comma_before_a_unit_is_a_decimal_comma_in_columns_too() -> None:
    line = b"\n12,5 cm, 13,5 cm\n"
    assert metres(decoder("lines", column=1).feed(line)) == [0.125]
    assert metres(decoder("lines", column=2).feed(line)) == [0.135]


@pytest.mark.parametrize(
    ("line", "column"),
    [("Dist: 123 cm Temp: 22 C", 1), ("22,5 C; 123 cm", 2), ("t=7134us 123", 2)],
)
def test_a_number_that_is_no_distance_is_no_harm_beside_the_one_that_is(
    line: str, column: int
) -> None:
    data = f"\n{line}\n".encode()
    assert metres(decoder("lines", column=column).feed(data)) == [1.23]
    without, other = decoder("lines"), decoder("lines", column=3 - column)
    assert without.feed(data) == other.feed(data) == []
    assert "has several numbers" in without.trouble[0]
    assert "is no distance" in other.trouble[0]


def test_a_tail_of_a_line_is_no_reading() -> None:
    assert decoder("lines").feed(b"23\n") == []


def test_bad_frames_are_counted() -> None:
    lines = decoder("maxbotix")
    lines.feed(b"R1\r\r\nxx\r" + b"R" * (MAX_LINE * 3) + b"\rR100\r")
    assert lines.bad == 3
    binary = decoder("a02")
    binary.feed(a02(500)[:-1] + b"\x00" + a02(500))
    assert binary.bad == 1


@given(NAMES, st.lists(ANY_BYTES, max_size=10))
def test_no_bytes_raise(name: str, pieces: list[bytes]) -> None:
    one = decoder(name)
    for piece in pieces:
        for measurement in one.feed(piece):
            assert measurement.metres is None or abs(measurement.metres) < 1e7
            assert abs(measurement.raw) < 1e8
    assert one.bad <= sum(map(len, pieces))


@given(STREAMS, ANY_BYTES, st.lists(st.integers(0, 400), max_size=12))
def test_pieces_give_the_same_as_the_whole(
    stream: tuple[str, bytes], noise: bytes, cuts: list[int]
) -> None:
    name, frames = stream
    data = noise + frames
    whole, split = decoder(name), decoder(name)
    edges = [0, *sorted(min(cut, len(data)) for cut in cuts), len(data)]
    pieces = [data[a:b] for a, b in itertools.pairwise(edges)]
    assert [m for piece in pieces for m in split.feed(piece)] == whole.feed(data)
    assert split.bad == whole.bad


@given(ANY_BYTES, st.integers(0, 999))
def test_text_finds_its_way_back_after_noise(noise: bytes, number: int) -> None:
    for name in ("maxbotix", "lines"):
        frame = maxbotix(number) if name == "maxbotix" else b"%d\n" % number
        found = decoder(name).feed(noise + b"\r" + frame)
        assert found
        assert found[-1].raw == number


@given(ANY_BYTES, st.integers(1, 1200), st.integers(100, 0xFFF0))
def test_binary_framings_find_their_way_back_after_noise(
    noise: bytes, number: int, strength: int
) -> None:
    for name, header, frame in (
        ("tfmini", b"\x59\x59", tfmini(number, strength)),
        ("a02", b"\xff", a02(number)),
    ):
        if (frame + frame[:-1]).count(header) == 2:  # else the noise may hide inside the frames
            found = decoder(name).feed(noise + frame * 3)
            assert found[-1].raw == number


def test_a_repeated_frame_that_holds_its_own_header_is_left_as_soon_as_the_distance_moves() -> None:
    one = decoder("a02")  # 511 mm is FF 01 FF FF: one byte off, it is well-formed as well
    assert [m.raw for m in one.feed(b"\xff" + a02(511) * 3)] == [0xFF01] * 3
    assert [m.raw for m in one.feed(a02(520) * 3)][-1] == 520


@given(st.integers(0, 0xFFFF), st.integers(0, 0xFFFF), st.integers(0, 0xFFFF), st.data())
def test_no_frame_with_one_wrong_bit_is_taken(
    number: int, strength: int, temperature: int, data: st.DataObject
) -> None:
    for name, frame in (("tfmini", tfmini(number, strength, temperature)), ("a02", a02(number))):
        bit = data.draw(st.integers(0, len(frame) * 8 - 1))
        wrong = bytearray(frame)
        wrong[bit // 8] ^= 1 << (bit % 8)
        assert decoder(name).feed(bytes(wrong)) == []
