"""How answers were delayed in sessions."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from woz_tui.analysis.durations import Durations
from woz_tui.analysis.event_rows import moments
from woz_tui.analysis.feature_figures import FeatureFigures, TimesMeasure
from woz_tui.analysis.text_format import clock, counted, in_seconds, listed
from woz_tui.features.delay.kinds import ActionHeld, ShapingChanged
from woz_tui.timeline.timeline import Timeline
from woz_tui.timeline.trial_context import Context

#: What a robot may answer, in words.
_CUES = {
    "speech": "the end of the visitor's speech",
    "engagement": "a change of the visitor's engagement",
    "marker": "a marker",
}


@dataclass(frozen=True, slots=True)
class ShapingRow:
    """From `t` on answers to these cues were held back: `floor_us`, and up to `jitter_us` more."""

    t: int
    floor_us: int
    jitter_us: int
    cues: tuple[str, ...]

    @property
    def delay(self) -> tuple[int, int, tuple[str, ...]] | None:
        """Floor, jitter and cues; None: nothing was held back."""
        if not self.cues or not (self.floor_us or self.jitter_us):
            return None
        return self.floor_us, self.jitter_us, tuple(sorted(self.cues))


def answer_delay(cues: Sequence[str], floor_us: int, jitter_us: int) -> str:
    """How soon the robot answered these cues: the sentence of `shaping.changed`."""
    if not cues or not (floor_us or jitter_us):
        return "the robot answered at once"
    more = f", plus a random 0 to {jitter_us / 1e6:g} s" if jitter_us else ""
    named = listed([_CUES.get(cue, cue) for cue in cues], "or")
    return f"the robot answered {named} no sooner than {floor_us / 1e6:g} s after it{more}"


def _median_s(times: Durations) -> float | None:
    return None if times.median is None else times.median / 1e6


class DelayFigures(FeatureFigures):
    """Each change of how answers were delayed, and how long actions were held back."""

    key = "shaping"
    measures = (
        TimesMeasure(
            name="actions_held",
            unit="",
            meaning="lines `action.held`: answers that shaping held back",
            short="held",
            times="held",
            of=len,
            title="Answers delayed on purpose",
        ),
        TimesMeasure(
            name="held_median_s",
            unit="s",
            meaning="median time for which they were held, from the line to `until`",
            short="held s",
            times="held",
            of=_median_s,
            title="Delay on purpose, median",
        ),
    )

    def count(self, timeline: Timeline) -> tuple[ShapingRow, ...] | None:
        changes = (line for _, line in moments(timeline, ShapingChanged))
        rows = (ShapingRow(it.t, it.floor_us, it.jitter_us, tuple(it.cues)) for it in changes)
        return tuple(rows) or None

    def times(self, timeline: Timeline) -> Iterator[tuple[Context, str, int]]:
        for context, line in moments(timeline, ActionHeld):
            yield context, "held", max(0, line.until - line.t)

    def circumstances(self, figures: tuple[ShapingRow, ...]) -> Iterator[str]:
        for row in figures:
            yield f"from {clock(row.t)} {answer_delay(row.cues, row.floor_us, row.jitter_us)}"

    def methods(self, sessions: Sequence[tuple[ShapingRow, ...]]) -> Iterator[str]:
        found = (delay for rows in sessions for delay in {row.delay for row in rows})
        delays = Counter(delay for delay in found if delay is not None)
        for (floor, jitter, cues), count in sorted(delays.items()):
            yield f"In {counted(count, 'session')} {answer_delay(cues, floor, jitter)}."

    def methods_of_times(self, times: Mapping[str, Durations]) -> Iterator[str]:
        held = times.get("held", Durations())
        if held.median is not None:
            yield (
                f"Earlier actions were delayed: {counted(held.n, 'action')}, by"
                f" {in_seconds(held.median)} s in the median."
            )


FIGURES = DelayFigures()
