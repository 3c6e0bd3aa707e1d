"""Chooses the texts of actions and fills in their variables.

Consoles are told before anything is played, and what they were told is what is played.
"""

from __future__ import annotations

import itertools
import random
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol

import msgspec

from woz_tui.bus.hub import Hub
from woz_tui.config.experiment import (
    ELSE,
    Action,
    Call,
    Experiment,
    ParallelCalls,
    TextVariants,
    Wait,
)
from woz_tui.config.performers import composers
from woz_tui.config.utterance_template import HIDDEN_TEXT, OF_VISITOR, names
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json
from woz_tui.protocol.refusal import RequestError
from woz_tui.protocol.sentence import Sentence
from woz_tui.session.variables import MissingValueError, VariableValues, fill_variables, filled_call

#: The verb and its argument that hold an utterance.
SAY, TEXT = "say", "text"
#: The argument that names a file with what a performer composes.
FILE = "file"


@dataclass(frozen=True, slots=True)
class GivenValues:
    """What comes with a request for an action: values of variables in its sentences, where each is
    from and what it tells (see `messages.RestrictedMessage`), how long a wizard took.
    """

    values: Mapping[str, str] = field(default_factory=dict)
    sources: Mapping[str, str] = field(default_factory=dict)
    tells: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    took_us: int = 0
    by_program: bool = False


#: What most requests bring along.
NOTHING_GIVEN = GivenValues()


class GivingRequest(Protocol):
    """A request for an action that may bring values along."""

    @property
    def slots(self) -> Mapping[str, str]:
        """By name."""

    @property
    def slot_sources(self) -> Mapping[str, str]:
        """Where a wizard has each from."""

    @property
    def slots_took_us(self) -> int:
        """How long that took."""


def given_values(
    request: GivingRequest, tells: tuple[str, ...], *, by_program: bool
) -> GivenValues:
    """What a request brings along, which may tell `tells`."""
    if not request.slots:
        return NOTHING_GIVEN
    by_slot = dict.fromkeys(request.slots, tells) if tells else {}
    return GivenValues(
        request.slots, request.slot_sources, by_slot, request.slots_took_us, by_program
    )


class ComposedCall(Protocol):
    """A call of which a performer composes what it carries out."""

    @property
    def verb(self) -> str:
        """What is called."""

    @property
    def args(self) -> Mapping[str, Json]:
        """With what."""

    @property
    def driver(self) -> str:
        """On which driver."""

    @property
    def words(self) -> str:
        """The same in a few words."""


#: Who composes, and a file -> what it plays; nothing if it cannot be read.
CallsOfFile = Callable[[str, str], Sequence[ComposedCall]]


def utterances(
    experiment: Experiment,
    values: VariableValues,
    calls_of: CallsOfFile = lambda driver, file: (),
) -> dict[str, list[Mapping[str, Json]]]:
    """What will be said, by driver, each once, in the file's order: the arguments of `say`.

    Those with a variable that has no value yet, and of which the file offers none, are left out.
    """
    found: dict[str, dict[str, Mapping[str, Json]]] = {}
    verbs = {
        spec.name: verb
        for spec in experiment.drivers
        for verb in spec.offer.verbs
        if verb.name == SAY
    }
    actions = [action for panel in experiment.panels for action in panel.actions]
    for action in (*actions, *experiment.beside_panels):
        for call in action.calls:
            for written in _written(call, TEXT, values) if call.verb == SAY else ():
                for likely in _likely(written, values):
                    if said := _arguments_said({**call.args, TEXT: written}, likely):
                        found.setdefault(call.driver, {})[repr(sorted(said.items()))] = said
            for file in _written(call, FILE, values) if call.driver in composers() else ():
                for part in calls_of(call.driver, str(file)):
                    if part.verb == SAY:
                        found.setdefault(part.driver, {})[repr(sorted(part.args.items()))] = (
                            part.args
                        )
    return {
        driver: [verbs[driver].spoken(args) if driver in verbs else args for args in said.values()]
        for driver, said in found.items()
    }


def _written(call: Call, name: str, values: VariableValues) -> Iterable[Json]:
    """What an argument may be in this condition, with the variables still in place. By whom it is
    chosen that may still change.
    """
    choice = call.choices.get(name)
    if choice is None:
        return (call.args.get(name),)
    return choice.every if choice.by else choice.of(values)


def _likely(text: Json, values: VariableValues) -> Iterator[VariableValues]:
    """The values with which a text may be said: those of each variable that has none yet, as far as
    the file offers any.
    """
    open_ = [
        name
        for name in dict.fromkeys(names(text) if isinstance(text, str) else ())
        if not values.get(name) and values.offers.get(name)
    ]
    every = itertools.product(*(values.offers[name] for name in open_))
    for chosen in itertools.islice(every, MOST_LIKELY):
        yield values.joined(VariableValues(dict(zip(open_, chosen, strict=True))))


def _arguments_said(args: dict[str, Json], values: VariableValues) -> Mapping[str, Json]:
    """Arguments with their variables filled in; empty if that cannot be, or nothing is said."""
    try:
        said = {name: fill_variables(value, values) for name, value in args.items()}
    except MissingValueError:
        return {}
    return said if isinstance(said[TEXT], str) and said[TEXT] else {}


def missing_value_error(missing: MissingValueError) -> RequestError:
    """The refusal of a line whose variable has no value, with where the value comes from."""
    if not missing.variable or missing.offered:
        return RequestError(missing.reason)
    if missing.variable in OF_VISITOR:
        return RequestError(
            missing.reason,
            Sentence(
                "session.enter_visitor",
                "enter who the visitor is, or wait for face recognition or a handshake",
            ),
            command="engagement",
        )
    return RequestError(
        missing.reason,
        Sentence("session.choose_both", "choose participant and condition"),
        command="start",
    )


#: Actions in one line of the log, which may have 1 MiB.
AT_ONCE = 100
#: After these the values of variables may have changed.
_CHANGES = (m.SessionChanged, m.VisitorChanged, m.EngagementChanged, m.EngagementShown)

#: Sentences that one text with offered values is prepared as, at the most.
MOST_LIKELY = 32

Steps = list[tuple[Call, ...] | float]


def calls_in(steps: Steps) -> list[Call]:
    """The calls of these steps, without the pauses."""
    return [call for step in steps if isinstance(step, tuple) for call in step]


def variant(key: str, count: int, size: int) -> int:
    """Which of `size` variants is the one after `count` others: shuffled by `key`, none again
    before all were used, and none twice in a row.
    """
    turn, place = divmod(count, size)
    if size == 2:
        turn = 0  # in turns: any other order would repeat one
    order = _shuffled(f"{key} {turn}", size)
    if turn and order[0] == _shuffled(f"{key} {turn - 1}", size)[-1]:
        order[:2] = order[1::-1]
    return order[place]


def _shuffled(key: str, size: int) -> list[int]:
    order = list(range(size))
    random.Random(key).shuffle(order)
    return order


class ActionTexts:
    """Chooses and fills in what actions say.

    Args:
        hub: Where consoles are told, and where what changes it is heard.
        seed: Of the order of variants.
        experiment: The experiment as it is now.
        values: The variables' present values.
        calls_of: What a file with what a performer composes plays.
    """

    def __init__(
        self,
        hub: Hub,
        seed: int,
        experiment: Callable[[], Experiment],
        values: Callable[[], VariableValues],
        calls_of: CallsOfFile,
    ) -> None:
        self._calls_of = calls_of
        self._hub = hub
        self._seed = seed
        self._experiment = experiment
        self._values = values
        #: How often variants were played to this participant, by action and variants.
        self._played: Counter[tuple[str, Sequence[str]]] = Counter()
        #: What was played last, and the variants that it has used.
        self._last: tuple[Action, set[tuple[str, Sequence[str]]]] | None = None
        #: What came with the last request for each action.
        self._given: dict[str, GivenValues] = {}
        self._participant = ""
        self._published: Mapping[str, str] | None = None
        hub.listen(self._on_message, *_CHANGES)

    def play(self, action: Action, given: GivenValues = NOTHING_GIVEN) -> Steps:
        """The steps of an action that is played now; its variants move on.

        Raises `MissingValueError` before anything has changed.
        """
        used: set[tuple[str, Sequence[str]]] = set()
        steps = self._steps(action, self._values_with(given), used)
        self._given[action.name] = given
        self._last = action, used
        self._played.update(used)
        self._tell_next(action)
        return steps

    def _values_with(self, given: GivenValues) -> VariableValues:
        """The variables' present values, and those that came with a request."""
        if not given.values:
            return self._values()
        return self._values().joined(VariableValues(given.values, tells=given.tells))

    def edited(self, action: Action, text: str, tells: Sequence[str]) -> Action:
        """`action` with `text` in place of the first sentence that it says. Raises `RequestError`.

        Where the sentence depends on the condition or on who is there, or the text tells it, it is
        kept as that was.
        """
        said = next((call for call in action.calls if call.verb == SAY), None)
        if said is None:
            raise RequestError(
                Sentence(
                    "session.no_sentence",
                    "{label!r} says nothing that could be edited",
                    label=action.label,
                )
            )
        choice = said.choices.get(TEXT)
        depends = "condition" in tells or (choice is not None and choice.depends)
        condition = self._values().get("condition", "") if depends else ""
        anew = TextVariants({condition: (text,)})
        if choice is not None and choice.by and not condition:
            anew = TextVariants({ELSE: (text,)}, choice.by)
        choices = {**said.choices, TEXT: anew}
        edited = replace(said, choices=choices)
        steps = [
            replace(step, calls=tuple(edited if call is said else call for call in step.calls))
            if isinstance(step, ParallelCalls)
            else step
            for step in action.steps
        ]
        return replace(action, steps=tuple(steps))

    def take_back(self) -> None:
        """What `play` has just filled in was refused: its variants come again."""
        if self._last is not None:
            action, used = self._last
            self._last = None
            self._played.subtract(used)
            self._tell_next(action)

    def _tell_next(self, action: Action) -> None:
        # Of a part of an action that is played alone, all of it is told.
        whole = self._experiment().action(action.name)
        if whole is not None and any(call.choices for call in action.calls):
            # Whatever the condition: that something is told must not depend on it.
            self._publish([whole])

    def preview(self, action: Action) -> Steps:
        """The steps of an action as it would be played now; its variants stay where they are.

        Raises `MissingValueError`.
        """
        return self._steps(action, self._values(), set())

    def calls(self, action: Action) -> list[Call]:
        """All calls of an action as they would be sent now; none while a value is missing."""
        try:
            steps = self._steps(action, self._values(), set())
        except MissingValueError:
            return []
        return calls_in(steps)

    def other(self, action: Action, said: m.Command) -> Steps | None:
        """The step of `action` that said this, in its next wording; None if it has only one."""
        given = self._given.get(action.name, NOTHING_GIVEN)
        values = self._values_with(given)
        for call in action.calls:
            choice = call.choices.get("text")
            texts = choice.of(values) if choice is not None else ()
            if call.driver != said.driver or call.verb != said.verb or len(texts) < 2:
                continue
            if said.args["text"] in [_text_said(call, values, text) for text in texts]:
                return self.play(replace(action, steps=(ParallelCalls((call,)),)), given)
        return None

    def publish_all(self) -> None:
        """Publish what every action would say now."""
        self._published = {**self._values()}
        experiment = self._experiment()
        actions = [action for panel in experiment.panels for action in panel.actions]
        actions += experiment.beside_panels
        for first in range(0, len(actions), AT_ONCE):
            self._publish(actions[first : first + AT_ONCE])

    def _on_message(self, message: m.Message) -> None:
        self.publish_changed()

    def publish_changed(self) -> None:
        """Publish it again if a variable has another value than before."""
        if self._published is not None and self._published != {**self._values()}:
            self.publish_all()

    def _publish(self, actions: Iterable[Action]) -> None:
        values = self._values().to_show()
        filled = {
            action.name: [
                step if isinstance(step, float | int) else [*map(self._filled_call, step)]
                for step in self._steps(action, values, set())
            ]
            for action in actions
        }
        self._hub.publish(m.ActionsFilled(actions=filled))

    def _filled_call(self, call: Call) -> m.FilledCall:
        """As consoles show it: what is composed with what it says, or else does."""
        filled = msgspec.convert(call, m.FilledCall, from_attributes=True)
        file = str(call.args.get(FILE))
        if call.driver not in composers() or not (parts := self._calls_of(call.driver, file)):
            return filled
        said = " ".join(str(part.args[TEXT]) for part in parts if part.verb == SAY)
        does = ", ".join(dict.fromkeys(part.words for part in parts))
        shown: dict[str, Json] = {TEXT: said} if said else {"does": does}
        kept = dict.fromkeys(shown, HIDDEN_TEXT) if call.tells else {}
        return msgspec.structs.replace(
            filled, args={**filled.args, **shown}, unfilled={**filled.unfilled, **kept}
        )

    def _steps(
        self, action: Action, values: VariableValues, used: set[tuple[str, Sequence[str]]]
    ) -> Steps:
        participant = values.get("participant", "")
        if participant != self._participant:
            self._participant = participant
            self._played.clear()

        def pick(texts: Sequence[str]) -> str:
            place = (action.name, texts)
            used.add(place)
            key = f"{self._seed} {participant} {action.name}"
            return texts[variant(key, self._played[place], len(texts))]

        steps: Steps = []
        for step in action.steps:
            match step:
                case Wait(seconds=seconds):
                    steps.append(seconds)
                case ParallelCalls(calls=calls) if calls:  # none: this robot does none of them
                    steps.append(tuple(filled_call(call, values, pick) for call in calls))
        return steps


def _text_said(call: Call, values: VariableValues, text: str) -> m.Json:
    """What the call says in this wording."""
    return filled_call(call, values, lambda texts: text).args["text"]
