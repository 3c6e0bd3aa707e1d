"""Plays what belongs to the states of the engagement model: signals, effects, actions of panels.

Rules:

* What a state has begun is finished; its steps that still wait when the state is left are dropped,
  for a pause, or for a robot that is busy.
* A greeting is not repeated: whoever comes back to EngagedWithKnown from their own or the robot's
  turn gets that state's effects without what is said there.
* While the stop is pressed nothing is played. At its release, and when a driver has connected, the
  lasting signals of the state (eyes, screen, emotion) are given again; what is heard is not.
* A signal overtakes an older one of its kind that is still on its way.
* What does not work is in the log, and the wizard is told of each reason once.
"""

from __future__ import annotations

import dataclasses
from collections import deque
from collections.abc import Iterable, Mapping

from woz_tui.config.experiment import Action, Call, ParallelCalls, Step
from woz_tui.gate.facts import Facts
from woz_tui.gate.questions import PlayEffect
from woz_tui.gate.table import why_not
from woz_tui.protocol import messages as m
from woz_tui.protocol.action_messages import SPEAKING_VERBS
from woz_tui.protocol.sentence import Sentence
from woz_tui.sensing.engagement_model import Transition
from woz_tui.sensing.model_time import SECOND
from woz_tui.sensing.state_machine import State
from woz_tui.session.engagement_robot import ORIGIN, EngagementRobot
from woz_tui.session.state_signals import StateSignals, nearly

#: Verbs whose result is seen until something else is shown.
LASTING_SIGNALS = frozenset({"eyes", "screen", "emotion"})
#: Where somebody has had a turn: the greeting has been said.
_TURNS = frozenset({State.USER_SPEAKS, State.THINKS, State.REPLIES, State.ROBOT_SPEAKS})
#: So many states in a second drive each other round by what is played on entering them.
MOST_STATES_A_SECOND = 30
#: A sound that comes too late says something wrong: it is not kept waiting.
_AT_ONCE = "refuse"


class StateEffects:
    """Plays what belongs to states.

    Args:
        robot: On which it is played.
        locked: Panels by title: whether they are locked.
    """

    def __init__(self, robot: EngagementRobot, locked: Mapping[str, bool]) -> None:
        self._robot, self._locked = robot, locked
        self._state: str = State.WAIT
        self._reported: set[str] = set()
        self._runs: set[str] = set()
        self._left: set[str] = set()
        #: Ends of runs that nobody has claimed yet: they may end while they begin.
        self._early: deque[m.ActionEnd] = deque(maxlen=8)
        self._shown: dict[tuple[str, str], str] = {}
        self._times: deque[int] = deque(maxlen=MOST_STATES_A_SECOND)
        self.adopt()

    def adopt(self) -> None:
        """The experiment was read: from now on its effects count."""
        self._signals = StateSignals(self._robot.session.experiment)
        self._signals.entered(self._state)

    def model_removed(self) -> None:
        """There is no model any more. What waits is dropped, and another one begins anew."""
        self._leave(Sentence("session.engagement_removed", "the engagement model was removed"))
        self._runs.clear()
        self._left.clear()
        self._state = State.WAIT

    # -- when --------------------------------------------------------------------------------------

    def entered(self, change: Transition) -> None:
        self._leave(
            Sentence(
                "session.state_changed",
                "the state changed from {before} to {now}",
                before=self._state,
                now=change.now,
            )
        )
        self._state = change.now
        calls = self._signals.entered(change.now)
        if not self._robot.may_move:
            return
        self._signal(calls)
        engagement = self._robot.session.experiment.engagement
        if engagement is None:
            return
        if self._chased(change.t):
            self._report(
                Sentence(
                    "session.states_loop",
                    "the states change in a loop; actions of on_enter are not played",
                )
            )
            return
        again = change.now == State.KNOWN and change.was in _TURNS
        action = engagement.effects.get(change.now)
        if action is not None:
            self._play(action, again)
        for name in engagement.plays.get(change.now, ()):
            self._play_named(name, again)

    def nearly_engaged(self, shown: m.EngagementShown) -> None:
        """The signs moved: somebody may be nearly engaged, or not any more."""
        verdicts: dict[str, m.Json] = {name: sign.verdict for name, sign in shown.signs.items()}
        calls = self._signals.nearly_engaged(nearly(verdicts, shown.uses))
        if self._robot.may_move:
            self._signal(calls)

    def released(self) -> None:
        """The stop was released: what lasts is shown again."""
        self._signal(self._lasting())

    def connected(self, driver: str) -> None:
        """A driver is there, for the first time or again: it shows what lasts."""
        if not self._robot.is_stopped:
            self._signal(call for call in self._lasting() if call.driver == driver)

    def _lasting(self) -> list[Call]:
        """What is to be seen in the present state, and stays to be seen."""
        if self._robot.session.ended:
            return []
        engagement = self._robot.session.experiment.engagement
        action = engagement.effects.get(self._state) if engagement else None
        own = self._robot.session.texts.calls(action) if action else ()
        calls = [*self._signals.entered(self._state), *own]
        return [call for call in calls if call.verb in LASTING_SIGNALS]

    def ended(self, end: m.ActionEnd) -> None:
        """A run has ended; if it was one of these and has not worked, the wizard is told."""
        if end.run not in self._runs:
            self._early.append(end)
            return
        self._runs.discard(end.run)
        self._left.discard(end.run)
        if isinstance(end, m.ActionFailed | m.ActionRefused):
            self._report(f"{end.action}: {end.reason}", tells=end.tells)

    # -- what --------------------------------------------------------------------------------------

    def _leave(self, why: str) -> None:
        for run in list(self._runs - self._left):
            self._left.add(run)
            self._robot.session.runner.end_after_step(run, why)

    def _chased(self, t: int) -> bool:
        """Whether states follow each other as only their own effects can make them."""
        self._times.append(t)
        return len(self._times) == MOST_STATES_A_SECOND and t - self._times[0] < SECOND

    def _play(self, action: Action, again: bool) -> None:
        action = _without_speech(action) if again else action
        if action.steps:
            self._began(self._robot.session.runner.play(action, ORIGIN)[0])

    def _play_named(self, name: str, again: bool) -> None:
        """An action of a panel, as far as no lock stands against it.

        What the wizard may use by their profile is no affair of the robot's own.
        """
        action = self._robot.session.experiment.action(name)
        if action is None:
            self._report(Sentence("session.no_action", "there is no action {name!r}", name=name))
            return
        refusal = why_not(Facts(locked=self._locked), PlayEffect(name, action))
        if refusal is not None:
            self._began(
                self._robot.session.runner.refuse(name, action.panel, ORIGIN, refusal.reason)
            )
        else:
            self._play(action, again)

    def _began(self, run: str) -> None:
        self._runs.add(run)
        early = [end for end in self._early if end.run == run]
        self._early.clear()
        for end in early:
            self.ended(end)

    def _signal(self, calls: Iterable[Call]) -> None:
        for call in calls:
            self._show(call)

    def _show(self, call: Call) -> None:
        kind = (call.driver, call.verb)
        lasting = call.verb in LASTING_SIGNALS
        older = self._shown.pop(kind, "")
        if older and lasting:
            self._robot.session.runner.cancel(
                older, Sentence("session.state_now", "the state is now {state}", state=self._state)
            )
        done: list[m.End] = []

        def ended(end: m.End) -> None:
            done.append(end)
            if self._shown.get(kind) == end.command:
                del self._shown[kind]
            self._report_signal(call, end)

        when_busy = "queue" if lasting else _AT_ONCE
        sent = self._robot.session.runner.send(call, ORIGIN, when_busy, None, ended)
        if not done:
            self._shown[kind] = sent.command

    def _report_signal(self, call: Call, end: m.End) -> None:
        if isinstance(end, m.Failed | m.TimedOut):
            text = Sentence(
                "session.verb_failed",
                "{verb} failed on {driver}: {reason}",
                verb=call.verb,
                driver=call.driver,
                reason=end.reason,
            )
            self._report(text, end.remedy, end.tells)
        elif isinstance(end, m.Refused) and end.code not in ("busy", "stopped"):
            text = Sentence(
                "session.verb_refused",
                "{driver} refuses {verb}: {reason}",
                driver=call.driver,
                verb=call.verb,
                reason=end.reason,
            )
            self._report(text, end.remedy, end.tells)

    def _report(self, why: str, remedy: str = "", tells: tuple[str, ...] = ()) -> None:
        """A notice, once for each reason."""
        if why not in self._reported:
            self._reported.add(why)
            self._robot.session.hub.publish(
                m.Notice(
                    level="warning",
                    text=Sentence("session.of_engagement", "engagement: {why}", why=why),
                    remedy=remedy,
                    tells=tells,
                )
            )


def _without_speech(action: Action) -> Action:
    """Without what is said, and without what waits for it."""
    steps: list[Step] = []
    for step in action.steps:
        if isinstance(step, ParallelCalls):
            calls = tuple(call for call in step.calls if call.verb not in SPEAKING_VERBS)
            steps += [ParallelCalls(calls)] if calls else []
        else:
            steps.append(step)
    if not any(isinstance(step, ParallelCalls) for step in steps):
        steps = []
    return dataclasses.replace(action, steps=tuple(steps))
