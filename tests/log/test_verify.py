from __future__ import annotations

from pathlib import Path

import pytest

from tests.log.bench import Bench, bench
from woz_tui.log.verify import Verification, verify
from woz_tui.protocol import messages as m

pytestmark = pytest.mark.safety


def end(it: Bench) -> None:
    it.hub.publish(m.SessionEnd(reason="wizard", sha256=it.recorder.digest()[0]))
    it.recorder.close()


def checkpoint(it: Bench) -> None:
    digest, lines = it.recorder.digest()
    it.hub.publish(m.Checkpoint(sha256=digest, lines=lines))


def act(it: Bench, run: str, ends: int = 1) -> None:
    it.hub.publish(m.ActionRequested(run=run, action="nod", source="key"))
    for _ in range(ends):
        it.hub.publish(m.ActionDone(run=run, action="nod"))


def verdict(it: Bench) -> Verification:
    return verify(it.recorder.path, places=[it.home, it.spill])


def test_a_whole_log_is_sound(tmp_path: Path) -> None:
    with bench(tmp_path) as it:
        act(it, "r1")
        it.sample()
        checkpoint(it)
        end(it)
        found = verdict(it)
    assert found.sound, found.sentences()
    assert (found.lines, found.samples, found.checkpoints) == (4, 1, 2)


def test_a_log_in_two_folders_is_sound(tmp_path: Path) -> None:
    with bench(tmp_path) as it:
        act(it, "r1")
        it.synced()
        it.disk.gate.clear()
        act(it, "r2")
        it.disk.faults[it.home] = "full"
        act(it, "r3")
        it.disk.gate.set()
        checkpoint(it)
        end(it)
        found = verdict(it)
    assert found.sound, found.sentences()
    assert found.checkpoints == 2


def test_a_changed_line_is_noticed(tmp_path: Path) -> None:
    with bench(tmp_path) as it:
        it.note("first")
        checkpoint(it)
        it.note("warm")
        end(it)
        path = it.recorder.path
        path.write_bytes(path.read_bytes().replace(b"warm", b"cold"))
        found = verdict(it)
    assert found.broken_after == 1
    assert found.sentences() == ["lines after number 1 were changed or lost"]


def test_missing_lines_are_named(tmp_path: Path) -> None:
    with bench(tmp_path) as it:
        for _ in range(6):
            it.note()
        end(it)
        lines = it.recorder.path.read_bytes().splitlines(keepends=True)
        it.recorder.path.write_bytes(b"".join([lines[0], lines[2], *lines[5:]]))
        found = verdict(it)
    assert (found.damage.missing, found.damage.gaps) == (3, [(1, 1), (3, 4)])
    assert "3 line(s) missing: 1, 3 to 4" in found.sentences()


def test_a_session_that_was_cut_off(tmp_path: Path) -> None:
    with bench(tmp_path) as it:
        it.note()
        it.recorder.close()
        assert not verdict(it).ended
        assert not verdict(it).sound


def test_every_request_has_exactly_one_end(tmp_path: Path) -> None:
    with bench(tmp_path) as it:
        act(it, "open", ends=0)
        act(it, "twice", ends=2)
        it.hub.publish(m.Failed(command="c9", reason="never asked for"))
        it.hub.publish(m.Command(command="c1", verb="play", args={}, source="key"))
        it.hub.publish(m.Refused(command="c1", code="busy"))
        end(it)
        found = verdict(it)
    assert (found.unended, found.ended_twice, found.unasked) == (["open"], ["twice"], ["c9"])
