"""Plays repairs of what was said: repeat it, reword it, interrupt it."""

from __future__ import annotations

from dataclasses import replace

from woz_tui.config.experiment import Action, Call
from woz_tui.features.repairs.section import INTERRUPT, PANEL, REPEAT, REWORD
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError
from woz_tui.protocol.requesters import requester
from woz_tui.protocol.sentence import Sentence
from woz_tui.session.action_runner import may_speak
from woz_tui.session.action_texts import Steps
from woz_tui.session.session_features import FeatureSession, SessionFeature

#: Those that have no steps.
PLAYED = (REPEAT, REWORD, INTERRUPT)


class RepairsInSession(SessionFeature):
    """Plays the repairs that have no steps of their own."""

    def __init__(self, session: FeatureSession) -> None:
        super().__init__(session)
        self._last: m.Command | None = None
        #: To whom that was said.
        self._told = ("", "")
        #: The action of the file that said it.
        self._action = ""
        #: The last line by which a robot spoke that was looked at.
        self._seen = -1

    @property
    def _whom(self) -> tuple[str, str]:
        """Participant and condition."""
        return self.session.state.study.participant, self.session.state.study.condition

    def _look(self) -> None:
        """See what was said last, and to whom; repairs themselves are passed over."""
        new = [each for each in self.session.state.spoken if each.seq > self._seen]
        for each in new:
            self._seen, request = each.seq, each.request
            if request.panel == PANEL and request.action != REWORD:
                continue
            self._last, self._told = request, (each.context.participant, each.context.condition)
            self._action = self._action if request.action == REWORD else request.action

    def play(self, action: Action, origin: RequestOrigin, when_busy: str, at: int) -> str | None:
        """Its steps depend on what was said; the refusal is in the log too."""
        if action.name not in PLAYED:
            return None
        self._look()
        steps: Steps | str
        if at:
            steps = Sentence(
                "repairs.not_later",
                "{name!r} depends on what was said last: play it now",
                name=action.name,
            )
        elif action.name == INTERRUPT:
            run, _ = self.session.runner.play(action, origin, when_busy, steps=[])
            self._interrupt(
                requester(origin.source, self.session.state.consoles.get(origin.console))
            )
            return run
        else:
            steps = self._other_words() if action.name == REWORD else self._again()
        if isinstance(steps, str):
            self.session.runner.refuse(action.name, action.panel, origin, steps)
            raise RequestError(steps)
        run, refused = self.session.runner.play(action, origin, when_busy, steps=steps)
        if refused is not None:
            if action.name == REWORD:
                self.session.texts.take_back()
            raise refused
        return run

    def _again(self) -> Steps | str:
        """As it was said, to whom it was kept from."""
        last = self._last
        if last is None or self._told != self._whom:
            return Sentence("repairs.nothing_said", "nothing has been said yet")
        call = Call(last.verb, dict(last.args), last.driver)
        return [(replace(call, tells=last.tells, unfilled=dict(last.unfilled)),)]

    def _other_words(self) -> Steps | str:
        """The next wording of the call that said it."""
        if self._last is None or self._told != self._whom:
            return Sentence("repairs.nothing_said", "nothing has been said yet")
        action = self.session.experiment.action(self._action)
        steps = self.session.texts.other(action, self._last) if action is not None else None
        return steps or Sentence("repairs.no_other_words", "the last sentence has no other words")

    def _interrupt(self, by: str) -> None:
        """End what is said or is still to be said; everything else goes on."""
        why = Sentence("repairs.interrupted", "interrupted by {by}", by=by)
        self.session.runner.cut_speech(why)
        for command in list(self.session.state.commands.values()):
            if may_speak(command.request):
                self.session.runner.cancel(command.request.command, why)
