"""A session's messages through the engagement model once more, with its settings or with others.

A log has its settings itself (`engagement.settings`), also those that a reload brought in the
middle. What a command line names stands above all of them, and above the wizard's keys for just
that: whoever asks for another filter asks for it from the beginning to the end.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import msgspec

from woz_tui.config.engagement import EngagementSettings
from woz_tui.config.engagement_json import plain, settings_from
from woz_tui.config.session_verbs import ENGAGEMENT
from woz_tui.protocol import messages as m
from woz_tui.sensing.engagement_model import Transition
from woz_tui.sensing.engagement_stream import EngagementFollower
from woz_tui.timeline.session_state import SessionState

#: Arguments of the verbs by which the wizard changes settings while a session runs.
FILTER = frozenset({"kind", "samples", "threshold"})


@dataclass(frozen=True)
class SettingsOverride:
    """What stands above a log: `change` makes of the settings recorded those to go by, `named` are
    the arguments of verbs that do not count, such as `{"filter": {"kind"}}`.
    """

    change: Callable[[EngagementSettings], EngagementSettings] = lambda recorded: recorded
    named: Mapping[str, frozenset[str]] = field(default_factory=dict)
    #: Whether all of the log is computed with the same settings.
    one: bool = False

    @classmethod
    def always(
        cls, settings: EngagementSettings, named: Mapping[str, frozenset[str]] | None = None
    ) -> SettingsOverride:
        """The same settings, whatever the log tells."""
        return cls(lambda recorded: settings, named or {}, one=True)


class ModelRerun:
    """The model as it goes through a log.

    Args:
        settings: Those of the beginning; None: there is no model before the log tells some.
        above: What is made of what the log tells.
    """

    def __init__(self, settings: EngagementSettings | None, above: SettingsOverride) -> None:
        self.settings = settings or EngagementSettings()
        self.follower = None if settings is None else EngagementFollower(settings)
        self.above = above
        self._state = SessionState()
        #: Verbs with arguments that do not count, by command.
        self._asked: dict[str, str] = {}
        #: When keys of the wizard were passed over, in microseconds.
        self.passed_over: list[int] = []
        #: Why settings of the log were not taken.
        self.unreadable: list[str] = []
        #: When the log told settings, in microseconds.
        self.told: list[int] = []

    def take(self, message: m.AnyMessage) -> Sequence[Transition]:
        """One message; the transitions that it brought."""
        if not isinstance(message, m.Reading | m.EngagementShown):
            self._state.take(message)
        heard = self._meant(message)
        if heard is None or self.follower is None:
            return ()
        return [*self.follower.take(heard)]

    def until(self, t: int) -> Sequence[Transition]:
        """What happens by itself up to `t`."""
        return () if self.follower is None else [*self.follower.until(t)]

    def _meant(self, message: m.AnyMessage) -> m.AnyMessage | None:
        """The message as the model is to hear it; None: not at all."""
        match message:
            case m.EngagementAdopted():
                return self._settled(message)
            case m.Command(driver=driver, verb=verb) if driver == ENGAGEMENT:
                if verb in self.above.named:
                    self._asked[message.command] = verb
            case m.End(command=command) if command in self._asked:
                return self._obeyed(message, self.above.named[self._asked.pop(command)])
        return message

    def _obeyed(self, end: m.AnyMessage, named: frozenset[str]) -> m.AnyMessage | None:
        if not isinstance(end, m.Done) or not named & end.sent.keys():
            return end
        self.passed_over.append(end.t)
        left = {name: value for name, value in end.sent.items() if name not in named}
        return msgspec.structs.replace(end, sent=left) if left.keys() - {"sign"} else None

    def _settled(self, told: m.EngagementAdopted) -> m.AnyMessage | None:
        self.told.append(told.t)
        if not told.settings:
            self.follower = None
            return None
        try:
            self.settings = self.above.change(settings_from(told.settings))
        except ValueError as error:
            self.unreadable.append(str(error))
            return None
        if self.follower is None:
            self._begin(self.settings)
        return msgspec.structs.replace(told, settings=plain(self.settings))

    def _begin(self, settings: EngagementSettings) -> None:
        """As live: a model that begins in mid-session is told what holds."""
        self.follower = EngagementFollower(settings)
        self.follower.catch_up(self._state.messages())
