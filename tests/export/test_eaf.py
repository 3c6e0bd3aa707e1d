"""ELAN's files: checked with XML Schema and read back with pympi, which knows nothing of woz.

`schemas/` says which schemas these are.
"""

from __future__ import annotations

import wave
import xml.etree.ElementTree as ET
from functools import cache
from itertools import pairwise
from pathlib import Path, PurePath

import pympi
import pytest
import xmlschema
from hypothesis import HealthCheck, given, settings

from tests.export.export_runs import course_to, export_logs
from tests.export.logs import STEM, Timed, courses, session_of, speak, start, visit, write
from woz_tui.export.eaf import SHORTEST_MS, in_milliseconds
from woz_tui.export.tiers import tiers_of
from woz_tui.protocol import messages as m
from woz_tui.system.text_cleaning import one_line, visible

SCHEMAS = sorted((Path(__file__).parent / "schemas").glob("*.xsd"))
Read = dict[str, list[tuple[int, int, str]]]


@cache
def schema(path: Path) -> xmlschema.XMLSchema:
    return xmlschema.XMLSchema(path)


def checked(path: Path) -> Path:
    """`path`, which follows all schemas."""
    for each in SCHEMAS:
        assert [str(error) for error in schema(each).iter_errors(path)] == [], each.name
    return path


def read_back(path: Path) -> Read:
    """Tiers as pympi reads them."""
    eaf = pympi.Eaf(str(checked(path)))
    return {
        name: sorted(entry[:3] for entry in eaf.get_annotation_data_for_tier(name))
        for name in eaf.get_tier_names()
    }


def properties(path: Path) -> list[tuple[str, str]]:
    found = ET.parse(path).getroot().findall("HEADER/PROPERTY")
    return [(element.get("NAME", ""), element.text or "") for element in found]


def media(path: Path) -> list[dict[str, str]]:
    return [each.attrib for each in ET.parse(path).getroot().findall("HEADER/MEDIA_DESCRIPTOR")]


def test_there_are_schemas_and_they_refuse_what_is_wrong(tmp_path: Path) -> None:
    assert SCHEMAS
    path = course_to(tmp_path, "eaf", visit()) / f"{STEM}.eaf"
    text = path.read_text()
    wrong = [
        text.replace('TIME_SLOT_REF1="ts1"', 'TIME_SLOT_REF1="ts9999"'),
        text.replace('TIME_VALUE="0"', 'TIME_VALUE="-1"', 1),
        text.replace('DATE="2026', 'DATE="soon 2026'),
        text.replace('TIER_ID="notes"', 'TIER_ID="markers"'),
        text.replace('ANNOTATION_ID="a2"', 'ANNOTATION_ID="a1"'),
    ]
    for each in wrong:
        assert each != text
        for known in SCHEMAS:
            assert not schema(known).is_valid(ET.fromstring(each)), known.name


def test_a_visit_comes_back(tmp_path: Path) -> None:
    tiers = read_back(course_to(tmp_path, "eaf", visit()) / f"{STEM}.eaf")
    assert tiers["engagement"] == [(0, 1000, "Idle"), (1000, 11_000, "Engaged")]
    assert tiers["panel Speech"] == [(2000, 3500, "Hello [mistake]")]
    assert tiers["panel Gestures"] == [
        (6000, 6040, "Nod [refused]"),
        (11_000, 11_040, "Dance [open]"),
    ]
    assert tiers["robot speech"] == [(2011, 3500, 'Hello, "dear"\tvisitor!\nÇa va? <&>')]
    assert tiers["visitor speech"] == [(3550, 4900, "What is this?")]
    assert tiers["markers"] == [(6200, 6240, "=1+1")]
    assert tiers["markers-2"] == [(6200, 6240, "smile")], "two at the same time"
    assert tiers["notes"] == [(6300, 6340, "a child\nhas joined")]


@settings(suppress_health_check=list(HealthCheck))
@given(courses())
def test_any_course_is_valid_and_comes_back(tmp_path: Path, course: list[Timed]) -> None:
    tiers = read_back(course_to(tmp_path, "eaf", course) / f"{STEM}.eaf")
    expected = in_milliseconds(tiers_of(session_of(tmp_path, course)))
    assert tiers == {
        one_line(tier.name): sorted((s.begin, s.end, visible(s.text)) for s in tier.spans)
        for tier in expected
    }
    for spans in tiers.values():
        assert all(end - begin >= SHORTEST_MS for begin, end, _ in spans)
        assert all(one[1] <= other[0] for one, other in pairwise(spans))


def test_slots_are_in_order_and_no_two_annotations_share_one(tmp_path: Path) -> None:
    root = ET.parse(course_to(tmp_path, "eaf", visit()) / f"{STEM}.eaf").getroot()
    values = [int(slot.get("TIME_VALUE", "")) for slot in root.iter("TIME_SLOT")]
    assert values == sorted(values)
    used = [
        annotation.get(name)
        for annotation in root.iter("ALIGNABLE_ANNOTATION")
        for name in ("TIME_SLOT_REF1", "TIME_SLOT_REF2")
    ]
    assert len(used) == len(set(used)) == len(values)


def test_the_header_says_who_when_and_what_is_wrong(tmp_path: Path) -> None:
    log = write(tmp_path / "recordings", visit(), ended=False)
    export_logs(log, "eaf", tmp_path / "out")
    path = checked(tmp_path / "out" / f"{STEM}.eaf")
    root = ET.parse(path).getroot()
    assert (root.get("AUTHOR"), root.get("DATE")) == ("W2", "2026-03-01T10:00:00+00:00")
    told = properties(path)
    assert ("participants", "P07") in told
    assert ("damage", "the session has no end: it is still running, or it was interrupted") in told


def _log_with_speech(folder: Path) -> Path:
    """A log whose visitor speaks twice, from 1 s and from 3 s, half a second each."""
    for number, level in ((1, 1000), (2, -2000)):
        speak(folder / f"{STEM}.media", f"speech-{number}.wav", 0.5, level)
    course: list[Timed] = [(0, start())]
    for number, began in ((1, 1_000_000), (2, 3_000_000)):
        speech_ended = m.SpeechEnded(
            driver="ears",
            segment=number,
            began=began,
            ended=began + 500_000,
            file=f"{STEM}.media/speech-{number}.wav",
        )
        course.append((began / 1e6 + 0.6, speech_ended))
    return write(folder, [*course, (5, m.Note(text="end"))])


def test_the_visitors_voice_runs_along(tmp_path: Path) -> None:
    export_logs(_log_with_speech(tmp_path / "recordings"), "eaf", tmp_path / "out")
    path = checked(tmp_path / "out" / f"{STEM}.eaf")
    (linked,) = media(path)
    assert linked["RELATIVE_MEDIA_URL"] == f"./{STEM}.wav"
    assert linked["MIME_TYPE"] == "audio/x-wav"
    with wave.open(str(tmp_path / "out" / f"{STEM}.wav")) as file:
        assert file.getnframes() == 5 * 8000
        sound = memoryview(file.readframes(5 * 8000)).cast("h")
    assert {sound[8000], sound[11_999]} == {1000}
    assert {sound[24_000], sound[27_999]} == {-2000}
    assert set(sound[:8000]) == set(sound[12_000:24_000]) == set(sound[28_000:]) == {0}


def test_a_voice_can_stay_at_home(tmp_path: Path) -> None:
    export_logs(_log_with_speech(tmp_path / "recordings"), "eaf", tmp_path / "out", sound=False)
    assert media(tmp_path / "out" / f"{STEM}.eaf") == []
    assert list((tmp_path / "out").glob("*.wav")) == []


def test_sound_that_is_none_is_told(tmp_path: Path) -> None:
    log = _log_with_speech(tmp_path / "recordings")
    (tmp_path / "recordings" / f"{STEM}.media" / "speech-2.wav").write_bytes(b"RIFF")
    (session_summary,) = export_logs(log, "eaf", tmp_path / "out")
    assert any("speech-2.wav cannot be read" in note for note in session_summary.notes)
    assert ("note", session_summary.notes[0]) in properties(tmp_path / "out" / f"{STEM}.eaf")


@pytest.mark.parametrize("to", ["eaf", "textgrid"])
@pytest.mark.parametrize("way", ["up", "absolute", "link"])
def test_sound_outside_of_the_logs_folder_is_left_out_and_named(
    tmp_path: Path, way: str, to: str
) -> None:
    recordings = tmp_path / "recordings"
    secret = speak(tmp_path, "secret.wav", 0.5)
    name = {"up": "../secret.wav", "absolute": str(secret), "link": "linked.wav"}[way]
    recordings.mkdir()
    (recordings / "linked.wav").symlink_to(secret)
    speech_ended = m.SpeechEnded(driver="ears", segment=1, began=0, ended=500_000, file=name)
    (session_summary,) = export_logs(
        write(recordings, [(0, start()), (1, speech_ended)]), to, tmp_path / "out"
    )
    assert not list((tmp_path / "out").glob("*.wav"))
    assert any(PurePath(name).name in note for note in session_summary.notes)


@pytest.mark.parametrize(("offset", "origin"), [(0.0, None), (12.5, "12500")])
def test_a_video_opens_in_sync(tmp_path: Path, offset: float, origin: str | None) -> None:
    video = tmp_path / "videos" / "visit 7.mp4"
    video.parent.mkdir()
    video.touch()
    log = write(tmp_path / "recordings", visit())
    export_logs(log, "eaf", tmp_path / "out", media=video, offset=round(offset * 1_000_000))
    path = checked(tmp_path / "out" / f"{STEM}.eaf")
    (linked,) = media(path)
    assert linked["RELATIVE_MEDIA_URL"] == "./../videos/visit%207.mp4"
    assert str(tmp_path) not in path.read_text(), "no path of this machine"
    assert (linked["MIME_TYPE"], linked.get("TIME_ORIGIN")) == ("video/mp4", origin)
    assert read_back(path)["visitor speech"] == [(3550, 4900, "What is this?")]


def test_a_video_that_began_later_has_its_own_time(tmp_path: Path) -> None:
    video = tmp_path / "visit.mp4"
    video.touch()
    log = write(tmp_path / "recordings", visit())
    (session_summary,) = export_logs(log, "eaf", tmp_path / "out", media=video, offset=-3_000_000)
    tiers = read_back(tmp_path / "out" / f"{STEM}.eaf")
    assert tiers["visitor speech"] == [(550, 1900, "What is this?")]
    assert tiers["engagement"] == [(0, 8000, "Engaged")], "Idle was over when the video began"
    assert "left out" in session_summary.notes[0]
