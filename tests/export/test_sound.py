"""What the visitor said, as one file that runs along with the session."""

from __future__ import annotations

import wave
from pathlib import Path

from tests.export.logs import speak
from woz_tui.export.event_model import ExportSession, SoundClip
from woz_tui.export.output_folder import new_folder
from woz_tui.export.visitor_sound import write_sound

S = 1_000_000


def joined(
    folder: Path, clips: list[SoundClip], duration: float
) -> tuple[list[int], int, list[str]]:
    """The samples of the whole, one for each tenth of a second; its length; what was left out."""
    session = ExportSession(
        name="S", log=folder / "S.jsonl", clips=clips, duration=round(duration * S)
    )
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
    assert joined(tmp_path, clips, 1) == ([0, 5, 5, 5, 0, 0, 7, 7, 0, 0], S, [])


def test_where_clips_overlap_the_earlier_one_is_heard(tmp_path: Path) -> None:
    clips = [
        SoundClip(speak(tmp_path, "a.wav", 0.3, 5), 0),
        SoundClip(speak(tmp_path, "b.wav", 0.3, 7), round(0.2 * S)),
        SoundClip(speak(tmp_path, "c.wav", 0.1, 9), round(0.3 * S)),
    ]
    assert joined(tmp_path, clips, 0.7)[0] == [5, 5, 5, 7, 7, 0, 0]


def test_a_clip_that_outlasts_the_session_is_heard_to_its_end(tmp_path: Path) -> None:
    clips = [SoundClip(speak(tmp_path, "a.wav", 0.4, 5), round(0.1 * S))]
    assert joined(tmp_path, clips, 0.2)[0] == [0, 5, 5, 5, 5]


def test_a_clip_cut_short_harms_nothing(tmp_path: Path) -> None:
    cut = speak(tmp_path, "a.wav", 0.4, 5)
    cut.write_bytes(cut.read_bytes()[: 44 + 2 * 1600])
    clips = [SoundClip(cut, 0), SoundClip(speak(tmp_path, "b.wav", 0.1, 7), round(0.5 * S))]
    assert joined(tmp_path, clips, 0.7)[0] == [5, 5, 0, 0, 0, 7, 0]


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
    samples, _, notes = joined(tmp_path, clips, 0.3)
    assert samples == [5, 0, 0]
    assert [note.split()[0] for note in notes] == ["eight.wav", "gone.wav", "b.wav"]


def test_a_session_of_days_makes_no_file_of_silence(tmp_path: Path) -> None:
    clips = [SoundClip(speak(tmp_path, "a.wav", 0.1), 0)]
    samples, length, notes = joined(tmp_path, clips, 3 * 86_400)
    assert (samples, length) == ([], 0)
    assert "too long" in notes[0]
