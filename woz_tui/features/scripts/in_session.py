"""Follows the scripts of an experiment: the next line, the played ones, where one has halted.

The experiment's own script has the name "", that of a phase the phase's. A line counts as played
when its action is asked for, by whatever key; if it then fails, is cut or is marked as a mistake
before its end, the script goes back to it.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

from woz_tui.config.experiment import Experiment
from woz_tui.drivers.contract import Ask
from woz_tui.features.phases.kinds import PhaseChanged
from woz_tui.features.scripts.kinds import AskScript, ScriptMoved
from woz_tui.features.scripts.section import SCRIPT
from woz_tui.gate.questions import PlayAction, RequestOrigin
from woz_tui.gate.table import another_plays_action
from woz_tui.protocol import messages as m
from woz_tui.protocol.action_messages import SPEAKING_VERBS
from woz_tui.protocol.refusal import RequestError
from woz_tui.protocol.sentence import Sentence
from woz_tui.session.action_texts import NOTHING_GIVEN, GivenValues, given_values
from woz_tui.session.session_features import Client, FeatureSession, SessionFeature
from woz_tui.timeline.episodes import (
    ActionEpisode,
    CommandEpisode,
    Episode,
    EpisodeOutcome,
    TrialEpisode,
)

#: How a line ends behind which the script does not go on.
HALTING = (EpisodeOutcome.FAILED, EpisodeOutcome.REFUSED, EpisodeOutcome.STOPPED)
#: How `halted` names a line that was marked as a mistake before it ended.
MISTAKE = "mistake"


@dataclass(slots=True)
class ScriptState:
    """Where one script stands. `position`: the next line, from 0; `halted`: how the line ended at
    which it stands still. `last`: the line that was played last, until another one is chosen.
    """

    lines: Sequence[str] = ()
    position: int = 0
    played: set[int] = field(default_factory=set)
    halted: str = ""
    last: int | None = None

    def play(self, action: str) -> int | None:
        """The action is played: which line that is, if any; the position goes to the next line that
        was not played.
        """
        self.halted = ""
        line = self._line(action)
        if line is None:
            return None
        self.played.add(line)
        self.last = line
        if line == self.position:
            rest = range(line + 1, len(self.lines))
            self.position = next((each for each in rest if each not in self.played), rest.stop)
        return line

    def _line(self, action: str) -> int | None:
        """The next line; or else one that was not played, behind it rather than before."""
        count, here = len(self.lines), self.position
        if here < count and self.lines[here] == action:
            return here
        order = (*range(here + 1, count), *range(min(here, count)))
        return next((n for n in order if self.lines[n] == action and n not in self.played), None)

    def take_back(self, line: int, halted: str) -> None:
        """A line was not played after all: it is the next one, unless one before it is."""
        self.played.discard(line)
        if line == self.last:
            self.last = None
        if line < self.position:
            self.position, self.halted = line, halted

    def move(self, to: int) -> None:
        """Choose the next line."""
        if to < 0:
            raise RequestError(Sentence("scripts.at_first_line", "the script is at its first line"))
        if to > len(self.lines):
            raise RequestError(
                Sentence(
                    "scripts.has_lines",
                    "the script has {count} lines",
                    one="the script has 1 line",
                    count=len(self.lines),
                )
            )
        self.position, self.halted, self.last = to, "", None

    def back(self) -> int:
        """The line to go back to: the one played last, by whatever key; then the one before."""
        return self.position - 1 if self.last in (None, self.position) else self.last

    def adopted(self, lines: Sequence[str]) -> ScriptState:
        """The same with other lines: each that was there keeps what became of it; what is new
        before the next line becomes the next.
        """
        places = _places(self.lines, lines)
        kept = {places[line] for line in self.played if line in places}
        behind = [place for line, place in places.items() if line < self.position]
        ahead = [place for line, place in sorted(places.items()) if line >= self.position]
        at = min([max(behind, default=-1) + 1, *ahead[:1]])
        return ScriptState(lines, at, kept, self.halted if self.position in places else "")


def _places(old: Sequence[str], new: Sequence[str]) -> dict[int, int]:
    """Where each line of `old` stands in `new`; the n-th of those alike is the n-th there."""
    numbered = {(line, new[:place].count(line)): place for place, line in enumerate(new)}
    keys = {place: (line, old[:place].count(line)) for place, line in enumerate(old)}
    return {place: numbered[key] for place, key in keys.items() if key in numbered}


@dataclass(frozen=True, slots=True)
class _RunningLine:
    """A line that is being played, and of which script."""

    script: str
    line: int


class ScriptController(SessionFeature):
    """All scripts of a session; see the module's text."""

    requests = (AskScript,)
    asks = ("script",)

    def __init__(self, session: FeatureSession) -> None:
        super().__init__(session)
        self._scripts: dict[str, ScriptState] = {}
        self._published: dict[str, tuple[int, frozenset[int], str]] = {}
        self._runs: dict[str, _RunningLine] = {}
        #: Runs of lines whose sentence was cut.
        self._cut_speech: set[str] = set()
        #: Runs of lines that Space has played: they go with the line before them.
        self.by_script: set[str] = set()
        self.adopt(session.experiment)

    def idle(self) -> bool:
        return not (any(each.lines for each in self._scripts.values()) or self._runs)

    # -- reading -----------------------------------------------------------------------------------

    @property
    def name(self) -> str:
        """The script that Space plays: that of the phase, or the experiment's."""
        stage = self.session.state.study.stage
        return stage.name if stage is not None and stage.name in self._scripts else ""

    @property
    def now(self) -> ScriptState:
        """How it stands."""
        return self._scripts[self.name]

    # -- what is asked for -------------------------------------------------------------------------

    def carry_out(self, request: AskScript, client: Client) -> str:
        if request.to is not None or request.by:
            self.move(request.to, request.by)
        if not request.play:
            return ""
        source = "script" if client.role == "wizard" else "program"
        origin = RequestOrigin(source, request.key, client.console)
        given = given_values(request, client.tells, by_program=client.role != "wizard")
        return self.play_next(origin, client.stale, request.text.strip(), client.tells, given)

    def carry_out_ask(self, ask: Ask, origin: RequestOrigin, stale: str) -> None:
        self.play_next(origin, stale)

    def play_next(
        self,
        origin: RequestOrigin,
        stale: str = "",
        text: str = "",
        tells: tuple[str, ...] = (),
        given: GivenValues = NOTHING_GIVEN,
    ) -> str:
        """Play the next line and move on; its run id. `stale`, `text`, `tells` and `given` as for
        `Session.play`.
        """
        line = self._next_line()
        run = self.session.play(line, origin, stale=stale, text=text, tells=tells, given=given)
        self.by_script.add(run)
        return run

    def _next_line(self) -> str:
        """The action that Space plays. Raises `RequestError` if there is none, or one waits."""
        script, study = self.now, self.session.state.study
        if script.position >= len(script.lines):
            if not script.lines:
                if len(self._scripts) > 1 and study.stage is None:
                    if study.between_trials:
                        raise RequestError(
                            Sentence("phases.with_trial", "phases begin with a trial"),
                            Sentence("scripts.begin_one", "begin one"),
                            command="trial",
                        )
                    raise RequestError(
                        Sentence("scripts.no_phase", "no phase holds"),
                        Sentence("scripts.begin_one", "begin one"),
                        command="phase_next",
                    )
                raise RequestError(
                    Sentence("scripts.none", "there is no script"),
                    Sentence("scripts.add", "add script: [...] to the file"),
                )
            raise RequestError(
                Sentence("scripts.no_more_lines", "the script has no more lines"),
                Sentence("scripts.go_back", "go one line back"),
                command="script_back",
            )
        for run, played in self._runs.items():
            if self._waits(run):
                waiting = self._scripts[played.script].lines[played.line]
                raise RequestError(
                    Sentence(
                        "scripts.still_waits", "{waiting!r} is still waiting", waiting=waiting
                    ),
                    Sentence(
                        "scripts.wait_for_line",
                        "play the next line when this one has started",
                    ),
                )
        return script.lines[script.position]

    def _waits(self, run: str) -> bool:
        """Whether a run was asked for now, and nothing of it has begun."""
        session = self.session
        action, late = session.state.actions.get(run), run in session.runner.scheduled
        return action is not None and action.dispatched is None and not late

    # -- what happens ------------------------------------------------------------------------------

    def after_play(self) -> None:
        self.publish()

    def _went_on(self, action: ActionEpisode) -> None:
        """An action was asked for, or has ended. What the session's end cuts is not to be played
        again.
        """
        if self.session.ended:
            return
        run = action.request.run
        if action.end is None:
            self._began(action)
            return
        self.by_script.discard(run)
        if (played := self._runs.pop(run, None)) is not None:
            self._ended(action, played)
            self.publish()
        self._cut_speech.discard(run)

    def _is_of_another(self, action: ActionEpisode) -> bool:
        """Whether a wizard has just pressed what another one plays: the script hears nothing."""
        request = action.request
        origin = RequestOrigin(request.source, "", request.console)
        asked = PlayAction(action.label, self.session.experiment.action(action.label), origin)
        return another_plays_action(self.session.facts(), asked) is not None

    def _spoke(self, command: CommandEpisode) -> None:
        """A sentence has ended: whether a line was cut in it."""
        if self.session.ended:
            return
        cut = command.outcome in (EpisodeOutcome.STOPPED, EpisodeOutcome.SUPERSEDED)
        if cut and command.label in SPEAKING_VERBS and command.request.run in self._runs:
            self._cut_speech.add(command.request.run)

    def _mistaken(self, message: m.Mistake) -> None:
        """What is being played is a mistake: a line is offered again."""
        if (played := self._runs.pop(message.run, None)) is not None:
            self._scripts[played.script].take_back(played.line, MISTAKE)
            self.publish()

    def _began(self, action: ActionEpisode) -> None:
        # That which Space plays comes first; perhaps it is a line of another phase's.
        names = (self.name, *self._scripts)
        name = next((each for each in names if action.label in self._scripts[each].lines), None)
        if name is None or self._is_of_another(action):
            return
        line = self._scripts[name].play(action.label)
        if line is not None:
            self._runs[action.request.run] = _RunningLine(name, line)

    def _ended(self, action: ActionEpisode, played: _RunningLine) -> None:
        script = self._scripts[played.script]
        unsaid = action.dispatched is None or action.request.run in self._cut_speech
        if action.outcome not in HALTING and not (
            action.outcome == EpisodeOutcome.SUPERSEDED and unsaid
        ):
            return
        script.take_back(played.line, script.halted or action.outcome)
        for run, other in [*self._runs.items()]:
            if run in self.by_script and other.script == played.script and self._waits(run):
                # A line that waits behind one that was not played.
                cancel = self.session.runner.cancel
                loop = asyncio.get_running_loop()
                loop.call_soon(
                    cancel,
                    run,
                    Sentence("scripts.line_not_played", "the previous line was not played"),
                )

    def move(self, to: int | None = None, by: int = 0) -> None:
        """Choose the next line of the script that Space plays: `to` (0: the first; None: the one
        that is next already), and `by` lines on from there; back from where something was played is
        the line that was played last.
        """
        script = self.now
        if to is None and by < 0:
            to, by = script.back(), by + 1
        script.move((script.position if to is None else to) + by)
        self.publish()

    def _phase_changed(self, message: PhaseChanged) -> None:
        """How a line ended in another phase is no news in this one."""
        for script in self._scripts.values():
            script.halted = ""
        self.publish()

    def begin_anew(self, *, participant: bool) -> None:
        self._begin_anew()

    def _trial(self, trial: TrialEpisode) -> None:
        if trial.end is None:
            self._begin_anew()

    def _begin_anew(self) -> None:
        """Every script begins with its first line."""
        self._runs.clear()
        self._scripts = {name: ScriptState(each.lines) for name, each in self._scripts.items()}
        self.publish()

    def adopt(self, experiment: Experiment) -> None:
        """Go on with what the file says now."""
        scripts = SCRIPT.all_of(experiment)
        for run, played in [*self._runs.items()]:
            before = self._scripts[played.script].lines
            place = _places(before, scripts.get(played.script, ())).get(played.line)
            if place is None:
                del self._runs[run]
                self.by_script.discard(run)
                self._cut_speech.discard(run)
            else:
                self._runs[run] = replace(played, line=place)
        self._scripts = {
            name: self._scripts.get(name, ScriptState()).adopted(lines)
            for name, lines in scripts.items()
        }
        self.publish()

    def publish(self) -> None:
        """Publish what has changed."""
        for name, script in self._scripts.items():
            now = script.position, frozenset(script.played), script.halted
            if now == self._published.get(name, (0, frozenset(), "")):
                continue
            self._published[name] = now
            self.session.hub.publish(
                ScriptMoved(
                    position=script.position,
                    phase=name,
                    played=sorted(script.played),
                    halted=script.halted,
                )
            )

    hears: ClassVar[Mapping[type[m.Message], Callable[[Any, Any], object]]] = {
        m.Mistake: _mistaken,
        PhaseChanged: _phase_changed,
    }
    follows: ClassVar[Mapping[type[Episode], Callable[[Any, Any], object]]] = {
        ActionEpisode: _went_on,
        CommandEpisode: _spoke,
        TrialEpisode: _trial,
    }
