"""What features do in a session."""

from __future__ import annotations

import contextlib
import logging
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, ClassVar, Protocol, TypeVar, cast

from woz_tui.bus.bus import Bus
from woz_tui.bus.hub import Hub
from woz_tui.bus.lane import IN_HOST_LOG
from woz_tui.config.experiment import Action, Call, Experiment
from woz_tui.config.performers import performers_of_features
from woz_tui.drivers.contract import Ask, Driver, Finding, Forecast, Performer, Verb
from woz_tui.feature import answered, features, left_out, pieces
from woz_tui.gate.facts import Facts
from woz_tui.gate.questions import RequestOrigin
from woz_tui.gate.table import FeatureGate
from woz_tui.protocol import messages as m
from woz_tui.protocol.description import Prediction
from woz_tui.protocol.refusal import Refusal, RequestError
from woz_tui.protocol.requests import Reply, Request
from woz_tui.protocol.sentence import Sentence
from woz_tui.session.action_runner import ActionRunner
from woz_tui.session.action_texts import (
    NOTHING_GIVEN,
    ActionTexts,
    ComposedCall,
    GivenValues,
)
from woz_tui.session.participant_identity import SessionIdentity
from woz_tui.session.variables import VariableValues
from woz_tui.timeline.episodes import Episode
from woz_tui.timeline.feature_history import Owed
from woz_tui.timeline.session_state import SessionState

log = logging.getLogger(__name__)

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Client:
    """Who asks for something: the connection, its role, who that is in words, and what words from
    there may tell (see `messages.RestrictedMessage`). `stale`: why what is asked is too old to let
    anything move; empty: it is not.
    """

    console: str
    role: str
    by: str
    tells: tuple[str, ...] = ()
    stale: str = ""


#: Carries a request out that waited, as it is given, or refuses it for this reason; the answer that
#: its client gets.
Decide = Callable[[Request | RequestError], Reply]


class FeatureSession(Protocol):
    """What features may use of a session; `runner` and `texts` come after the features."""

    experiment: Experiment
    catalogue: Mapping[str, type[Driver]]
    hub: Hub
    state: SessionState
    identity: SessionIdentity
    drivers: dict[str, Driver]
    bus: Bus
    runner: ActionRunner
    texts: ActionTexts
    #: Whether it is ending.
    ended: bool
    #: Panels by title that are locked or were, and whether they are.
    locked: dict[str, bool]
    #: Shows consoles the panels as they are now.
    on_panels: Callable[[], None]

    def facts(self) -> Facts:
        """What holds now, for the gate."""

    @property
    def logs(self) -> Sequence[Path]:
        """The folders with the logs of earlier sessions and with that of this one."""

    def why_no_verb(self, call: Call, origin: RequestOrigin) -> Refusal | None:
        """Why this hand may not send it at the moment; None: it may."""

    def play(
        self,
        name: str,
        origin: RequestOrigin,
        *,
        stale: str = "",
        text: str = "",
        tells: tuple[str, ...] = (),
        given: GivenValues = NOTHING_GIVEN,
    ) -> str:
        """Play the action `name`; its run id. Raises `RequestError`; the refusal is in the log.

        `stale`: why the press is too old to be played. `text` is said in place of its first
        sentence, and tells `tells`. `given`: values of variables that came with the request.
        """

    def send(
        self,
        verb: str,
        args: Mapping[str, m.Json],
        on: str,
        origin: RequestOrigin,
        *,
        tells: tuple[str, ...] = (),
    ) -> str:
        """Send one verb; the command's id. Raises `RequestError`. `tells` as in
        `messages.Command`.
        """

    def follow(self, kind: type[Episode], call: Callable[[Any], object]) -> None:
        """Call it with each episode of the kind that begins or has ended, before anybody else hears
        of it.
        """

    def unfollow(self, kind: type[Episode], call: Callable[[Any], object]) -> None:
        """Undo `follow`."""

    def set(
        self,
        participant: str | None = None,
        condition: str | None = None,
        trial: int | None = None,
    ) -> None:
        """Set participant, condition or trial. Raises `RequestError`."""

    def allow_next(self) -> None:
        """Raise `RequestError` unless another participant or trial can begin now."""

    def tell_owed(self, participant: str, owed: Owed) -> None:
        """Tell what a participant has yet to do from earlier sessions."""

    def set_lock(self, panel: str, locked: bool, source: str) -> None:
        """Lock or unlock a panel; `source`: what does, where no hand does."""

    def values_changed(self) -> None:
        """Variables of a feature have other values than before."""

    def idle_changed(self) -> None:
        """A feature is idle now, or is not any more, although no file was read."""


class SessionFeature:
    """What a feature does in one session; made with it, used from its loop.

    Nothing in it may wait. Where it raises anything but a `RequestError` it is named, and asked no
    more: the session goes on without it.
    """

    #: What `carry_out` is given.
    requests: ClassVar[tuple[type[Request], ...]] = ()
    #: What `carry_out_ask` is given, by `Ask.what`.
    asks: ClassVar[tuple[str, ...]] = ()
    #: What `look_up` is given.
    lookups: ClassVar[tuple[type[Request], ...]] = ()
    #: What is called with each kind of message, as a method. The session's state has heard it.
    hears: ClassVar[Mapping[type[m.Message], Callable[[Any, Any], object]]] = {}
    #: The same with each kind of episode, as it begins and when it has ended, before anybody hears
    #: the message.
    follows: ClassVar[Mapping[type[Episode], Callable[[Any, Any], object]]] = {}

    def __init__(self, session: FeatureSession) -> None:
        self.session = session

    @classmethod
    def check_start(cls, value: Any, experiment: Experiment) -> None:
        """Raise `RequestError` unless a session can begin with this value of the start option, or
        of the feature's `host.session_kind.SessionKind`.
        """

    def idle(self) -> bool:
        """Whether the file gives it nothing to do, and nothing is left of what it did before.

        Asked when the session has begun and when a file was read. From then on it hears and follows
        nothing, and is not asked at any of `PASSED_BY`: `fact` and `values` have to be nothing.
        What somebody asks of it by its own requests it is given, and then it is asked again. Where
        it gets something to do in another way, it says so: `FeatureSession.idle_changed`.
        """
        return False

    def start(self, value: Any) -> None:
        """The session begins with this value."""

    def begin(self) -> None:
        """The session begins; drivers look for their hardware."""

    async def prepare(self) -> None:
        """The session has begun, and nobody has joined it: this may wait. Not where nobody takes
        part in it.
        """

    def close(self) -> None:
        """The session ends; what it still says may be said."""

    def lose(self, console: str) -> None:
        """A console, a program or a control panel is not connected any more."""

    def begin_anew(self, *, participant: bool) -> None:
        """The number of the next trial was set, with another `participant` or without."""

    def allow_next(self) -> None:
        """Raise `RequestError` while something is under way into which neither another trial nor
        another participant may come.
        """

    def tell_owed(self, participant: str, owed: Owed) -> None:
        """A participant comes who has `owed` something since earlier sessions: tell the wizard."""

    def carry_out(self, request: Any, client: Client) -> str:
        """Do what is asked; the id of the run or command that it has begun, if any."""
        raise RequestError(
            Sentence(
                "session.not_here",
                "{name} cannot be used here",
                name=type(request).__name__,
            )
        )

    def defer(self, request: Request, client: Client, decide: Decide) -> bool:
        """Whether a client's request waits until somebody has decided; then the feature calls
        `decide` once, unless the client has gone. Raises `RequestError`: it is refused at once.
        """
        return False

    def withdraw(self, console: str, ref: int) -> None:
        """The client does not want any more what it asked for with this number."""

    def carry_out_ask(self, ask: Ask, origin: RequestOrigin, stale: str) -> None:
        """Do what a driver asks for. `stale`: why it is too old; empty: it is not."""
        raise RequestError(
            Sentence("session.driver_asks", "a driver cannot ask for {what!r}", what=ask.what)
        )

    def after_play(self) -> None:
        """An action was played or refused, and what happened with that at once is in the log."""

    def look_up(self, request: Any) -> m.Json:
        """What the reply's `data` holds, where that is to be read from files. Called in a thread of
        its own, one request after the other; what it raises is the answer.
        """
        raise RequestError(
            Sentence(
                "session.not_here",
                "{name} cannot be used here",
                name=type(request).__name__,
            )
        )

    def play(self, action: Action, origin: RequestOrigin, when_busy: str, at: int) -> str | None:
        """Play an action of its own that has no steps; the run's id, or None: it is not its own.
        Raises `RequestError`. `at`: for which moment it was asked; 0: for now.
        """
        return None

    def adopt(self, experiment: Experiment) -> None:
        """The session goes on with a file that was read again."""

    def hold(
        self,
        run: str,
        name: str,
        source: str,
        verbs: Sequence[Verb],
        begin: Callable[[], object],
    ) -> bool:
        """Whether what was asked for waits; then the feature calls `begin` when it may begin.

        `run` and `name`: of the action, or a command and its verb. `source`: who asked for it.
        `verbs`: what robots are to do.
        """
        return False

    def drop(self, run: str) -> None:
        """What it holds as `run`, if anything, has been ended."""

    def values(self) -> VariableValues:
        """Values of the variables of its section (`FeatureSection.variables`)."""
        return VariableValues({})

    def check_given(self, action: str, given: GivenValues) -> GivenValues:
        """Values of its variables that came with a request for an action, as they are said. Raises
        `RequestError`.
        """
        return given

    def filled(self, run: str, action: Action, given: GivenValues) -> None:
        """The texts of an action were filled in for this run, which is about to begin."""

    def front(self) -> Collection[str]:
        """Panels whose action is meant where several have the same key."""
        return ()

    def fact(self) -> object | None:
        """What the feature's rows of the gate and its view look at; None: there is nothing."""
        return None

    def findings(self) -> Sequence[Finding]:
        """Its lines of the preflight list."""
        return ()

    def companion(self) -> str:
        """The command of `woz` that is to run beside the session, with its options as a shell takes
        them; empty: none.
        """
        return ""


class PerformingFeature(SessionFeature, Performer):
    """One that carries out verbs: those of its section, under the name of `Feature.performer`.

    What it raises then ends the command alone.
    """

    #: What it offers.
    verbs: ClassVar[tuple[Verb, ...]] = ()

    async def predict(self, verb: str, args: Mapping[str, m.Json]) -> Forecast:
        """How a command would go (see `Driver.predict`)."""
        return Forecast()

    async def foretell(self, verb: str, args: Mapping[str, m.Json]) -> Prediction | None:
        """The same, for who asks for this command alone; None: as `predict` has it. Raises
        `RejectedError`.
        """
        return None

    def calls_in(self, file: str) -> Sequence[ComposedCall]:
        """What a file that was read with the experiment plays, where it composes that."""
        return ()


F = TypeVar("F", bound=SessionFeature)

#: The answer of a feature that has failed.
_FAILED = "\0"
#: Where features are asked or told something; those that have nothing to do there are passed by.
_HOOKS = (
    *("begin", "prepare", "close", "play", "after_play", "adopt", "hold", "drop", "begin_anew"),
    *("defer", "withdraw"),
    *("allow_next", "tell_owed", "front", "fact", "findings", "companion"),
    *("values", "check_given", "filled"),
)
#: Those of them at which nobody asks a feature that is idle: what a press, a command and its end
#: come by.
PASSED_BY = frozenset(
    ("play", "after_play", "hold", "drop", "defer", "withdraw", "front", "fact", "values", "filled")
)


class SessionFeatures:
    """All features in one session."""

    def __init__(self, session: FeatureSession) -> None:
        self._session = session
        self._all: dict[str, SessionFeature] = {}
        self._names: dict[type[SessionFeature], str] = {}
        self._answering: dict[type[Request], str] = {}
        self._asked: dict[str, str] = {}
        #: What is looked up.
        self.lookups: tuple[type[Request], ...] = ()
        #: Those that have something to do at each of the hooks, in their order.
        self._with: dict[str, dict[str, SessionFeature]] = {}
        #: What they hear: each listener of the hub, by whose it is.
        self._listeners: list[tuple[str, Callable[[Any], object]]] = []
        #: What they follow, in their order.
        self._followers: list[tuple[type[Episode], Callable[[Any], object]]] = []
        #: Those that are passed by.
        self._idle: frozenset[str] = frozenset()
        #: Whether a request may have to wait until somebody has decided.
        self.deferring = False
        #: What features that have failed said last of the moment: they go on forbidding it.
        self.failed: dict[str, object] = {}
        gates = pieces("gate", FeatureGate)
        for name, kind in pieces("session", type).items():
            self._names[kind] = name
            if features()[name].gate and name not in gates:
                continue  # nothing of it would be forbidden
            self._safely(name, self._add, None, name, kind)
            if features()[name].gate and name not in self._all and _is_used(name, session):
                # It has said nothing yet by which its rows could go.
                raise RequestError(
                    Sentence("session.cannot_begin", "{name} failed and cannot begin", name=name),
                    IN_HOST_LOG,
                )
        self._pass_by(frozenset())

    def _add(self, name: str, kind: type[SessionFeature]) -> None:
        feature = self._all[name] = kind(self._session)
        self._asked |= dict.fromkeys(kind.asks, name)
        self._answering |= dict.fromkeys((*kind.requests, *kind.lookups), name)
        self.lookups += kind.lookups
        for heard, call in kind.hears.items():
            listener = partial(self._hear, name, feature, call)
            self._listeners.append((name, listener))
            self._session.hub.listen(listener, heard)

    def _pass_by(self, idle: frozenset[str]) -> None:
        """From here on these are idle, and no others."""
        self._idle = idle
        self._with = {
            hook: {
                name: feature
                for name, feature in self._all.items()
                if getattr(type(feature), hook) is not getattr(SessionFeature, hook)
                and not (hook in PASSED_BY and name in idle)
            }
            for hook in _HOOKS
        }
        self.deferring = bool(self._with["defer"])
        self._session.hub.pass_by(call for name, call in self._listeners if name in idle)
        for kind, follower in self._followers:
            self._session.unfollow(kind, follower)
        self._followers = [
            (kind, partial(self._hear, name, feature, call))
            for name, feature in self._all.items()
            if name not in idle
            for kind, call in feature.follows.items()
        ]
        for kind, follower in self._followers:
            self._session.follow(kind, follower)

    def look_for_idle(self) -> None:
        """Ask all who is idle now."""
        self._pass_by(
            frozenset(
                name
                for name, feature in [*self._all.items()]
                if self._safely(name, _is_idle, False, feature)
            )
        )

    @property
    def performing(self) -> dict[str, PerformingFeature]:
        """Those that carry out verbs, by the name under which these are addressed."""
        names = performers_of_features()
        return {
            names[name].name: feature
            for name, feature in self._all.items()
            if name in names and isinstance(feature, PerformingFeature)
        }

    def calls_in(self, performer: str, file: str) -> Sequence[ComposedCall]:
        """What a file plays for who composes it; nothing if it cannot be played."""
        for name, feature in self._all.items():
            if feature is self.performing.get(performer):
                return self._safely(name, feature.calls_in, (), file)
        return ()

    def lose(self, console: str) -> None:
        """A console, a program or a control panel is not connected any more."""
        for name, feature in [*self._all.items()]:
            self._safely(name, feature.lose, None, console)

    def _hear(
        self,
        name: str,
        feature: SessionFeature,
        call: Callable[[Any, Any], object],
        heard: m.Message | Episode,
    ) -> None:
        if name in self._all:
            self._safely(name, call, None, feature, heard)

    def of(self, kind: type[F]) -> F:
        """The feature of this kind; `KeyError` if there is none, or if it has failed."""
        return cast("F", self._all[self._names[kind]])

    def start(self, name: str, value: object) -> None:
        """The session begins with this value for the feature `name`."""
        if name not in self._all:
            raise RequestError(
                Sentence("session.cannot_begin", "{name} failed and cannot begin", name=name),
                IN_HOST_LOG,
            )
        self._all[name].start(value)
        self._look_at(name)

    def _look_at(self, name: str) -> None:
        """Something was asked of this feature: perhaps it has something to do now."""
        if name in self._idle:
            self.look_for_idle()

    def begin(self) -> None:
        """The session begins."""
        for name, why in left_out().items():
            text = Sentence(
                "session.feature_left_out",
                "the feature {name} is left out: {why}",
                name=name,
                why=why,
            )
            self._session.hub.publish(m.Notice(level="warning", text=text, remedy=IN_HOST_LOG))
        for name, feature in [*self._with["begin"].items()]:
            self._safely(name, feature.begin, None)
        self.look_for_idle()

    async def prepare(self) -> None:
        """Nobody has joined the session yet."""
        for name, feature in [*self._with["prepare"].items()]:
            try:
                await feature.prepare()
            except Exception as error:  # noqa: BLE001 - of others: the session goes on without it
                self._fail(name, error)

    def close(self) -> None:
        """The session ends: first for those that use others."""
        for name, feature in reversed([*self._with["close"].items()]):
            self._safely(name, feature.close, None)

    def begin_anew(self, *, participant: bool) -> None:
        """The number of the next trial was set, with another `participant` or without."""
        for name, feature in [*self._with["begin_anew"].items()]:
            self._safely(name, partial(feature.begin_anew, participant=participant), None)

    def allow_next(self) -> None:
        """Raises `RequestError` while one of them lets no other trial or participant come."""
        for name, feature in [*self._with["allow_next"].items()]:
            self._answer(name, feature.allow_next, None)

    def tell_owed(self, participant: str, owed: Owed) -> None:
        """A participant comes who has `owed` something since earlier sessions."""
        for name, feature in [*self._with["tell_owed"].items()]:
            self._safely(name, feature.tell_owed, None, participant, owed)

    def carry_out(self, request: Request, client: Client) -> str:
        """Do what is asked of a feature; the id of what it has begun. Raises `RequestError`."""
        name, feature = self._whose(request)
        try:
            run = self._answer(name, feature.carry_out, _FAILED, request, client)
        finally:
            self._look_at(name)
        if run is _FAILED:
            raise RequestError(
                Sentence(
                    "session.not_used",
                    "{name} failed and is not used any more",
                    name=name,
                ),
                IN_HOST_LOG,
            )
        return run or ""

    def defer(self, request: Request, client: Client, decide: Decide) -> bool:
        """Whether a feature has the request wait. Raises `RequestError` where it is refused."""
        for name, feature in [*self._with["defer"].items()]:
            waits = self._answer(name, feature.defer, None, request, client, decide)
            if waits is None:
                raise RequestError(
                    Sentence(
                        "session.not_used",
                        "{name} failed and is not used any more",
                        name=name,
                    ),
                    IN_HOST_LOG,
                )
            if waits:
                return True
        return False

    def withdraw(self, console: str, ref: int) -> None:
        """A client does not want any more what it asked for with this number."""
        for name, feature in [*self._with["withdraw"].items()]:
            self._safely(name, feature.withdraw, None, console, ref)

    def carry_out_ask(self, ask: Ask, origin: RequestOrigin, stale: str) -> None:
        """Do what a driver asks of a feature. Raises `RequestError`."""
        name = self._asked.get(ask.what)
        feature = self._all.get(name or "")
        if name is None or feature is None:
            raise RequestError(
                Sentence("session.driver_asks", "a driver cannot ask for {what!r}", what=ask.what)
            )
        try:
            self._answer(name, feature.carry_out_ask, None, ask, origin, stale)
        finally:
            self._look_at(name)

    def after_play(self) -> None:
        """An action was played or refused, and what happened with that at once is in the log."""
        for name, feature in [*self._with["after_play"].items()]:
            self._safely(name, feature.after_play, None)

    def look_up(self, request: Request) -> m.Json:
        """What a feature reads of files for it; called in a thread. Raises what that raises."""
        _, feature = self._whose(request)
        return feature.look_up(request)

    def _whose(self, request: Request) -> tuple[str, SessionFeature]:
        name = self._answering.get(type(request), "")
        feature = self._all.get(name)
        if feature is None:
            raise RequestError(
                Sentence(
                    "session.not_here",
                    "{name} cannot be used here",
                    name=type(request).__name__,
                )
            )
        return name, feature

    def play(self, action: Action, origin: RequestOrigin, when_busy: str, at: int) -> str:
        """Have a feature play an action of its own that has no steps; the run's id. Raises
        `RequestError`.
        """
        for name, feature in [*self._with["play"].items()]:
            run = self._answer(name, feature.play, None, action, origin, when_busy, at)
            if run is not None:
                return run
        raise RequestError(
            Sentence(
                "session.player_failed",
                "{name!r} is played by a feature that failed",
                name=action.name,
            ),
            IN_HOST_LOG,
        )

    def adopt(self, experiment: Experiment) -> None:
        """The session goes on with a file that was read again."""
        self._pass_by(frozenset())  # they hear what they say themselves
        for name, feature in [*self._with["adopt"].items()]:
            self._safely(name, feature.adopt, None, experiment)
        self.look_for_idle()

    def hold(
        self,
        run: str,
        name: str,
        source: str,
        verbs: Sequence[Verb],
        begin: Callable[[], object],
    ) -> bool:
        """Whether a feature makes it wait, and calls `begin` when it may begin."""
        for holding, feature in [*self._with["hold"].items()]:
            if self._safely(holding, feature.hold, False, run, name, source, verbs, begin):
                return True
        return False

    def drop(self, run: str) -> None:
        """What is held as `run`, if anything is, has been ended."""
        for name, feature in [*self._with["drop"].items()]:
            self._safely(name, feature.drop, None, run)

    def values(self, own: VariableValues) -> VariableValues:
        """The session's `own` values and those of the variables that they bring along."""
        for name, feature in [*self._with["values"].items()]:
            own = own.joined(self._safely(name, feature.values, VariableValues({})))
        return own

    def check_given(self, action: str, given: GivenValues) -> GivenValues:
        """Values that came with a request, as they are said. Raises `RequestError`, also where no
        feature is left that checks them: unchecked, they could be any variable.
        """
        checking = [*self._with["check_given"].items()]
        for name, feature in checking:
            given = self._answer(name, feature.check_given, given, action, given)
        if not checking or len(checking) > len(self._with["check_given"]):
            raise RequestError(
                Sentence(
                    "session.values_unchecked", "values that come with a request cannot be checked"
                ),
                IN_HOST_LOG,
            )
        return given

    def filled(self, run: str, action: Action, given: GivenValues) -> None:
        """The texts of an action were filled in for this run."""
        for name, feature in [*self._with["filled"].items()]:
            self._safely(name, feature.filled, None, run, action, given)

    def front(self) -> set[str]:
        """Panels whose action is meant where several have the same key."""
        nothing: Collection[str] = ()
        return {
            panel
            for name, feature in [*self._with["front"].items()]
            for panel in self._safely(name, feature.front, nothing)
        }

    def findings(self) -> list[Finding]:
        """Their lines of the preflight list."""
        nothing: Sequence[Finding] = ()
        return [
            finding
            for name, feature in [*self._with["findings"].items()]
            for finding in self._safely(name, feature.findings, nothing)
        ]

    def companions(self) -> dict[str, str]:
        """Commands of `woz` that are to run beside the session, by the feature that wants each."""
        commands = {
            name: self._safely(name, feature.companion, "")
            for name, feature in [*self._with["companion"].items()]
        }
        return {name: command for name, command in commands.items() if command}

    def facts(self) -> dict[str, object]:
        """What their rows of the gate look at, by name."""
        facts = dict(self.failed)
        for name, feature in [*self._with["fact"].items()]:
            fact = self._safely(name, feature.fact, None)
            if fact is not None:
                facts[name] = fact
        return facts

    def _safely(self, name: str, call: Callable[..., T], otherwise: T, *args: Any) -> T:
        """What a feature answers, where nobody waits for a refusal."""
        try:
            return self._answer(name, call, otherwise, *args)
        except RequestError as error:
            log.warning("the feature %s: %s", name, error)
            return otherwise

    def _answer(self, name: str, call: Callable[..., T], otherwise: T, *args: Any) -> T:
        """As `_safely`; raises `RequestError`."""
        return answered(name, otherwise, call, *args, fail=self._fail, refusals=(RequestError,))

    def _fail(self, name: str, error: Exception) -> None:
        log.error("the feature %s failed", name, exc_info=error)
        self._give_up(name)
        # Without the error's words: they may tell what is kept from some.
        text = Sentence(
            "session.failed_with",
            "{name} failed and is not used any more ({error})",
            name=name,
            error=type(error).__name__,
        )
        self._session.hub.publish(m.Notice(level="error", text=text, remedy=IN_HOST_LOG))

    def _give_up(self, name: str) -> None:
        """Ask it no more, and offer none of its verbs; what its rows of the gate forbid now stays
        forbidden.
        """
        feature = self._all.pop(name, None)
        if isinstance(feature, PerformingFeature):
            self._session.bus.offer(performers_of_features()[name].name, ())
        for having in self._with.values():
            having.pop(name, None)
        if feature is not None:
            with contextlib.suppress(Exception):
                fact = feature.fact()
                if fact is not None:
                    self.failed[name] = fact


def _is_used(name: str, session: FeatureSession) -> bool:
    """Whether the file has a section of this feature."""
    # Not above: features are looked up where it loads, and theirs may need this module.
    from woz_tui.config.feature_section import FeatureSection  # noqa: PLC0415

    section = pieces("section", FeatureSection).get(name)
    return section is not None and section.of(session.experiment) != section.empty


def _is_idle(feature: SessionFeature) -> bool:
    """Whether it is passed by; never where the gate has to look at something of it."""
    return feature.idle() and feature.fact() is None
