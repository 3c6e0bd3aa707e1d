"""The examples of the wire, every kind of message, recorded by the real hub and recorder.

It makes the golden log of the present schema:

    python -m tests.log.story

writes it anew after a wanted change. Golden logs of older schemas are never written again.
"""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

from tests.log.recorder_rig import RecorderRig, until
from tests.protocol.examples import MESSAGES
from tests.protocol.study_examples import BEGINNING
from woz_tui.protocol import messages as m
from woz_tui.system.clock import timestamp

GOLDEN = Path(__file__).parent / "golden" / f"v{m.SCHEMA}"


def tell(folder: Path) -> None:
    """Record the story into `folder`/recordings and, after the disk is full, `folder`/spill."""
    morning, afternoon = _course()
    rig = RecorderRig(folder).begin()
    try:
        for message in morning:
            _say(rig, message)
            rig.synced()  # or its disk would seem to stand still: time goes on with each message
        _checkpoint(rig)
        rig.synced()
        rig.disk.faults[rig.home] = "full"
        _say(rig, m.Note(text="the disk is full from here on"))
        until(lambda: rig.recorder.path.parent == rig.spill, "the second folder")
        for message in afternoon:
            _say(rig, message)
            rig.synced()
        _checkpoint(rig)
        _say(rig, m.SessionEnd(reason="wizard", sha256=rig.recorder.digest()[0]))
    finally:
        rig.recorder.close()


def _say(rig: RecorderRig, message: m.Message) -> None:
    rig.clock.advance(0.25)
    rig.hub.publish(message)


def _checkpoint(rig: RecorderRig) -> None:
    digest, lines = rig.recorder.digest()
    _say(rig, m.Checkpoint(sha256=digest, lines=lines))
    _say(rig, m.ClockTie(wall=timestamp(rig.clock.wall())))


def _course() -> tuple[list[m.Message], list[m.Message]]:
    """The examples of the wire as a session's log has them, until the stop and from it on. What
    ends the log and what its recorder adds is not told but really done.
    """
    own = m.Segment | m.Checkpoint | m.SessionEnd
    start, *others = [each for each in MESSAGES if not isinstance(each, own)]
    course = [start, *BEGINNING, *(each for each in others if each not in BEGINNING)]
    stop = next(n for n, each in enumerate(course) if isinstance(each, m.StopPressed))
    return course[:stop], course[stop:]


def write_anew() -> None:
    """Replace the golden log of the present schema."""
    with tempfile.TemporaryDirectory() as folder:
        tell(Path(folder))
        shutil.rmtree(GOLDEN, ignore_errors=True)
        shutil.copytree(folder, GOLDEN)


if __name__ == "__main__":
    write_anew()
