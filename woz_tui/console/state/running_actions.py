"""Which presses are under way, how the last ones ended, and which failures nobody has seen yet."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass, field

from woz_tui.config.performers import composers
from woz_tui.config.screen_language import word
from woz_tui.console.state.command_text import command_words, spoken_text
from woz_tui.protocol import messages as m
from woz_tui.protocol.action_messages import EVIDENCE
from woz_tui.protocol.sentence import Sentence
from woz_tui.system.text_cleaning import with_remedy
from woz_tui.timeline.episodes import (
    OUTCOMES,
    ActionEpisode,
    CommandEpisode,
    Episode,
    MomentEpisode,
    keep_latest,
)
from woz_tui.timeline.episodes import EpisodeOutcome as Word
from woz_tui.timeline.session_state import SessionState

FAILURES = 200
#: What is said of a command that was taken, but moves nothing before the robot's mode is over.
LATER = Sentence("runs.later", "applies after this mode")
#: What is said of a command that is done as far as anybody can know: nothing tells whether it
#: happened.
SENT = "sent"
#: The outcomes that look like another one.
_LOOKS: dict[str, str] = {Word.TIMED_OUT: Word.FAILED, Word.SUPERSEDED: "replaced"}


#: How what worked ended, as `RunOutcome` says it.
WORKED = (Word.DONE, SENT, "waits")


def shown_outcome(outcome: str, evidence: str = "") -> str:
    """How an outcome of the timeline is shown, of something that is known by `evidence`."""
    if outcome == Word.DONE and evidence == EVIDENCE[0]:
        return SENT
    return _LOOKS.get(outcome, outcome)


def shown_end(ended: m.ActionEnd) -> str:
    """The same of the end of an action whose beginning is not known."""
    return shown_outcome(OUTCOMES[type(ended)], getattr(ended, "evidence", ""))


@dataclass(frozen=True, slots=True)
class RunOutcome:
    """How a run ended; `how` is done, sent (nobody can know whether it happened), waits (done, but
    it counts later), left_out (this robot does nothing of it), failed, refused, stopped or
    replaced. `utterance`: the words of the run.
    `begin`: when it was asked for, as far as that is known; else its end.
    """

    run: str
    how: str
    t: int
    reason: str = ""
    utterance: str = ""
    begin: int = 0


@dataclass(frozen=True, slots=True)
class Failure:
    """Something that did not work; `t`: when it was asked for. `action` may be empty: then `what`
    says what was tried.
    """

    run: str
    action: str
    what: str
    reason: str
    remedy: str
    t: int


@dataclass(frozen=True, slots=True)
class DriverRefusal:
    """What `driver` would not do, and why. `action` is empty where `what` says what was tried."""

    action: str
    what: str
    reason: str
    remedy: str
    driver: str = ""

    def sentence(self, label: str) -> str:
        """It in a line; `label` is the action's."""
        return f"{label or self.what}: {with_remedy(self.reason, self.remedy)}"


@dataclass(frozen=True, slots=True)
class ActiveRun:
    """One press under way, with those of its commands that are not over: an action, or a command
    that was sent on its own. `put_off`: since when and until when its beginning is put off.
    """

    press: ActionEpisode | CommandEpisode
    commands: tuple[CommandEpisode, ...]
    put_off: tuple[int, int] | None = None

    @property
    def id(self) -> str:
        """That of the action's run, or of the command."""
        return _id(self.press)

    @property
    def running(self) -> bool:
        """Whether a driver has begun; until then it is queued."""
        press = self.press
        begun = press.dispatched is not None
        return begun or any(each.started is not None for each in self.commands)

    def held_for(self, now: int) -> tuple[int, float] | None:
        """Microseconds for which it is still held back, and the share (0..1) gone by."""
        if self.put_off is None or self.running or now >= self.put_off[1]:
            return None
        since, until = self.put_off
        share = (now - since) / max(1, until - since)
        return until - now, min(1.0, max(0.0, share))

    def timing(self, now: int) -> tuple[int | None, float | None]:
        """Microseconds still to go and the share (0..1) gone by; None where nobody has said."""
        expected = [
            (until, self.press.begin if each.started is None else each.started)
            for each in self.commands
            if (until := each.expected_end) is not None
        ]
        if not expected:
            return None, None
        until, begun = max(expected)
        left = max(0, until - now)
        whole = max(1, until - begun)
        return left, min(1.0, max(0.0, 1 - left / whole))


@dataclass(slots=True)
class RunningActions:
    """All runs under way by id, the last outcome of each action, failures until seen.

    `session` says what is under way; `apply` what has ended. `console`: the name of this one.
    `seen`: runs whose failures are acknowledged.
    """

    session: SessionState
    console: str = ""
    outcomes: dict[str, RunOutcome] = field(default_factory=dict)
    failures: deque[Failure] = field(default_factory=lambda: deque(maxlen=FAILURES))
    seen: set[str] = field(default_factory=set)
    _refusal: DriverRefusal | None = None
    #: Of runs under way: what was to be said when they were asked for, what is said so far, and
    #: the last remedy that a command of theirs named.
    _requested_words: dict[str, str] = field(default_factory=dict)
    _utterances: dict[str, str] = field(default_factory=dict)
    _remedies: dict[str, str] = field(default_factory=dict)

    @property
    def active(self) -> list[str]:
        """What is under way, in the order in which it was pressed."""
        alone = (each for each in self.session.commands.values() if not each.request.run)
        presses: list[ActionEpisode | CommandEpisode] = [*self.session.actions.values(), *alone]
        return [_id(press) for press in sorted(presses, key=lambda press: press.seq)]

    @property
    def waiting(self) -> list[CommandEpisode]:
        """Commands that wait in a queue, in the order in which they came."""
        commands = self.session.commands.values()
        waiting = (each for each in commands if each.started is None)
        return sorted(waiting, key=lambda command: command.seq)

    def get(self, run: str) -> ActiveRun | None:
        """A run under way."""
        press = self.session.actions.get(run) or self.session.commands.get(run)
        return self._run(press) if press is not None else None

    def of(self, action: str) -> ActiveRun | None:
        """The run of `action` to show: one at work before one that waits."""
        waiting = None
        for press in self.session.actions.values():
            if press.request.action == action:
                run = self._run(press)
                if run.running:
                    return run
                waiting = waiting or run
        return waiting

    def _run(self, press: ActionEpisode | CommandEpisode) -> ActiveRun:
        known = self.session.commands
        if isinstance(press, CommandEpisode):
            return ActiveRun(press, (press, *self.parts(press)))
        commands = tuple(known[name] for name in press.commands if name in known)
        return ActiveRun(press, commands, self.session.put_off(press.request.run))

    @property
    def composed(self) -> list[CommandEpisode]:
        """What consists of commands and was sent on its own, as planners do, in its order."""
        sent = (each for each in self.session.commands.values() if not each.request.run)
        return [each for each in sent if each.request.driver in composers()]

    def parts(self, composed: CommandEpisode) -> list[CommandEpisode]:
        """What of it has begun and goes on."""
        run, commands = composed.request.command, self.session.commands.values()
        return [each for each in commands if each.request.run == run and each.started is not None]

    def expect(self, run: str, words: str) -> None:
        """What a run that has just been asked for is to say, as far as that is known."""
        keep_latest(self._requested_words, run, words)

    def utterance(self, run: str) -> str:
        """The words of a run under way: those sent to drivers are right where the others differ."""
        wanted, said = self._requested_words.get(run, ""), self._utterances.get(run, "")
        return wanted if said in wanted else said

    def failure_of(self, action: str) -> Failure | None:
        """The last failure of `action` if nobody has seen it and it has not worked since."""
        last = self.outcomes.get(action)
        for failure in reversed(self.failures):
            if failure.action == action:
                worked = last is not None and last.how in WORKED and last.t > failure.t
                return None if failure.run in self.seen or worked else failure
        return None

    def unseen(self) -> list[Failure]:
        """Failures not yet acknowledged, oldest first."""
        return [failure for failure in self.failures if failure.run not in self.seen]

    def read_refusal(self) -> DriverRefusal | None:
        """The last refusal that nobody has read: the list of events is too narrow to say why."""
        refusal, self._refusal = self._refusal, None
        return refusal

    def apply(self, episodes: Iterable[Episode]) -> RunOutcome | None:
        """What a message began and ended; the outcome of the run that is over with it."""
        found = None
        for episode in episodes:
            match episode:
                case CommandEpisode():
                    found = self._command(episode) or found
                case ActionEpisode(ended=m.ActionEnd() as ended):
                    by, waits = episode.request.console, episode.waits
                    how = shown_outcome(episode.outcome, episode.evidence)
                    found = self._action(ended, how, episode.begin, waits, by=by)
                case MomentEpisode(
                    message=m.ActionEnd() as ended
                ):  # of a run that began before the log
                    found = self._action(ended, shown_end(ended), ended.t)
        return found

    def _action(
        self, ended: m.ActionEnd, how: str, begin: int, waits: bool = False, *, by: str = ""
    ) -> RunOutcome:
        text = self.utterance(ended.run)
        self._requested_words.pop(ended.run, None)
        said, remedy = self._utterances.pop(ended.run, ""), self._remedies.pop(ended.run, "")
        what = f"“{said}”" if said else ended.action
        reason = ended.reason
        if waits and how in WORKED:
            how, reason = "waits", word(LATER)
        found = RunOutcome(ended.run, how, ended.t, reason, text, begin)
        if how != Word.REFUSED or not self._is_another(by):
            self.outcomes[ended.action] = found
        if how == Word.FAILED:
            self._fail(Failure(ended.run, ended.action, what, ended.reason, remedy, begin))
        return found

    def _is_another(self, console: str) -> bool:
        """Whether it is another wizard's: what was refused to that one is no news on a button."""
        return console in self.session.other_wizards(self.console)

    def _command(self, command: CommandEpisode) -> RunOutcome | None:
        request, ended, run = command.request, command.ended, command.request.run
        what = command_words(request)
        if ended is None:
            said, text = self._utterances.get(run, ""), spoken_text(request)
            if run and text not in said:  # what two robots say together is there once
                keep_latest(self._utterances, run, f"{said} {text}".strip())
            return None
        if command.outcome == Word.REFUSED and not self._is_another(request.console):
            self._refusal = DriverRefusal(
                request.action, what, ended.reason, ended.remedy, ended.driver
            )
        if run:
            if ended.remedy:
                keep_latest(self._remedies, run, ended.remedy)
            return None  # its action's end is still to come
        how = shown_outcome(command.outcome, command.evidence)
        if how == Word.FAILED:
            why = f"{ended.driver}: {ended.reason}".strip(": ")
            self._fail(Failure(request.command, "", what, why, ended.remedy, command.begin))
        reason = ended.reason
        if command.sent.get("waits"):
            how, reason = "waits", word(LATER)
        return RunOutcome(request.command, how, ended.t, reason, begin=command.begin)

    def _fail(self, failure: Failure) -> None:
        if failure.run not in self.seen:
            self.failures.append(failure)


def _id(press: ActionEpisode | CommandEpisode) -> str:
    request = press.request
    return request.run if isinstance(request, m.ActionRequested) else request.command
