"""Which profiles were in use in sessions."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from woz_tui.analysis.feature_figures import FeatureFigures
from woz_tui.analysis.text_format import counted
from woz_tui.features.profiles.history import ProfileEpisode
from woz_tui.timeline.timeline import Timeline


class ProfileFigures(FeatureFigures):
    """The names of a session's profiles, in the order of their first use."""

    def count(self, timeline: Timeline) -> tuple[str, ...] | None:
        return tuple(dict.fromkeys(each.label for each in timeline.of(ProfileEpisode))) or None

    def circumstances(self, figures: tuple[str, ...]) -> Iterator[str]:
        yield f"profiles in use: {', '.join(figures)}"

    def methods(self, sessions: Sequence[tuple[str, ...]]) -> Iterator[str]:
        for profile, count in sorted(Counter(name for each in sessions for name in each).items()):
            yield f"The profile {profile} restricted the choice in {counted(count, 'session')}."


FIGURES = ProfileFigures()
