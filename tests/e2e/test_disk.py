"""The disk fills up under the log while a session runs."""

from __future__ import annotations

import resource

import pytest

from tests.e2e import scenes
from tests.e2e.lab import Lab, end_session, until
from woz_tui.log import log_reader

pytestmark = [pytest.mark.real_clock, pytest.mark.safety]

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
