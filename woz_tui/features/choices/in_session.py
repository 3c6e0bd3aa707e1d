"""Offers choices, and plays what the file says of the one that was made."""

from __future__ import annotations

import base64
import contextlib
from collections.abc import Mapping
from pathlib import Path
from typing import ClassVar

from woz_tui.config.experiment import Experiment
from woz_tui.drivers.contract import Job, RejectedError, Scope
from woz_tui.features.choices.history import ChoiceHistory
from woz_tui.features.choices.kinds import (
    AskChoicePicture,
    AskChoose,
    ChoiceGone,
    ChoiceMade,
    ChoiceOffered,
)
from woz_tui.features.choices.section import CHOICES, MOST_BYTES, OFF, PICTURES, Choice
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json
from woz_tui.protocol.refusal import RequestError
from woz_tui.protocol.requesters import PARTICIPANT
from woz_tui.protocol.sentence import Sentence
from woz_tui.session.session_features import Client, FeatureSession, PerformingFeature

#: What a participant chose tells what they said, to who may not hear that.
_SAID = "transcript"
_NOT_OFFERED = Sentence("choices.not_offered", "this is not offered any more")


class ChoicesInSession(PerformingFeature):
    """The performer of the verb `choice`."""

    verbs = CHOICES.verbs
    requests = (AskChoose,)
    lookups = (AskChoicePicture,)

    def __init__(self, session: FeatureSession) -> None:
        super().__init__(session)
        #: The choice that is offered, as the file had it then.
        self._choice: Choice | None = None

    @property
    def _offered(self) -> ChoiceOffered | None:
        return self.session.state.history(ChoiceHistory).offered

    # -- offering ------------------------------------------------------------------------------

    async def perform(self, job: Job) -> Mapping[str, Json]:
        name = str(job.args["name"])
        if name == OFF:
            self._end("taken_back")
            return {"name": name}
        choice = CHOICES.called(self.session.experiment, name)
        if choice is None:
            raise RejectedError(
                Sentence("choices.no_choice", "there is no choice {name!r}", name=name),
                Sentence("choices.add", "add it to the file: choices: [...]"),
            )
        self._end("replaced")
        self._choice = choice
        tells = self.session.state.commands[job.command].request.tells
        self.session.hub.publish(
            ChoiceOffered(
                choice=choice.name,
                question=choice.question,
                options=[option.text for option in choice.options],
                pictures=[Path(option.picture).name for option in choice.options],
                tells=tells,
            )
        )
        if not any(each.role == PARTICIPANT for each in self.session.state.consoles.values()):
            text = Sentence(
                "choices.nobody_sees",
                "nobody has the participant's page open to see the choice {name}",
                name=name,
            )
            notice = m.Notice(
                level="warning",
                text=text,
                remedy=Sentence("choices.woz_page", "woz page"),
                tells=tells,
            )
            self.session.hub.publish(notice)
        return {"name": name}

    async def stop(self, scope: Scope) -> None:
        """A page moves nothing."""

    # -- choosing ------------------------------------------------------------------------------

    def carry_out(self, request: AskChoose, client: Client) -> str:
        offered, choice = self._offered, self._choice
        if offered is None or choice is None or offered.seq != request.offer:
            raise RequestError(_NOT_OFFERED)
        option = next((each for each in choice.options if each.text == request.option), None)
        if option is None:
            raise RequestError(
                Sentence(
                    "choices.no_option",
                    "there is no option {option!r}",
                    option=request.option,
                )
            )
        self.session.hub.publish(
            ChoiceMade(
                choice=offered.choice,
                option=option.text,
                after_us=request.after_us,
                console=client.console,
                tells=(*offered.tells, _SAID),
            )
        )
        if option.plays:
            with contextlib.suppress(RequestError):  # it is in the log, and on every screen
                self.session.play(option.plays, RequestOrigin(PARTICIPANT))
        return ""

    def look_up(self, request: AskChoicePicture) -> Json:
        offered, choice = self._offered, self._choice
        if offered is None or choice is None or offered.seq != request.offer:
            raise RequestError(_NOT_OFFERED)
        if not 0 <= request.place < len(choice.options):
            raise RequestError(Sentence("choices.unknown", "there is no such option"))
        file = Path(choice.options[request.place].picture)
        try:
            with file.open("rb") as opened:
                content = opened.read(MOST_BYTES + 1)
        except OSError as error:
            raise RequestError(f"{file.name}: {error.strerror}") from error
        if len(content) > MOST_BYTES:
            raise RequestError(Sentence("choices.too_large", "{name} is too large", name=file.name))
        kind = PICTURES.get(file.suffix.lower(), "")
        return {"type": kind, "bytes": base64.b64encode(content).decode()}

    # -- the end of an offer -------------------------------------------------------------------

    def _end(self, how: str) -> None:
        offered = self._offered
        if offered is not None:
            gone = ChoiceGone(choice=offered.choice, how=how, tells=offered.tells)
            self.session.hub.publish(gone)

    def _trial_ended(self, message: m.TrialEnded) -> None:
        self._end("moved_on")

    def _changed(self, message: m.SessionChanged) -> None:
        if message.participant is not None:
            self._end("moved_on")

    def adopt(self, experiment: Experiment) -> None:
        offered = self._offered
        if offered is not None and CHOICES.called(experiment, offered.choice) != self._choice:
            self._end("reloaded")

    def close(self) -> None:
        self._end("end")

    hears: ClassVar = {
        m.TrialEnded: _trial_ended,
        m.SessionChanged: _changed,
    }
