"""Which profile was in use when."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import ClassVar

from woz_tui.features.profiles.kinds import ProfileChanged
from woz_tui.protocol import messages as m
from woz_tui.timeline.episodes import Episode, EpisodeOutcome
from woz_tui.timeline.feature_history import FeatureHistory, HistoryCase
from woz_tui.timeline.session_state import SessionState, succeed


class ProfileEpisode(Episode, frozen=True, kw_only=True):
    """A time in which the wizard might use only what a profile names."""

    kind = "profile"
    changed: ProfileChanged
    left: ProfileChanged | None = None

    @property
    def label(self) -> str:
        """The profile's name."""
        return self.changed.profile

    @property
    def source(self) -> str:
        """Who chose it."""
        return self.changed.source


class ProfileHistory(FeatureHistory):
    """The profile that is in use."""

    def __init__(self) -> None:
        self.changed: ProfileChanged | None = None
        self.episode: ProfileEpisode | None = None

    def restart(self) -> str | None:
        return self.changed.profile if self.changed is not None else None

    def _change(self, message: ProfileChanged, state: SessionState) -> Iterator[Episode]:
        self.changed, before = message, self.episode
        begun = ProfileEpisode(begin=state.t, seq=message.seq, changed=message)
        self.episode = begun if message.profile else None
        end = {"outcome": EpisodeOutcome.CHANGED, "left": message}
        return succeed(before, self.episode, message, state.t, **end)

    cases: ClassVar[Mapping[type[m.Message], HistoryCase]] = {ProfileChanged: _change}
