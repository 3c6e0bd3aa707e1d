"""The disk fills up under the log while a session runs."""

from __future__ import annotations

import resource

import pytest

from tests.e2e import scenes
from tests.e2e.lab import Lab, end_session, until
from woz_tui.log import log_reader

pytestmark = [pytest.mark.real_clock, pytest.mark.safety]

HOME = "\x1b[H"
FREE = (resource.RLIM_INFINITY, resource.RLIM_INFINITY)


def test_full_disk(lab: Lab) -> None:
    spill = lab.folder / "spill"
    terminal = lab.run(lab.file("guide.yaml", scenes.guide()), "--spill", str(spill), columns=120)
    first = lab.log.path
    damage = log_reader.Damage()

    def everything() -> list[log_reader.LogLine]:
        nonlocal damage
        damage = log_reader.Damage()
        return list(log_reader.read(first, damage, places=[spill]))

    def told(kind: str, count: int = 1) -> None:
        until(lambda: sum(line.kind == kind for line in everything()) >= count, f"{count} {kind}")

    terminal.send("h")
    told("action.done")
    host = lab.host_process()
    # The kernel takes nothing beyond this size any more, as it does on a full disk.
    host.rlimit(resource.RLIMIT_FSIZE, (first.stat().st_size + 200, resource.RLIM_INFINITY))
    terminal.send("n")
    terminal.send(" ")
    terminal.wait_for(lambda text: "RECORDING TROUBLE" in text.split("\n")[0])
    terminal.wait_text("Log: the disk is full")
    until(lambda: list(spill.glob("*.jsonl")), "a log in the second folder")
    host.rlimit(resource.RLIMIT_FSIZE, FREE)
    told("action.done", 3)
    terminal.send("\x1b")
    told("stop.confirmed")
    terminal.send("\x12")
    told("stop.released")
    terminal.send("h")
    told("action.done", 4)
    end_session(terminal)
    assert terminal.wait_exit() == 0

    lines = everything()
    assert [line.seq for line in lines] == list(range(len(lines)))
    assert damage.skipped == 0
    assert not damage.unreadable
    assert lines[0].kind == "session.start"
    assert lines[-1].kind == "session.end"
    played = [line.fields["action"] for line in lines if line.kind == "action.requested"]
    assert played == ["Hello", "Nod", "Hello", "Hello"]
    (last, *_) = sorted(spill.glob("*.jsonl"))
    assert [line.raw for line in log_reader.read(last)] == [line.raw for line in lines]


def test_no_folder_takes_the_log(lab: Lab) -> None:
    """Nothing is played that is not recorded, until the wizard says so on her screen."""
    spill = lab.folder / "spill"
    terminal = lab.run(lab.file("guide.yaml", scenes.guide()), "--spill", str(spill), columns=120)
    log = lab.log
    terminal.send("h")
    log.wait("action.done")
    host = lab.host_process()
    host.rlimit(resource.RLIMIT_FSIZE, (64, resource.RLIM_INFINITY))
    terminal.send("n")
    terminal.wait_text("Home go on without a record")
    terminal.wait_for(lambda text: "NOT RECORDED" in text.split("\n")[0])
    terminal.send("n")
    terminal.wait_text("press Home to go on without a record")
    terminal.send(HOME)
    terminal.wait_text("Until then actions are refused. The stop is not.")
    terminal.send("\r")
    terminal.wait_for(lambda text: "WITHOUT A RECORD" in text.split("\n")[0])
    terminal.send("n")
    terminal.wait_text("✓ Nod")
    terminal.send("\x1b")
    terminal.wait_text("STOPPED")
    host.rlimit(resource.RLIMIT_FSIZE, FREE)
    terminal.wait_for(lambda text: "RECORDING TROUBLE" in text.split("\n")[0])
    end_session(terminal)
    assert terminal.wait_exit() == 0

    damage = log_reader.Damage()
    lines = list(log_reader.read(log.path, damage, places=[spill]))
    assert [line.seq for line in lines] == list(range(len(lines)))
    told = [line for line in lines if line.kind in ("action.refused", "record.waived")]
    assert [line.kind for line in told] == ["action.refused", "action.refused", "record.waived"]
    later = [line for line in lines if line.seq > told[-1].seq]
    assert [line.fields["action"] for line in later if line.kind == "action.requested"] == ["Nod"]
    (said,) = damage.sentences()
    assert "no folder took the log from" in said
    assert "the wizard went on without a record" in said
    report = lab.woz("report", str(log.path))
    assert said in " ".join(report.communicate()[0].decode().split())
