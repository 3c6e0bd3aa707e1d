"""What the wizard may use at the moment: everything, or what a profile of the experiment names.

The stop, its release, marks, notes and whatever drivers do by themselves are no affair of profiles.
"""

from __future__ import annotations

from woz_tui.config.experiment import Experiment
from woz_tui.features.profiles.kinds import AskProfile, ProfileChanged
from woz_tui.features.profiles.section import PROFILES, Profile
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError
from woz_tui.protocol.sentence import Sentence
from woz_tui.session.session_features import Client, FeatureSession, SessionFeature


class ProfileInUse(SessionFeature):
    """Knows the profile in use; what it does not allow is said by the gate."""

    requests = (AskProfile,)

    def __init__(self, session: FeatureSession) -> None:
        super().__init__(session)
        self.current: Profile | None = None

    def idle(self) -> bool:
        return self.current is None

    @classmethod
    def check_start(cls, value: str, experiment: Experiment) -> None:
        known = PROFILES.of(experiment)
        if value and value not in known:
            raise RequestError(
                Sentence("profiles.unknown", "there is no profile {value!r}", value=value),
                Sentence("gate.there_are", "there are {names}", names=", ".join(known))
                if known
                else Sentence("profiles.none", "the file has no profiles"),
            )

    def start(self, value: str) -> None:
        self.use(value, "start")

    def use(self, name: str, source: str) -> None:
        """From here on the wizard may use what this profile allows; an empty name: everything.

        Raises `RequestError` if there is no such profile.
        """
        experiment = self.session.experiment
        self.check_start(name, experiment)
        self.current = PROFILES.of(experiment)[name] if name else None
        self.session.idle_changed()
        self.session.hub.publish(ProfileChanged(profile=name, source=source))

    def carry_out(self, request: AskProfile, client: Client) -> str:
        self.use(request.profile, request.source)
        self.session.on_panels()
        return ""

    def adopt(self, experiment: Experiment) -> None:
        """A profile that has gone from the file holds on, because nobody said that everything may
        be used now; a sentence then says so.
        """
        if self.current is None:
            return
        name, known = self.current.name, PROFILES.of(experiment)
        if name in known:
            self.current = known[name]
            return
        text = Sentence(
            "profiles.removed",
            "the profile {name} was removed from the file, but is still in use",
            name=name,
        )
        notice = m.Notice(
            level="warning",
            text=text,
            remedy=Sentence("profiles.choose", "choose another profile"),
        )
        self.session.hub.publish(notice)

    def fact(self) -> Profile | None:
        return self.current
