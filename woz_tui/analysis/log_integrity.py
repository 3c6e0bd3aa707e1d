"""Whether a session's log is whole, in sentences: damage, what no disk took, a missing end."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from woz_tui.analysis.figures import LogIntegrity, SessionFigures
from woz_tui.log.file_names import FileName
from woz_tui.log.log_reader import Damage, LogFiles, LogLine
from woz_tui.log.verify import verify
from woz_tui.protocol import codec
from woz_tui.protocol.messages import AnyMessage, Checkpoint, EngagementShown, Reading, Segment
from woz_tui.system.files import open_regular

#: What stands in a log whose first line is lost.
NO_BEGINNING = "the first line is missing: all codes are unknown"
#: Lines of messages that are no actions.
_NO_ACTIONS = frozenset({Segment, Reading, EngagementShown})


class LineCount:
    """Counts the lines of actions: each checkpoint says how many there must be before it."""

    def __init__(self) -> None:
        self._lines = 0
        #: So many were lost before the last checkpoint.
        self.short = 0

    def take(self, item: AnyMessage | LogLine) -> None:
        """The next of the log, unknown ones too."""
        if type(item) is Checkpoint:
            self.short = max(self.short, item.lines - self._lines)
        if type(item) not in _NO_ACTIONS:
            self._lines += 1


def integrity_of(
    figures: SessionFigures, damage: Damage, files: LogFiles, roll: LineCount
) -> LogIntegrity:
    """As far as one pass over the actions in `files` can tell."""
    sentences = damage.sentences()
    if not figures.schema:
        sentences.append(NO_BEGINNING)
    known = damage.torn + damage.damaged + damage.misplaced + damage.dropped
    missing = max(0, roll.short - known)
    if missing and not damage.missing:  # else their numbers are named
        sentences.append(f"{missing} line(s) of actions missing")
    sentences += [f"went on in {path.name}: {head.reason}" for path, head in _moved(files.actions)]
    still_open = figures.whole.outcomes.open
    if figures.ended and still_open:
        sentences.append(f"{still_open} action(s) without an end")
    if not figures.ended:
        sentences.append(files.no_end())
    return LogIntegrity(
        sentences=tuple(sentences),
        ended=bool(figures.ended),
        left_out=damage.skipped,
        dropped=damage.dropped,
        dropped_samples=damage.dropped_samples,
        missing=missing,
        segments=max(1, len(files.actions)),
    )


def with_verification(
    whole: LogIntegrity, path: Path, places: Iterable[Path] | None
) -> LogIntegrity:
    """The same after checking every number and checksum, samples too."""
    found = verify(path, places=places).sentences()
    more = [sentence for sentence in found if sentence not in whole.sentences]
    return replace(whole, sentences=(*whole.sentences, *more), verified=True)


def _moved(actions: Sequence[Path]) -> Iterator[tuple[Path, Segment]]:
    for path in actions:
        name = FileName.parse(path.name)
        if name is not None and name.number > 1 and (head := _head(path)) is not None:
            yield path, head


def _head(path: Path) -> Segment | None:
    """The line with which a segment begins; None if it cannot be read."""
    try:
        with open_regular(path) as file:
            message = codec.decode_message(file.readline(codec.MAX_LINE))
    except (OSError, codec.WireError):
        return None
    return message if isinstance(message, Segment) else None
