"""What the visitor said, as one file that runs along with the session."""

from __future__ import annotations

import wave
from pathlib import Path

import pytest

from tests.export.export_runs import export_logs
from tests.export.logs import STEM, Timed, speak, start, write
from woz_tui.export.event_model import ExportSession, SoundClip
from woz_tui.export.output_folder import new_folder
from woz_tui.export.visitor_sound import write_sound
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m

S = 1_000_000


def joined_sound(
    folder: Path, clips: list[SoundClip], duration: float
) -> tuple[list[int], int, list[str]]:
    """The samples of the whole, one for each tenth of a second; its length; what was left out."""
    session = ExportSession(name="S", folders=(folder,), clips=clips, duration=round(duration * S))
    with new_folder(folder / "out", force=True) as out:
        out.write("README.md", "# Sessions exported by woz-tui\n")
        length, notes = write_sound(session, out, "S.wav")
    if not length:
        assert not (folder / "out" / "S.wav").exists()
        return [], 0, notes
    with wave.open(str(folder / "out" / "S.wav")) as file:
        assert file.getnframes() * S == length * file.getframerate()
        sound = memoryview(file.readframes(file.getnframes())).cast("h")
        return list(sound[:: file.getframerate() // 10]), length, notes


def test_clips_stand_at_their_times(tmp_path: Path) -> None:
    clips = [
        SoundClip(speak(tmp_path, "b.wav", 0.2, 7), round(0.6 * S)),
        SoundClip(speak(tmp_path, "a.wav", 0.3, 5), round(0.1 * S)),
    ]
    assert joined_sound(tmp_path, clips, 1) == ([0, 5, 5, 5, 0, 0, 7, 7, 0, 0], S, [])


def test_where_clips_overlap_the_earlier_one_is_heard(tmp_path: Path) -> None:
    clips = [
        SoundClip(speak(tmp_path, "a.wav", 0.3, 5), 0),
        SoundClip(speak(tmp_path, "b.wav", 0.3, 7), round(0.2 * S)),
        SoundClip(speak(tmp_path, "c.wav", 0.1, 9), round(0.3 * S)),
    ]
    assert joined_sound(tmp_path, clips, 0.7)[0] == [5, 5, 5, 7, 7, 0, 0]


def test_a_clip_that_outlasts_the_session_is_heard_to_its_end(tmp_path: Path) -> None:
    clips = [SoundClip(speak(tmp_path, "a.wav", 0.4, 5), round(0.1 * S))]
    assert joined_sound(tmp_path, clips, 0.2)[0] == [0, 5, 5, 5, 5]


def test_a_clip_cut_short_harms_nothing(tmp_path: Path) -> None:
    cut = speak(tmp_path, "a.wav", 0.4, 5)
    cut.write_bytes(cut.read_bytes()[: 44 + 2 * 1600])
    clips = [SoundClip(cut, 0), SoundClip(speak(tmp_path, "b.wav", 0.1, 7), round(0.5 * S))]
    assert joined_sound(tmp_path, clips, 0.7)[0] == [5, 5, 0, 0, 0, 7, 0]


def test_what_does_not_fit_is_left_out_and_told(tmp_path: Path) -> None:
    eight = tmp_path / "eight.wav"
    with wave.open(str(eight), "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(1)
        file.setframerate(8000)
        file.writeframes(b"\x80" * 800)
    clips = [
        SoundClip(eight, 0),
        SoundClip(speak(tmp_path, "a.wav", 0.1, 5), 0),
        SoundClip(speak(tmp_path, "b.wav", 0.1, 7, rate=16_000), round(0.2 * S)),
        SoundClip(tmp_path / "gone.wav", 0),
    ]
    samples, _, notes = joined_sound(tmp_path, clips, 0.3)
    assert samples == [5, 0, 0]
    assert [note.split()[0] for note in notes] == ["eight.wav", "gone.wav", "b.wav"]


def test_a_session_of_days_makes_no_file_of_silence(tmp_path: Path) -> None:
    clips = [SoundClip(speak(tmp_path, "a.wav", 0.1), 0)]
    samples, length, notes = joined_sound(tmp_path, clips, 3 * 86_400)
    assert (samples, length) == ([], 0)
    assert "too long" in notes[0]


# -- where the log says that they are --------------------------------------------------------------

#: What the log of a session is called before its participant is chosen.
NAMELESS = STEM.replace("_P07", "")


def spoken_session(*files: str) -> list[Timed]:
    """A session of so many seconds in each of which a sentence of half a second was recorded."""
    ends = (
        m.SpeechEnded(driver="ears", segment=at + 1, began=at * S, ended=at * S + S // 2, file=file)
        for at, file in enumerate(files)
    )
    return [(0, start()), *((at + 0.6, end) for at, end in enumerate(ends))]


def levels(out: Path, seconds: int) -> list[int]:
    """What is heard at the beginning of each second."""
    with wave.open(str(out / f"{STEM}.wav")) as file:
        sound = memoryview(file.readframes(file.getnframes())).cast("h")
        return list(sound[:: file.getframerate()])[:seconds]


@pytest.mark.parametrize("folder", [STEM, NAMELESS])
def test_a_log_that_got_its_participants_name_has_its_sound(tmp_path: Path, folder: str) -> None:
    """Whether the folder of the sound was renamed with it, as for some time, or not."""
    speak(tmp_path / "rec" / f"{folder}.media", "a.wav", 0.5, 5)
    log = write(tmp_path / "rec", spoken_session(f"{NAMELESS}.media/a.wav"))
    (session_summary,) = export_logs(log, "textgrid", tmp_path / "out")
    assert (levels(tmp_path / "out", 1), session_summary.notes) == ([5], [])


def test_sound_beside_a_later_part_of_the_log_is_found_there(tmp_path: Path) -> None:
    rec, spill = tmp_path / "rec", tmp_path / "spill"
    second = spill / f"{STEM}.2.jsonl"
    log = write(rec, spoken_session(f"{STEM}.media/a.wav", f"{STEM}.media/b.wav"))
    lines = log.read_bytes().splitlines(keepends=True)
    left = m.Segment(log=STEM, session="S01", number=1, next_file=str(second))
    segment = m.Segment(log=STEM, session="S01", number=2, previous=str(log))
    log.write_bytes(b"".join([*lines[:2], codec.encode(left)]))
    speak(rec / f"{STEM}.media", "a.wav", 0.5, 5)
    speak(spill / f"{STEM}.media", "b.wav", 0.5, 7)
    second.write_bytes(b"".join([codec.encode(segment), *lines[2:]]))
    for given in (log, second):
        (session_summary,) = export_logs(given, "textgrid", tmp_path / "out", force=True)
        assert (levels(tmp_path / "out", 2), session_summary.notes) == ([5, 7], [])


@pytest.mark.parametrize("gone", ["b.wav", f"{NAMELESS}.media/b.wav", "\0", "b" * 5000, ".."])
@pytest.mark.parametrize("to", ["eaf", "textgrid"])
def test_how_many_sentences_are_not_there_is_told(tmp_path: Path, gone: str, to: str) -> None:
    speak(tmp_path / "rec" / f"{STEM}.media", "a.wav", 0.5, 5)
    course = spoken_session(f"{STEM}.media/a.wav", gone, gone)
    log = write(tmp_path / "rec", course)
    (session_summary,) = export_logs(log, to, tmp_path / "out")
    assert levels(tmp_path / "out", 3) == [5, 0, 0]
    (note,) = session_summary.notes
    assert "2" in note.split()
    for option in ({"sound": False}, {"sound": False, "redact": True}):
        (session_summary,) = export_logs(log, to, tmp_path / "out", force=True, **option)
        assert session_summary.notes == [], "nobody wants it"
