"""The examples of the wire, every kind of message, recorded by the real hub and recorder.

It makes the golden log of the present schema:

    python -m tests.log.story

writes it anew after a wanted change. Golden logs of older schemas are never written again.
"""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

from tests.log.bench import Bench, until
from tests.protocol.examples import MESSAGES
from tests.protocol.study_examples import BEGINNING
from woz_tui.protocol import messages as m
from woz_tui.system.clock import timestamp

GOLDEN = Path(__file__).parent / "golden" / f"v{m.SCHEMA}"


def tell(folder: Path) -> None:
    """Record the story into `folder`/recordings and, after the disk is full, `folder`/spill."""
    morning, afternoon = _course()
    it = Bench(folder).begin()
    try:
        for message in morning:
            _say(it, message)
            it.synced()  # or its disk would seem to stand still: time goes on with each message
        _checkpoint(it)
        it.synced()
        it.disk.faults[it.home] = "full"
        _say(it, m.Note(text="the disk is full from here on"))
        until(lambda: it.recorder.path.parent == it.spill, "the second folder")
        for message in afternoon:
            _say(it, message)
            it.synced()
        _checkpoint(it)
        _say(it, m.SessionEnd(reason="wizard", sha256=it.recorder.digest()[0]))
    finally:
        it.recorder.close()


def _say(it: Bench, message: m.AnyMessage) -> None:
    it.clock.advance(0.25)
    it.hub.publish(message)


def _checkpoint(it: Bench) -> None:
    digest, lines = it.recorder.digest()
    _say(it, m.Checkpoint(sha256=digest, lines=lines))
    _say(it, m.ClockTie(wall=timestamp(it.clock.wall())))


def _course() -> tuple[list[m.AnyMessage], list[m.AnyMessage]]:
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
