"""What happens in a session as short words, for who analyses recordings and parses nothing.

`say/begin/reported`: parts are joined by slashes, as programs for EEG (MNE) take them apart, so
that `say/begin` finds each of them. Names come from the experiment file, blanks in them are `-`.
"""

from __future__ import annotations

import re
from collections import OrderedDict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from woz_tui.features.phases.kinds import PhaseChanged
from woz_tui.features.questionnaires.kinds import QuestionnaireEnded, QuestionnaireStarted
from woz_tui.protocol import messages as m
from woz_tui.protocol.description import Description

#: Characters of one name.
_MOST = 60
#: Commands and runs that are remembered: of those that have ended, motions still arrive.
_KEPT = 2000
#: How what was tried ended, where it was not done.
_ENDS: dict[type[m.Message], str] = {
    m.Failed: "failed",
    m.TimedOut: "timed_out",
    m.Refused: "refused",
    m.Stopped: "stopped",
    m.Superseded: "superseded",
    m.ActionFailed: "failed",
    m.ActionStopped: "stopped",
    m.ActionSuperseded: "superseded",
    m.ActionRefused: "refused",
}


@dataclass(frozen=True, slots=True)
class MarkerWord:
    """A word, and the moment that it marks, in microseconds on the axis of `t`."""

    t: int
    text: str


@dataclass(slots=True)
class _Under:
    """Something under way: an action's run, or a command of the run `run`."""

    word: str
    run: str = ""
    dispatched: int | None = None
    begun: bool = False


class MarkerWords:
    """Turns messages into words, in their order.

    A command begins at its first evidence: a point within it that the device told (`reported`), or
    where no such line comes, when it was sent (`timed`); then that is known at its end only, and
    the word comes late, with its moment. An action begins with its first command.

    Args:
        description: What the robot can do: names of moves are words, texts are not.
        texts: Whether texts of markers that people set may stand in words.
    """

    def __init__(self, description: Description, *, texts: bool = False) -> None:
        self._choices = {
            (verb.driver, verb.name): verb.arguments[0].name
            for verb in description.verbs
            if verb.arguments and verb.arguments[0].choices
        }
        self.texts = texts
        self._commands: OrderedDict[str, _Under] = OrderedDict()
        self._runs: OrderedDict[str, _Under] = OrderedDict()

    def of(self, message: m.Message) -> list[MarkerWord]:
        """The words of a message."""
        return [*self._of(message)]

    def _of(self, message: m.Message) -> Iterator[MarkerWord]:
        t = message.t
        match message:
            case m.ActionRequested():
                self._keep(self._runs, message.run, _Under(f"action/{name(message.action)}"))
                yield MarkerWord(t, f"action/{name(message.action)}/asked")
            case m.ActionEnd():
                run = self._runs.pop(message.run, None)
                word = run.word if run is not None else f"action/{name(message.action)}"
                evidence = message.evidence if isinstance(message, m.ActionDone) else ""
                yield MarkerWord(t, _ended(word, message, evidence))
            case m.Command() if not message.passing:
                word = f"{name(message.verb)}{self._choice(message)}"
                self._keep(self._commands, message.command, _Under(word, message.run))
            case m.Ack():
                yield from self._told(message)
            case m.StopPressed():
                word = "stop/pressed" if message.scope == "all" else "stop/driving"
                yield MarkerWord(message.pressed or t, word)
            case m.StopConfirmed(missing=missing):
                yield MarkerWord(t, "stop/missing" if missing else "stop/confirmed")
            case m.StopReleased():
                yield MarkerWord(t, "stop/released")
            case m.Marker(source=source) if source not in m.AUTOMATIC_MARKERS:
                text = f"/{name(message.text)}" if self.texts and message.text.strip() else ""
                yield MarkerWord(message.moment, f"mark{text}")
            case m.Mistake():
                yield MarkerWord(t, f"mistake/{name(message.action)}")
            case m.SpeechStarted():
                yield MarkerWord(message.began, "visitor/speech/begin")
            case m.SpeechEnded():
                yield MarkerWord(message.ended, "visitor/speech/end")
            case m.EngagementChanged():
                yield MarkerWord(t, f"engagement/{name(message.now)}")
            case _:
                yield from _of_study(message)

    def _told(self, message: m.Ack) -> Iterator[MarkerWord]:
        """What is told of a command."""
        command = self._commands.get(message.command)
        if command is None:
            return
        word, t = command.word, message.t
        match message:
            case m.Dispatched():
                command.dispatched = t
                yield MarkerWord(t, f"{word}/sent")
            case m.CommandMark(sort=sort):
                yield from self._begin(command, t, "reported")
                if sort == "stroke":
                    yield MarkerWord(t, f"{word}/stroke")
            case m.MotionArrived(evidence=evidence):
                yield MarkerWord(t, f"{word}/arrived/{evidence or 'timed'}")
            case m.MotionInterrupted():
                yield MarkerWord(t, f"{word}/interrupted")
            case m.End():
                if command.dispatched is not None:
                    yield from self._begin(command, command.dispatched, "timed")
                evidence = message.evidence if isinstance(message, m.Done) else ""
                yield MarkerWord(t, _ended(word, message, evidence))

    def _begin(self, command: _Under, t: int, evidence: str) -> Iterator[MarkerWord]:
        if command.begun:
            return
        command.begun = True
        yield MarkerWord(t, f"{command.word}/begin/{evidence}")
        run = self._runs.get(command.run)
        if run is not None and not run.begun:
            run.begun = True
            yield MarkerWord(t, f"{run.word}/begin/{evidence}")

    def _choice(self, command: m.Command) -> str:
        """What it does of several: `/wave`."""
        argument = self._choices.get((command.driver, command.verb))
        chosen = command.args.get(argument) if argument is not None else None
        return f"/{name(chosen)}" if isinstance(chosen, str) and chosen else ""

    @staticmethod
    def _keep(kept: OrderedDict[str, _Under], key: str, under: _Under) -> None:
        kept[key] = under
        if len(kept) > _KEPT:
            kept.popitem(last=False)


def name(text: str) -> str:
    """A part of a word."""
    return re.sub(r"[\s/]+", "-", text.strip())[:_MOST] or "-"


def _ended(word: str, message: m.Message, evidence: str) -> str:
    if (how := _ENDS.get(type(message))) is not None:
        return f"{word}/{how}"
    return f"{word}/end/{evidence}" if evidence else f"{word}/end"


def _of_study(message: m.Message) -> Iterable[MarkerWord]:
    match message:
        case m.TrialStarted(trial=trial):
            word = f"trial/{trial}/begin"
        case m.TrialEnded(trial=trial, outcome=outcome):
            word = f"trial/{trial}/{outcome}"
        case m.BreakStarted():
            word = "break/begin"
        case m.BreakEnded():
            word = "break/end"
        case QuestionnaireStarted(questionnaire=asked):
            word = f"questionnaire/{name(asked)}/begin"
        case QuestionnaireEnded(questionnaire=asked, reason=reason):
            word = f"questionnaire/{name(asked)}/{reason}"
        case PhaseChanged(phase=phase) if phase:
            word = f"phase/{name(phase)}"
        case m.SessionEnd():
            word = "session/end"
        case _:
            return ()
    return (MarkerWord(message.t, word),)
