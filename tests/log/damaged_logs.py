"""Small logs, and everything that can happen to their bytes."""

from __future__ import annotations

import random
from pathlib import Path

from hypothesis import strategies as st

from tests.log.recorder_rig import STEM
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m

#: Far more than the reader puts in order, and than it reads at once in these tests.
LINES = 700
#: Bytes that are read at once: less than a line, a few lines, many.
BLOCKS = (20, 700, 5_000, 1 << 18)

#: Lines that no version of this program has written, or a later one.
STRANGE = (
    b'{"kind":"hologram","seq":%d,"t":%d,"ts":"","colour":"blue"}\n',
    b'{"kind":"sample","seq":%d,"t":%d,"sensor":["distance"],"value":"far"}\n',
    b'{"kind":"note","seq":%d,"t":%d,"ts":"x","text":"a","later":[1,{"b":null}]}\n',
    b'{"kind":"note","seq":%d,"t":%d,"ts":"x","text":"a","later":1e999}\n',
    b' {"kind": "note", "seq": %d, "t": %d, "text": "blanks"} \r\n',
    b'{"kind":"session.start","seq":%d,"t":%d,"ts":"","schema":99}\n',
    b'{"kind":"segment","seq":%d,"t":%d,"ts":"","log":"x","session":"S01","number":2}\n',
    b'{"kind":"clock","seq":%d,"t":%d,"ts":"","wall":""}{"kind":"note","seq":3,"t":3,"text":"b"}\n',
    b'{"kind":"clock","seq":%d,"t":%d,"ts":"",\n"wall":""}\n',
    b'{"kind":"sample","seq":%d,"t":-%d,"sensor":"distance","value":1.0}\n',
    b'{"kind":"engagement.shown","seq":-%d,"t":%d}\n',
)

LogDamage = tuple[str, int, int]


def note(seq: int, text: str = "hello") -> bytes:
    """A line of an action, at ten microseconds a number."""
    return codec.encode(m.Note(seq=seq, t=seq * 10, ts="2026-03-01T10:00:00.000000Z", text=text))


def sample(seq: int, sensor: str = "distance") -> bytes:
    """A line of a sample."""
    return codec.encode(m.Reading(seq=seq, t=seq * 10, sensor=sensor, value=seq / 8))


def engagement_line(seq: int) -> bytes:
    """A line of how the engagement model stood."""
    return codec.encode(
        m.EngagementShown(
            seq=seq,
            t=seq * 10,
            state="Handshake",
            since=seq,
            trail=[],
            signs={"gaze": m.SignShown(needed=4, places=8, filter="median")},
            run="run",
            uses=["gaze"],
            social_distance=1.3,
            engaged=True,
        )
    )


def write_log(folder: Path, content: bytes, name: str = f"{STEM}.jsonl") -> Path:
    """A file of a log."""
    folder.mkdir(exist_ok=True)
    path = folder / name
    path.write_bytes(content)
    return path


def _sample(seq: int) -> bytes:
    if seq == 11:
        return sample(seq, "identity")  # once, and then never again
    return (
        engagement_line(seq)
        if seq % 20 == 7
        else sample(seq, ("distance", "gaze", "presence")[seq % 3])
    )


ACTIONS = b"".join(note(seq, "é") for seq in range(0, LINES, 10))
SAMPLES = b"".join(_sample(seq) for seq in range(LINES) if seq % 10)

WOUNDS = st.lists(
    st.tuples(
        st.sampled_from(
            ["flip", "nul", "cut", "repeat", "swap", "insert", "strange", "line", "lines", "number"]
        ),
        st.integers(0, len(SAMPLES) - 1),
        st.integers(1, 300),
    ),
    max_size=5,
)


def wounded(content: bytes, wounds: list[LogDamage]) -> bytes:
    """`content` after all of that has happened to it."""
    data = bytearray(content)
    for what, place, size in wounds:
        at = place % (len(data) + 1)
        part = data[at : at + size]
        match what:
            case "flip" if at < len(data):
                data[at] ^= 1 << size % 8
            case "nul":
                data[at : at + size] = bytes(len(part))
            case "cut":
                del data[at : at + size]
            case "repeat":
                data[at:at] = part
            case "swap":
                del data[at : at + size]
                data += part
            case "insert":
                data[at:at] = random.Random(size).randbytes(size)
            case "strange":
                begins = data.rfind(b"\n", 0, at) + 1
                line = STRANGE[size % len(STRANGE)]
                data[begins:begins] = line % (place % LINES, place % LINES * 10)
            case "number":
                data = _misnumbered(data, at, size)
            case "line" | "lines":
                data = _moved(data, at, size, 1 if what == "line" else 40)
    return bytes(data)


def _moved(data: bytearray, at: int, by: int, count: int) -> bytearray:
    """Some whole lines stand `by` lines further down."""
    lines = bytes(data).splitlines(keepends=True)
    first = data.count(b"\n", 0, at)
    part = lines[first : first + count]
    del lines[first : first + count]
    lines[first + by : first + by] = part
    return bytearray(b"".join(lines))


def _misnumbered(data: bytearray, at: int, size: int) -> bytearray:
    """Another digit in the next `seq` or `t`."""
    field = (b'"seq":', b'"t":')[size % 2]
    digit = data.find(field, at) + len(field) + size % 3
    if digit < len(data) and data[digit : digit + 1].isdigit():
        data[digit] = b"0123456789"[size % 10]
    return data
