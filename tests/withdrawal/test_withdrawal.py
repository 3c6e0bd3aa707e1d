"""A participant withdraws: nothing of them is left, and everything of the others is."""

from __future__ import annotations

import asyncio
import errno
import hashlib
import io
import itertools
import json
import os
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.analysis.example_sessions import ExampleSession
from tests.export.logs import Timed, start, write
from tests.log.recorder_rig import recorder_rig
from tests.session.rig import SessionRig
from woz_tui.analysis.kept_figures import figures_folder, kept_report
from woz_tui.analysis.session_reading import NO_EXTRAS, read_report
from woz_tui.cli import main
from woz_tui.drivers.face_store import FaceStore, default_path
from woz_tui.features.study.earlier_sessions import EarlierSessions
from woz_tui.gate.questions import RequestOrigin
from woz_tui.log.coding_file import Coding, coding_path, read_codings
from woz_tui.log.log_reader import messages, read
from woz_tui.log.recorder import Recorder
from woz_tui.log.verify import verify
from woz_tui.log.withdrawals import NAME as RECORD
from woz_tui.log.withdrawals import withdrawals
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError
from woz_tui.sensing.visitor_store import VisitorStore
from woz_tui.system.clock import ManualClock
from woz_tui.timeline.timeline import timeline_of
from woz_tui.withdrawal import removal

KEY = RequestOrigin("key", "h", "con1")
#: Lines that a withdrawal adds, or whose sums it computes anew.
CHANGED = ("participant.withdrawn", "checkpoint", "session.end")
STEM = "2026-03-01T10-00-00_P07_S01"


@pytest.fixture(autouse=True)
def own_state(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Faces and logs that went on elsewhere are looked for in the user's folders."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    monkeypatch.setenv("TMPDIR", str(tmp_path / "tmp"))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "recordings").mkdir()
    return tmp_path / "recordings"


def taken_out(folder: Path, code: str = "P07") -> int:
    return main(["participants", str(folder), "--code", code, "--withdraw", "--yes"])


def everything(folder: Path) -> dict[str, bytes]:
    """All files below a folder but the records of withdrawals, in which the code stands."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name != RECORD
    }


def said_in(log: Path) -> list[m.Message]:
    """The messages of a log, all of known kinds."""
    return [line.message for line in read(log) if line.message is not None]


def is_free_of(folder: Path, code: str) -> bool:
    found = everything(folder)
    return not any(code.encode() in data or code in name for name, data in found.items())


def two_people(folder: Path, *, name: str = STEM) -> Path:
    """P07 with two acts and an answer, then P08 in another condition, who does not set it again."""

    async def scenario(rig: SessionRig) -> None:
        session = rig.session
        session.play("Hello", KEY)
        await asyncio.sleep(2)
        session.note("P07 was shy")
        session.set(condition="cold")
        session.play("Welcome", KEY)
        await asyncio.sleep(2)
        session.set(participant="P08")
        await asyncio.sleep(11)
        session.note("P08 knows P07")
        session.play("Map", KEY)
        await asyncio.sleep(4)

    rig = SessionRig(folder.parent, stem=name).run(scenario)
    assert rig.recorder.path.parent == folder
    return rig.recorder.path


# -- real sessions --------------------------------------------------------------------------------


def figures_of(log: Path, participant: str) -> list[object]:
    report = read_report(log, extras=NO_EXTRAS)
    return [part for part in report.figures.parts if part.participant == participant]


def test_of_two_people_one_is_taken_out(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = two_people(folder)
    assert verify(log).sound
    before = {line.seq: line for line in read(log)}
    of_others = figures_of(log, "P08")
    assert taken_out(folder) == 0, capsys.readouterr().err
    after = folder / "2026-03-01T10-00-00_S01.jsonl"
    assert [*everything(folder)] == [after.name, after.with_suffix(".samples.jsonl").name]
    assert is_free_of(folder, "P07")
    assert verify(after).sentences() == []
    assert figures_of(after, "P08") == of_others
    assert figures_of(after, "P07") == []
    said = [line for line in messages(after) if isinstance(line, m.ParticipantWithdrawn)]
    conditions = [each.condition for each in said if each.condition is not None]
    assert conditions == ["cold"], "P08 comes into the condition that P07 left"
    assert sum(each.removed for each in said) > 10
    for line in read(after):
        if line.kind not in CHANGED and b"P07" not in before[line.seq].raw:
            assert line.raw == before[line.seq].raw
    notes = [line.text for line in messages(after) if isinstance(line, m.Note)]
    assert notes == ["P08 knows [withdrawn]"]
    assert taken_out(folder) == 0
    assert "stands in no file" in capsys.readouterr().out


def test_a_session_of_one_person_goes_with_all_beside_it(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    other = ExampleSession(participant="P08", session="S02").act(1).end(20)
    kept = other.written(folder, "2026-03-02T10-00-00_P08_S02").read_bytes()
    log = ExampleSession().act(1).written(folder, STEM)  # it crashed: it has no end
    media = folder / f"{STEM}.media"
    media.mkdir()
    for path in (media / "talk-1.wav", log.with_suffix(".host.log")):
        path.write_bytes(b"\0sound")
    log.with_suffix(".samples.jsonl").write_bytes(codec.encode(m.reading("distance", 1.0)))
    log.with_suffix(".samples.index").write_bytes(b"")
    (folder / f"{STEM} (1).jsonl").write_bytes(log.read_bytes())
    assert main(["participants", str(folder), "--code", "P07", "--json"]) == 0
    listed = json.loads(capsys.readouterr().out)
    assert {Path(each["path"]).name for each in listed["delete"]} == {
        *(f"{STEM}{end}" for end in (".jsonl", ".samples.jsonl", ".samples.index", ".host.log")),
        *("talk-1.wav", f"{STEM} (1).jsonl"),
    }
    assert len(everything(folder)) == 7, "it only lists"
    assert taken_out(folder) == 0
    assert everything(folder) == {"2026-03-02T10-00-00_P08_S02.jsonl": kept}
    assert not media.exists()


def test_figures_that_were_kept_go(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(folder.parent / "cache"))
    log = two_people(folder)
    kept_report(log)
    assert len(list(figures_folder().iterdir())) == 1
    assert taken_out(folder) == 0
    assert list(figures_folder().iterdir()) == []


def test_a_session_that_still_runs_is_refused(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    recorder = Recorder(folder, STEM, ManualClock())
    first = codec.encode(start(participant="P07"))
    recorder.record(start(participant="P07"), first)
    before = everything(folder)
    try:
        assert taken_out(folder) == 1
    finally:
        recorder.close()
    assert everything(folder) == before
    assert f"process {os.getpid()}" in capsys.readouterr().err


def test_a_folder_that_cannot_be_written_is_told(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    ExampleSession().act(1).end(20).written(folder, STEM)
    before = everything(folder)
    monkeypatch.setattr(os, "access", lambda path, mode: False)
    assert taken_out(folder) == 1
    assert everything(folder) == before
    assert "read-only" in capsys.readouterr().err


def test_a_wizards_code_is_no_participants(folder: Path) -> None:
    log = ExampleSession(wizard="W2").act(1).end(20).written(folder, STEM)
    before = log.read_bytes()
    assert taken_out(folder, "W2") == 0
    assert log.read_bytes() == before


def test_it_asks_first(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    ExampleSession().act(1).end(20).written(folder, STEM)
    before = everything(folder)
    assert main(["participants", str(folder), "--code", "P07", "--withdraw"]) == 1
    assert everything(folder) == before
    assert "--yes" in capsys.readouterr().err


def test_a_log_that_is_a_link_goes_with_what_it_links_to(folder: Path, tmp_path: Path) -> None:
    disk = tmp_path / "disk"
    alone = ExampleSession().act(1).end(20).written(disk, STEM)
    shared = write(
        disk,
        [
            (0, start(participant="P07", session="S02")),
            (20, m.SessionChanged(participant="P08")),
            (40, m.Note(text="y")),
        ],
        stem="2026-03-02T10-00-00_P07_S02",
    )
    for log in (alone, shared):
        (folder / log.name).symlink_to(log)
    assert taken_out(folder) == 0
    assert is_free_of(folder, "P07")
    # Samples that no link names are beside no log of this folder.
    assert [each.name for each in disk.iterdir()] == [f"{shared.stem}.samples.jsonl"]
    assert verify(folder / "2026-03-02T10-00-00_S02.jsonl").sentences() == []


def test_sound_in_a_folder_that_kept_the_name_of_the_beginning_goes(folder: Path) -> None:
    media = folder / "2026-03-01T10-00-00_S01.media"
    media.mkdir()
    (media / "ears-1.wav").write_bytes(b"RIFF\0")
    session = ExampleSession(participant="").add(0, m.SessionChanged(participant="P07"))
    spoken = m.SpeechEnded(
        driver="ears", segment=1, began=0, ended=1, file=f"{media.name}/ears-1.wav"
    )
    session.act(1).add(5, spoken).end(20).written(folder, STEM)
    assert taken_out(folder) == 0
    assert everything(folder) == {}
    assert not media.exists()


class Typed(io.StringIO):
    """A terminal at which somebody types."""

    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize(("typed", "left"), [("P07\n", 0), ("p07\n", 1), ("yes\n", 1), ("", 1)])
def test_at_a_terminal_the_code_is_typed(
    folder: Path, monkeypatch: pytest.MonkeyPatch, typed: str, left: int
) -> None:
    ExampleSession().act(1).end(20).written(folder, STEM)
    monkeypatch.setattr(sys, "stdin", Typed(typed))
    assert main(["participants", str(folder), "--code", "P07", "--withdraw"]) == left
    assert len(everything(folder)) == left


# -- what is not a log ----------------------------------------------------------------------------


def test_exports_and_reports_with_the_code_go_and_others_work_is_named(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    ExampleSession().act(1).end(20).written(folder, STEM)
    other = ExampleSession(participant="P08", session="S02").act(1).end(20)
    other.written(folder, "2026-03-02T10-00-00_P08_S02")
    for form in ("csv", "bids", "eaf", "textgrid", "jsonl"):
        out = str(tmp_path / "out" / form)
        assert main(["export", str(folder), "--to", form, "--out", out]) == 0
    assert main(["report", str(folder), "--csv", str(tmp_path / "out" / "tables")]) == 0
    assert main(["report", str(folder), "--html", str(tmp_path / "out" / "r.html")]) == 0
    beside = str(tmp_path / "out" / "b.html")
    assert main(["report", str(folder), "--html", beside, "--sessions", "beside"]) == 0
    capsys.readouterr()
    assert main(["report", str(folder), "--json"]) == 0
    (tmp_path / "out" / "r.json").write_text(capsys.readouterr().out)
    analysis = tmp_path / "out" / "csv" / "analysis.R"
    analysis.write_text("drop <- 'P07'\n")
    typed = tmp_path / "out" / "study-typed.yaml"
    typed.write_text('text: "Goodbye P07"\n')
    (tmp_path / "out" / "data.xlsx").write_bytes(b"PK\0\0")
    arguments = ["participants", str(folder), str(tmp_path / "out"), "--code", "P07"]
    assert main([*arguments, "--withdraw", "--yes"]) == 1, "something is left to do by hand"
    shown = capsys.readouterr().out
    assert "analysis.R" in shown
    assert "study-typed.yaml" in shown
    assert "data.xlsx" in shown
    assert f"S01.html (report): write it again with woz report --html {beside}" in shown
    assert [each.name[-8:] for each in (tmp_path / "out/b.sessions").iterdir()] == ["S02.html"]
    analysis.unlink()
    typed.unlink()
    assert is_free_of(tmp_path / "out", "P07")
    assert is_free_of(folder, "P07")
    assert [*everything(folder)] == ["2026-03-02T10-00-00_P08_S02.jsonl"]
    for form in ("csv", "bids", "eaf", "textgrid", "jsonl"):
        out = str(tmp_path / "out" / form)
        assert main(["export", str(folder), "--to", form, "--out", out, "--force"]) == 0


@pytest.mark.parametrize("form", ["csv", "bids", "textgrid"])
def test_what_somebody_put_beside_an_export_stays(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], form: str
) -> None:
    for code in ("P07", "P08"):
        example = ExampleSession(participant=code, session=f"S{code}").act(1).end(20)
        example.written(folder, f"2026-03-01T10-00-00_{code}_S{code}")
    out = tmp_path / "out"
    assert main(["export", str(folder), "--to", form, "--out", str(out)]) == 0
    own = [
        out / "demographics.csv",
        out / "ratings.json",
        out / "analysis" / "scores.tsv",
        out / "sub-P07" / "ses-SP07" / "beh" / "sub-P07_ses-SP07_task-rt_beh.tsv",
        tmp_path / "sessions.json",
    ]
    for path in own:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text('{"sessions": ["P07"]}')
    for code, others in (("P07", True), ("P08", False)):
        arguments = ["participants", str(folder), str(tmp_path), "--code", code]
        main([*arguments, "--withdraw", "--yes"])
        shown = capsys.readouterr().out
        assert all(path.is_file() for path in own)
        assert not others or all(str(path) in shown for path in own), "it is named"
        left = {path for path in out.rglob("*") if path.is_file()} - {*own}
        texts = [path.read_text() for path in left]
        assert not any(code in text for text in texts)
        # A table has everybody, so it goes with the first.
        assert (others and form != "csv") == any("P08" in text for text in texts)


def test_a_folder_with_a_data_package_of_others_is_no_export(folder: Path) -> None:
    package = {"name": "thesis", "sources": ["woz-sessions"], "resources": [{"path": "a.csv"}]}
    (folder / "datapackage.json").write_text(json.dumps({**package, "by": "woz-sessions"}))
    (folder / "a.csv").write_text("P07,1\n")
    assert taken_out(folder) == 1, "it is left to do by hand"
    assert (folder / "a.csv").read_text() == "P07,1\n"


def test_visitors_coders_and_clips_of_the_person_go(folder: Path) -> None:
    media = folder / f"{STEM}.media"
    media.mkdir()
    for name in ("theirs.wav", "others.wav"):
        (media / name).write_bytes(b"RIFF\0")

    def spoken(segment: int, name: str) -> m.SpeechEnded:
        return m.SpeechEnded(
            driver="ears", segment=segment, began=0, ended=1, file=f"{media.name}/{name}"
        )

    log = write(
        folder,
        [
            (0, start(participant="P07")),
            (1, spoken(1, "theirs.wav")),
            (20, m.SessionChanged(participant="P08")),
            (25, spoken(2, "others.wav")),
            (40, m.Note(text="over")),
        ],
    )
    first = next(line for line in messages(log) if isinstance(line, m.SessionStart))
    coding = Coding(coding_path(log), "K1", first)
    for t, text in ((2, "smiles"), (15, "gaze: robot"), (30, "waves at P07"), (31, "a-b")):
        coding.add(t * 1_000_000, text)
    coding.close()
    coded = coding_path(log)  # another program may write the same words otherwise
    said = coded.read_text("utf-8").replace("at P07", "at \\u005007").replace("a-b", "a\u2028b")
    coded.write_text(said, "utf-8")
    faces = FaceStore(default_path())
    faces.learn("P07", b"1234", "2026-03-01", "S01.jsonl")
    faces.learn("P08", b"5678", "2026-03-01", "S01.jsonl")
    store = VisitorStore(folder / "visitors.json")
    store.add("P07", on=None)
    store.add("P08", on=None)
    assert taken_out(folder) == 0
    assert is_free_of(folder, "P07")
    after = folder / "2026-03-01T10-00-00_S01.jsonl"
    assert verify(after).sentences() == []
    assert [path.name for path in after.with_suffix(".media").iterdir()] == ["others.wav"]
    clip = next(line for line in messages(after) if isinstance(line, m.SpeechEnded))
    assert (folder / clip.file).is_file()
    codes = read_codings(coding_path(after)).of("K1")
    assert [code.text for code in codes] == ["waves at [withdrawn]", "a\u2028b"]
    assert [face.name for face in FaceStore(default_path()).faces()] == ["P08"]
    assert [visitor.name for visitor in VisitorStore(folder / "visitors.json").everybody()] == [
        "P08"
    ]


def test_the_entries_that_are_listed_are_those_that_go(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    faces = FaceStore(default_path())
    store = VisitorStore(folder / "visitors.json")
    for name in ("p07", "Friend of P07", "Anna"):
        faces.learn(name, b"1234", "2026-03-01", f"{STEM}.jsonl" if name == "Anna" else "a.jsonl")
        store.add("Berta" if name == "p07" else name, on=None)
    store.learn("Berta", "P07")
    assert taken_out(folder) == 1, "some are left to look at"
    told = capsys.readouterr().out
    assert "visitors.json (named visitors): the entry of Berta" in told
    assert "faces.json (faces that are recognised): the entry of p07" in told
    assert {face.name for face in FaceStore(default_path()).faces()} == {"Anna", "Friend of P07"}
    left = VisitorStore(folder / "visitors.json").everybody()
    assert {visitor.name for visitor in left} == {"Anna", "Friend of P07"}
    assert told.count("woz visitors forget 'Friend of P07'") == 4, "of both, before and behind"
    assert told.count("woz visitors forget 'Anna'") == 2, "her face is from a session of P07's"


def test_codes_are_listed_with_those_that_are_probably_one_persons(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for day, code in enumerate(("P07", "p07", "P08"), 1):
        example = ExampleSession(
            participant=code, session=f"S{day}", wall=f"2026-03-0{day}T10:00:00.000000Z"
        )
        example.act(1).end(20).written(folder, f"2026-03-0{day}T10-00-00_{code}_S{day}")
    copy = folder / "2026-03-01T10-00-00_P07_S1 (1).jsonl"
    copy.write_bytes((folder / "2026-03-01T10-00-00_P07_S1.jsonl").read_bytes())
    (folder / "notes.txt").write_text("P08 was late\n")
    assert main(["participants", str(folder), "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {
        "participants": [
            {"participant": "P07", "sessions": 1, "files": 2},
            {"participant": "P08", "sessions": 1, "files": 2},
            {"participant": "p07", "sessions": 1, "files": 1},
        ],
        "alike": "Probably one person: P07 and p07",
        "withdrawn": [],
    }
    assert main(["participants", str(folder)]) == 0
    assert "Probably one person" in capsys.readouterr().out


def test_two_logs_do_not_get_one_name(folder: Path) -> None:
    course: list[Timed] = [
        (0, start(participant="P07")),
        (20, m.SessionChanged(participant="P08")),
    ]
    for stem, text in ((STEM, "a"), ("2026-03-01T10-00-00_S01", "b")):
        write(folder, [*course, (40, m.Note(text=text))], stem=stem)
    assert taken_out(folder) == 0
    logs = [path for path in folder.glob("*.jsonl") if ".samples" not in path.name]
    texts = [line.text for log in logs for line in messages(log) if isinstance(line, m.Note)]
    assert sorted(texts) == ["a", "b"]


def test_a_full_disk_leaves_all_as_it_was(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    write(folder, [(0, start(participant="P07")), (20, m.SessionChanged(participant="P08"))])
    before = everything(folder)

    def full(_: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device", str(folder))

    monkeypatch.setattr(os, "fsync", full)
    assert taken_out(folder) == 1
    assert everything(folder) == before
    assert "o space left" in capsys.readouterr().err


def test_a_history_of_git_is_named_and_left(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    ExampleSession().act(1).end(20).written(folder, STEM)
    kept = folder / "data" / ".git" / "ORIG_HEAD"
    kept.parent.mkdir(parents=True)
    kept.write_text("P07")
    assert taken_out(folder) == 0
    assert f"Not searched: {kept.parent}, " in capsys.readouterr().out
    assert kept.is_file()


def test_a_sound_that_an_action_plays_is_no_recording(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    session = ExampleSession().act(1)
    for number, name in enumerate(("sounds/gong.wav", "woz:waiting.gif")):
        played, file = f"c{number}", {"file": name}
        session.add(2, m.Command(command=played, verb="sound", args={**file}, source="key"))
        session.add(3, m.Done(command=played, sent={**file}, latency_us=0, duration_us=1))
    session.end(20).written(folder, STEM)
    assert taken_out(folder) == 0, capsys.readouterr().out
    assert "gong" not in capsys.readouterr().out


def test_pipes_and_circles_of_links_do_not_hold_it_up(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("pipe", "README.md", "notes.jsonl"):
        os.mkfifo(folder / name)
    (folder / "a.txt").symlink_to(folder / "b.txt")
    (folder / "b.txt").symlink_to(folder / "a.txt")
    ExampleSession().act(1).end(20).written(folder, STEM)
    assert taken_out(folder) == 1
    told = capsys.readouterr()
    assert f"{folder / 'a.txt'}: Too many levels of symbolic links" in told.err
    assert "Not searched" in told.out
    assert "pipe" in told.out
    assert not (folder / f"{STEM}.jsonl").exists()


def test_what_the_robot_process_said_of_others_stays(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    said = dict.fromkeys(("about P07", "nothing"))
    for day, text in enumerate(said, 1):
        other = ExampleSession(participant="P08", session=f"S0{day}")
        other.add(3, m.Note(text="P07 waits outside")).act(4).end(20)
        log = other.written(folder, f"2026-03-0{day}T10-00-00_P08_S0{day}")
        log.with_suffix(".host.log").write_text(text)
    assert taken_out(folder) == 1, "one is left to look at by hand"
    shown = capsys.readouterr().out
    assert "2026-03-01T10-00-00_P08_S01.host.log" in shown
    assert "2026-03-02T10-00-00_P08_S02.host.log" not in shown
    assert [path.read_text() for path in sorted(folder.glob("*.host.log"))] == [*said]


def test_a_code_of_digits_is_no_part_of_a_date_and_no_session(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    ExampleSession(participant="03", session="04").act(1).end(20).written(
        folder, "2026-03-01T10-00-00_03_04"
    )
    for code, session in (("08", "03"), ("", "03")):
        other = ExampleSession(participant=code, session=session).act(1).end(20)
        other.written(folder, "_".join(filter(None, ("2026-03-03T03-03-03", code, session))))
    (folder / "2026-03-02 log.txt").write_text("on 03/03/2026 at 10:03, 2026-03-03T03:03:03Z\n")
    others = {name: data for name, data in everything(folder).items() if "_03_04" not in name}
    assert taken_out(folder, "2026") == 0
    assert "stands in no file" in capsys.readouterr().out
    assert taken_out(folder, "03") == 0, capsys.readouterr()
    assert everything(folder) == others


def test_a_code_where_somebody_wrote_it_into_a_name_is_told(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write(
        folder,
        [
            (0, start(participant="P07")),
            (20, m.SessionChanged(participant="P08")),
            (40, m.Note(text="x")),
        ],
        stem="2026-03-01T10-00-00_S01 of P07",
    )
    assert taken_out(folder) == 1, "it is left to do by hand"
    assert "stands in its name" in capsys.readouterr().out
    assert (folder / "2026-03-01T10-00-00_S01 of P07.jsonl").is_file()


# -- a kill in between ----------------------------------------------------------------------------


class KilledError(BaseException):
    """The process ends here."""


def killing(monkeypatch: pytest.MonkeyPatch, after: int) -> None:
    """Let the process die before the so-manyth change of a name on the disk."""
    count = itertools.count()

    def counted(real: Callable[..., object]) -> Callable[..., object]:
        def change(*given: object, **more: object) -> object:
            if next(count) >= after:
                raise KilledError
            return real(*given, **more)

        return change

    for name in ("replace", "unlink"):
        monkeypatch.setattr(Path, name, counted(getattr(Path, name)))


@pytest.mark.parametrize("changes", range(0, 12, 2))
def test_a_kill_in_between_leaves_the_old_or_the_new(
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    changes: int,
) -> None:
    shared: list[Timed] = [
        (0, start(participant="P07")),
        (5, m.Note(text="a")),
        (20, m.SessionChanged(participant="P08")),
        (40, m.Note(text="b")),
    ]
    write(folder, shared)
    ExampleSession(session="S02").act(1).end(20).written(folder, "2026-03-02T10-00-00_P07_S02")
    before = everything(folder)
    with monkeypatch.context() as patched:
        killing(patched, changes)
        with suppress(KilledError):
            taken_out(folder)
    if (folder / removal.JOURNAL).exists():
        halfway = everything(folder)
        assert main(["participants", str(folder)]) == 0
        assert "was interrupted here" in capsys.readouterr().err
        assert everything(folder) == halfway, "a list changes nothing"
        assert taken_out(folder) == 0  # finishes it
    else:
        left = {name: data for name, data in everything(folder).items() if name[0] != "."}
        if left == before:
            assert taken_out(folder) == 0
    assert is_free_of(folder, "P07")
    assert {*everything(folder)} == {
        "2026-03-01T10-00-00_S01.jsonl",
        "2026-03-01T10-00-00_S01.samples.jsonl",
    }
    assert verify(folder / "2026-03-01T10-00-00_S01.jsonl").sentences() == []
    assert [each.code for each in withdrawals(folder)] == ["P07"]


def steps(folder: Path, **given: object) -> None:
    """Leave a list of steps as that of a withdrawal that was interrupted."""
    fields = {"inode": folder.stat().st_ino, **given}
    (folder / removal.JOURNAL).write_text(json.dumps(fields))


@pytest.mark.parametrize("way", ["absolute", "above", "link", "folder", "damaged"])
def test_a_list_of_steps_reaches_only_into_named_folders(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], way: str
) -> None:
    thesis = tmp_path / "thesis" / "all.tex"
    thesis.parent.mkdir()
    thesis.write_text("x")
    (folder / "linked").symlink_to(thesis.parent)
    match way:
        case "absolute":
            steps(folder, deleted=[str(thesis)])
        case "above":
            steps(folder, replaced=[("../thesis/all.tex", "a.jsonl")])
        case "link":
            steps(folder, deleted=["linked/all.tex"])
        case "folder":  # it came with a copy of another folder
            (folder / "all.tex").write_text("x")
            steps(folder, inode=1, deleted=["all.tex"])
        case _:
            (folder / removal.JOURNAL).write_text("{")
    before = everything(tmp_path)
    assert taken_out(folder) == 1
    assert removal.JOURNAL in capsys.readouterr().err
    assert everything(tmp_path) == before
    if way in ("absolute", "link"):
        arguments = ["participants", str(folder), str(thesis.parent), "--code", "P07"]
        assert main([*arguments, "--withdraw", "--yes"]) == 0
        assert not thesis.exists()


# -- any course -----------------------------------------------------------------------------------

CODES = ("", "P07", "P08", "P09")


@st.composite
def courses(draw: st.DrawFn) -> list[Timed]:
    """Somebody after the other, with acts that may end in another one's time. As in a session,
    nobody comes while a trial runs.
    """
    first = start(participant=draw(st.sampled_from(CODES)))
    course: list[Timed] = [(0, first)]
    t, trial = 0.0, 0
    pending: list[m.Message] = []
    for number in range(draw(st.integers(1, 25))):
        t += draw(st.sampled_from([0.0, 0.5, 3.0]))
        what = draw(st.integers(0, 8))
        if what in (0, 5, 7) and trial:
            course.append((t, m.TrialEnded(trial=trial, outcome="done")))
            trial = 0
        if what == 0:
            message: m.Message = m.SessionChanged(
                participant=draw(st.sampled_from(CODES[1:])),
                condition=draw(st.sampled_from([None, "warm", "cold"])),
            )
        elif what == 1:
            message = m.ActionRequested(run=f"r{number}", action="Hi", source="key")
            pending.append(m.ActionDone(run=f"r{number}", action="Hi"))
        elif what == 2 and pending:
            message = pending.pop(draw(st.integers(0, len(pending) - 1)))
        elif what == 3:
            message = m.Note(text=draw(st.sampled_from(["x", "P07 came", "as P08 said"])))
        elif what == 4:
            message = m.reading("distance", float(number))
        elif what == 5:
            trial = number + 1
            message = m.TrialStarted(trial=trial, condition="warm")
        elif what == 6:
            message = m.Checkpoint(sha256="", lines=0)
        elif what == 7:
            message = m.ConditionsAssigned(
                participant=draw(st.sampled_from(CODES[1:])), order=["warm"], method="hand"
            )
        else:
            message = m.ModeChanged(driver="neck", was="idle", now="wizard")
        course.append((t, message))
    course += [(t + 1, end) for end in pending]
    return course


def summed(log: Path) -> None:
    """Give the checkpoints of a log their sums."""
    found, digest = [], hashlib.sha256()
    for number, line in enumerate(log.read_bytes().splitlines()):
        raw, fields = line, json.loads(line)
        if fields["kind"] in ("checkpoint", "session.end"):
            more = {"lines": number} if fields["kind"] == "checkpoint" else {}
            fields |= {"sha256": digest.hexdigest(), **more}
            raw = codec.encode(codec.decode_message(json.dumps(fields).encode())).rstrip()
        digest.update(raw + b"\n")
        found.append(raw + b"\n")
    log.write_bytes(b"".join(found))


@given(course=courses())
def test_whatever_happened_nothing_of_one_is_left_and_all_of_the_others(
    tmp_path_factory: pytest.TempPathFactory, course: list[Timed]
) -> None:
    folder = tmp_path_factory.mktemp("any")
    log = write(folder, course)
    summed(log)
    assert verify(log).sentences() == []
    before = {line.seq: line for line in read(log)}
    people = {part.participant for part in read_report(log, extras=NO_EXTRAS).figures.parts}
    figures = {code: figures_of(log, code) for code in people - {"", "P07"}}
    had_trials = timeline_of(said_in(log)).has_trials
    took_part = {*read_report(log, extras=NO_EXTRAS).figures.participants} - {"", "P07"}
    assert taken_out(folder) == 0
    assert is_free_of(folder, "P07")
    if not (logs := [*folder.glob("*S01.jsonl")]):
        assert not took_part
        return
    assert verify(logs[0]).sentences() == []
    # Where nobody else has trials, the others' time is no time outside of trials any more.
    still = timeline_of(said_in(logs[0])).has_trials
    for code in took_part if still == had_trials else ():
        assert figures_of(logs[0], code) == figures[code]
    for line in read(logs[0]):
        if line.kind not in CHANGED and b"P07" not in before[line.seq].raw:
            assert line.raw == before[line.seq].raw
    numbers = {line.seq for line in read(logs[0])}
    gone = set[int]()
    for each in messages(logs[0]):
        if isinstance(each, m.ParticipantWithdrawn):
            gone |= {*range(each.seq, each.last_removed + 1)}
    assert numbers | gone == {*before}


# -- logs as they are found -----------------------------------------------------------------------


def test_segments_are_put_together(
    tmp_path: Path,
) -> None:
    with recorder_rig(tmp_path) as rig:
        rig.start()
        rig.hub.publish(m.Note(text="before"))
        rig.disk.faults[rig.home] = "full"
        rig.hub.publish(m.Note(text="behind"))
        rig.hub.publish(m.SessionChanged(participant="P08"))
        rig.hub.publish(m.Note(text="of P08"))
        rig.hub.publish(m.SessionEnd(reason="wizard", sha256=rig.recorder.digest()[0]))
        rig.recorder.close()
    assert {path.parent for path in tmp_path.rglob("*.2.jsonl")} == {rig.spill}
    assert taken_out(rig.home) == 0
    assert not [*rig.spill.glob("*.jsonl")]
    (after,) = rig.home.glob("*S01.jsonl")
    assert verify(after).sentences() == []
    assert [line.text for line in messages(after) if isinstance(line, m.Note)] == ["of P08"]


def test_a_log_that_was_damaged_does_not_look_whole_afterwards(folder: Path) -> None:
    course: list[Timed] = [
        (0, start(participant="P08")),
        (2, m.Note(text="said")),
        (20, m.SessionChanged(participant="P07")),
        (30, m.Note(text="x")),
    ]
    log = write(folder, course)
    lost = codec.encode(m.Segment(log=log.stem, session="S01", number=1, dropped=3))
    log.write_bytes(log.read_bytes().replace(b"said", b"sang") + lost)
    wrong = verify(log).sentences()
    assert wrong
    assert taken_out(folder) == 0
    (after,) = folder.glob("*S01.jsonl")
    assert verify(after).sentences() == wrong


def test_numbers_that_are_really_missing_are_still_told(folder: Path) -> None:
    course: list[Timed] = [
        (0, start(participant="P07")),
        (2, m.Note(text="x")),
        (20, m.SessionChanged(participant="P08")),
        (30, m.Note(text="lost")),
        (31, m.Note(text="y")),
    ]
    log = write(folder, course, ended=False)
    lines = [line for line in log.read_bytes().splitlines(keepends=True) if b"lost" not in line]
    log.write_bytes(b"".join(lines))
    assert taken_out(folder) == 0
    (after,) = folder.glob("*S01.jsonl")
    assert "1 line(s) missing: 3" in verify(after).sentences()


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16"])
def test_a_log_that_another_program_saved_is_cut_too(folder: Path, encoding: str) -> None:
    course: list[Timed] = [(0, start(participant="P07")), (20, m.SessionChanged(participant="P08"))]
    log = write(folder, [*course, (40, m.Note(text="y"))])
    log.write_bytes(log.read_text(encoding="utf-8").encode(encoding))
    assert taken_out(folder) == 0
    (after,) = folder.glob("*S01.jsonl")
    assert verify(after).sentences() == []


def test_the_experiments_own_list_of_codes_stays(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    files = m.ExperimentFiles(experiment_sha256="", files={"a.yaml": "# P01 ... P07"})
    other = ExampleSession(participant="P08", session="S02").add(0, files).act(1).end(20)
    log = other.written(folder, "2026-03-02T10-00-00_P08_S02")
    before = log.read_bytes()
    assert main(["participants", str(folder), "--code", "P07"]) == 0
    assert "stands in no file" in capsys.readouterr().out
    assert taken_out(folder) == 0
    assert log.read_bytes() == before


def test_a_rerun_goes_with_the_session_that_it_ran_again(folder: Path) -> None:
    ExampleSession().act(1).end(20).written(folder, "2026-03-01T10-00-00_S01")
    rerun = ExampleSession(participant="", session="S02", wall="2026-03-05T10:00:00.000000Z")
    rerun.add(0, m.RerunStarted(original="2026-03-01T10-00-00_S01.jsonl", original_session="S01"))
    rerun.act(1).end(20).written(folder, "2026-03-05T10-00-00_S02")
    assert taken_out(folder) == 0
    assert everything(folder) == {}
    assert folder.is_dir()


def test_the_row_of_conditions_is_free_again(folder: Path) -> None:
    def assigned(code: str, row: int) -> m.ConditionsAssigned:
        order = ["warm", "cold"][:: 1 if row == 0 else -1]
        return m.ConditionsAssigned(participant=code, order=order, method="latin-square", row=row)

    session = ExampleSession(participant="", condition="")
    session.add(1, assigned("P07", 0)).add(2, m.TrialStarted(trial=1, condition="warm"))
    session.add(20, m.TrialEnded(trial=1, outcome="done"))
    session.add(30, assigned("P08", 1)).add(31, m.TrialStarted(trial=1, condition="cold"))
    session.add(50, m.TrialEnded(trial=1, outcome="done")).end(51)
    session.written(folder, "2026-03-01T10-00-00_S01")
    past = EarlierSessions(folder).read("", "experiments/guide.yaml").past
    assert [each.participant for each in past] == ["P07", "P08"]
    assert taken_out(folder) == 0
    (left,) = EarlierSessions(folder).read("", "experiments/guide.yaml").past
    assert left == past[1]


# -- what is remembered, and what is handed over ---------------------------------------------------


def test_it_is_recorded_what_was_taken_and_nothing_of_what_it_said(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    two_people(folder)
    ExampleSession(session="S02").act(1).end(20).written(folder, "2026-03-02T10-00-00_P07_S02")
    before = everything(folder)
    words = ["participants", str(folder), "--code", "P07", "--withdraw", "--yes", "--by", "W1"]
    assert main(words) == 0
    (record,) = withdrawals(folder)
    assert (record.code, record.by) == ("P07", "W1")
    assert record.lines > 10
    assert [file.name for file in record.deleted] == ["2026-03-02T10-00-00_P07_S02.jsonl"]
    for file in (*record.deleted, *record.cut):
        assert file.bytes == len(before[file.name])
        assert file.sha256 == hashlib.sha256(before[file.name]).hexdigest()
    assert "shy" not in (folder / RECORD).read_text()
    capsys.readouterr()
    assert main(["participants", str(folder)]) == 0
    told = capsys.readouterr()
    assert "P07 (" in told.out
    assert told.err == ""
    assert main(["report", str(folder)]) == 0, "the record is no log"


def test_the_code_is_never_given_again(folder: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.withdrawn = frozenset(["P08"])
        with pytest.raises(RequestError, match="P08 withdrew"):
            rig.session.set(participant="P08")
        rig.session.set(participant="P09")

    rig = SessionRig(folder.parent).run(scenario)
    assert [each.participant for each in rig.of(m.SessionChanged)] == ["P09"]


def test_a_record_that_cannot_be_read_stops_the_next_withdrawal(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    two_people(folder)
    (folder / RECORD).write_text("{")
    before = everything(folder)
    assert taken_out(folder) == 1
    assert f"{RECORD} cannot be read" in capsys.readouterr().err
    assert everything(folder) == before


def test_a_copy_has_what_is_kept_of_one_and_nothing_of_others(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    two_people(folder)
    ExampleSession(session="S02").act(1).end(20).written(folder, "2026-03-02T10-00-00_P07_S02")
    ExampleSession(participant="P08").act(1).end(9).written(folder, "2026-03-03T10-00-00_P08_S03")
    before = everything(folder)
    target = tmp_path / "copy"
    words = ["participants", str(folder), "--code", "P07", "--copy", str(target)]
    assert main(words) == 0, capsys.readouterr().err
    assert everything(folder) == before
    assert is_free_of(target, "P08")
    logs = sorted(target.glob("*/*_S0?.jsonl"))
    assert len(logs) == 2
    assert all(verify(log).sentences() == [] for log in logs)
    (shared, alone) = logs
    notes = [line.text for line in messages(shared) if isinstance(line, m.Note)]
    assert notes == ["P07 was shy"]
    assert alone.read_bytes() == (folder / alone.name).read_bytes()
    assert "P07" in (target / "README.txt").read_text()
    assert main(words) == 1, "nothing is written over"
