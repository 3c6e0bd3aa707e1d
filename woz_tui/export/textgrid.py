"""Praat TextGrids in the long text format: intervals that cover the whole session, and points.

The format is described in Praat's manual, "TextGrid file formats".
"""

from __future__ import annotations

from collections.abc import Iterator

from woz_tui.export.event_model import ExportSession
from woz_tui.export.exporter import Exporter
from woz_tui.export.log_sources import LogSource
from woz_tui.export.tiers import Tier, TierSpan, tiers_of, unique_names, without_overlaps
from woz_tui.export.visitor_sound import write_sound
from woz_tui.system.text_cleaning import one_line, seconds

#: Praat has no intervals without a duration.
SHORTEST_US = 1000
_ABOUT = """## Files

One `.TextGrid` for each session: open it in Praat. Where the visitor was recorded, a `.wav` of the
same name runs along with the session (silence where nobody was recorded); open it with
*Open long sound file*, select both, *View & Edit*.

Interval tiers: `trials`, `phases`, `breaks`, `engagement` (the state), `visitor speech` (as it was
understood), `robot speech` (from the moment when it began to speak), `panel ...` (the actions of
each panel, from the request to the end; the outcome in brackets unless it was done), `stops`,
`questionnaires`, `settings that differ` (what a robot had, and what was wanted), `conflicts` (of a
robot's settings). Point tiers: `markers`, `notes`, `mistakes`, `cues`, `slots`, `proposals`,
`streams` (of and to a lab), `choices` (on a page), `dictation`, `pages` (in browsers), `drivers`,
`settings` (of the session). Of each coder the tiers that they coded in a replay, called after them.
What overlaps is on a tier `...-2`. Intervals shorter than 1 ms were prolonged to that. Line ends
and tabs in texts are shown as ␊ and ␉."""


class TextGridExporter(Exporter):
    """Writes one file for each session."""

    meaning = "Praat"
    about = _ABOUT

    def add(self, session: ExportSession, source: LogSource) -> list[str]:
        """Writes one session, with its sound."""
        length, notes = 0, list[str]()
        if self._options.sound:
            length, notes = write_sound(session, self._folder, f"{session.name}.wav")
        tiers = for_praat(session)
        end = max([session.duration, length, SHORTEST_US, *(tier.spans[-1].end for tier in tiers)])
        with self._folder.text(f"{session.name}.TextGrid") as file:
            file.writelines(f"{line}\n" for line in _lines(tiers, end))
        return notes


def for_praat(session: ExportSession) -> list[Tier]:
    """The session's tiers in microseconds, without overlaps."""
    return unique_names(
        each for tier in tiers_of(session) for each in without_overlaps(tier, SHORTEST_US)
    )


def _lines(tiers: list[Tier], end: int) -> Iterator[str]:
    yield 'File type = "ooTextFile"'
    yield 'Object class = "TextGrid"'
    yield ""
    yield "xmin = 0"
    yield f"xmax = {seconds(end)}"
    yield "tiers? <exists>"
    yield f"size = {len(tiers)}"
    yield "item []:"
    for number, tier in enumerate(tiers, start=1):
        yield f"    item [{number}]:"
        yield f'        class = "{"TextTier" if tier.points else "IntervalTier"}"'
        yield f"        name = {_quoted(tier.name)}"
        yield "        xmin = 0"
        yield f"        xmax = {seconds(end)}"
        if tier.points:
            yield f"        points: size = {len(tier.spans)}"
            for place, span in enumerate(tier.spans, start=1):
                yield f"        points [{place}]:"
                yield f"            number = {seconds(span.begin)}"
                yield f"            mark = {_quoted(span.text)}"
        else:
            covering = list(_covering(tier, end))
            yield f"        intervals: size = {len(covering)}"
            for place, span in enumerate(covering, start=1):
                yield f"        intervals [{place}]:"
                yield f"            xmin = {seconds(span.begin)}"
                yield f"            xmax = {seconds(span.end)}"
                yield f"            text = {_quoted(span.text)}"


def _covering(tier: Tier, end: int) -> Iterator[TierSpan]:
    """The spans with empty ones between them, from 0 to `end`."""
    position = 0
    for span in tier.spans:
        if span.begin > position:
            yield TierSpan(position, span.begin, "")
        yield span
        position = span.end
    if position < end:
        yield TierSpan(position, end, "")


def _quoted(text: str) -> str:
    return '"' + one_line(text).replace('"', '""') + '"'
