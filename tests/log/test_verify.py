from __future__ import annotations

from pathlib import Path

import pytest
from msgspec.structs import replace

from tests.log.recorder_rig import RecorderRig, recorder_rig
from woz_tui.log.verify import Verification, verify
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m

pytestmark = pytest.mark.safety


def end(rig: RecorderRig) -> None:
    rig.hub.publish(m.SessionEnd(reason="wizard", sha256=rig.recorder.digest()[0]))
    rig.recorder.close()


def checkpoint(rig: RecorderRig) -> None:
    digest, lines = rig.recorder.digest()
    rig.hub.publish(m.Checkpoint(sha256=digest, lines=lines))


def act(rig: RecorderRig, run: str, ends: int = 1) -> None:
    rig.hub.publish(m.ActionRequested(run=run, action="nod", source="key"))
    for _ in range(ends):
        rig.hub.publish(m.ActionDone(run=run, action="nod"))


def verdict(rig: RecorderRig) -> Verification:
    return verify(rig.recorder.path, places=[rig.home, rig.spill])


def test_a_whole_log_is_sound(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        act(rig, "r1")
        rig.sample()
        checkpoint(rig)
        end(rig)
        verification = verdict(rig)
    assert verification.sound, verification.sentences()
    assert (verification.lines, verification.samples, verification.checkpoints) == (4, 1, 2)


def test_a_log_in_two_folders_is_sound(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        act(rig, "r1")
        rig.synced()
        rig.disk.gate.clear()
        act(rig, "r2")
        rig.disk.faults[rig.home] = "full"
        act(rig, "r3")
        rig.disk.gate.set()
        checkpoint(rig)
        end(rig)
        verification = verdict(rig)
    assert verification.sound, verification.sentences()
    assert verification.checkpoints == 2


def test_a_changed_line_is_noticed(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        rig.note("first")
        checkpoint(rig)
        rig.note("warm")
        end(rig)
        path = rig.recorder.path
        path.write_bytes(path.read_bytes().replace(b"warm", b"cold"))
        verification = verdict(rig)
    assert verification.broken_after == 1
    assert verification.sentences() == ["lines after number 1 were changed or lost"]


def test_missing_lines_are_named(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        for _ in range(6):
            rig.note()
        end(rig)
        lines = rig.recorder.path.read_bytes().splitlines(keepends=True)
        rig.recorder.path.write_bytes(b"".join([lines[0], lines[2], *lines[5:]]))
        verification = verdict(rig)
    assert (verification.damage.missing, verification.damage.gaps) == (3, [(1, 1), (3, 4)])
    assert "3 line(s) missing: 1, 3 to 4" in verification.sentences()


def test_a_session_that_was_cut_off(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        rig.note()
        rig.recorder.close()
        assert not verdict(rig).ended
        assert not verdict(rig).sound


def test_every_request_has_exactly_one_end(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        act(rig, "open", ends=0)
        act(rig, "twice", ends=2)
        rig.hub.publish(m.Failed(command="c9", reason="never asked for"))
        rig.hub.publish(m.Command(command="c1", verb="play", args={}, source="key"))
        rig.hub.publish(m.Refused(command="c1", code="busy"))
        end(rig)
        verification = verdict(rig)
    assert (verification.unended, verification.ended_twice, verification.unasked) == (
        ["open"],
        ["twice"],
        ["c9"],
    )


def test_lines_that_were_taken_out_are_not_missing_and_others_are(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        withdrawn = m.ParticipantWithdrawn(last_removed=9, removed=10, day="2026-05-04")
        rig.recorder.record(withdrawn, codec.encode(replace(withdrawn, seq=0, t=0)))
        for seq in (10, 12):
            note = m.Note(seq=seq, t=seq, ts="", text="x")
            rig.recorder.record(note, codec.encode(note))
        rig.recorder.close()
        assert verdict(rig).damage.gaps == [(11, 11)]
        assert "1 line(s) missing: 11" in verdict(rig).sentences()
