"""Which driver a verb goes to, and with which arguments.

Arguments stand beside the verb (`play: nod, speed: 0.5`) or under it (`play: {move: nod, speed:
0.5}`). What could be meant in two ways is an error that shows how to say it.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace

from woz_tui.config import utterance_template
from woz_tui.config.annotated_decoder import resolve_path
from woz_tui.config.command_remarks import CommandChecker
from woz_tui.config.condition_texts import Deciding, Variables, in_place, is_choice, read_choice
from woz_tui.config.experiment import ARRIVED, Call, LeftOut, ParallelCalls, TextVariants
from woz_tui.config.performers import ENGAGEMENT, performers
from woz_tui.config.problems import ProblemReport, either, join, listed, quoted, together
from woz_tui.config.robots import PLAY, Robots, VerbOffer
from woz_tui.config.session_verbs import ENGAGEMENT_VERBS, WAIT
from woz_tui.config.sign_values import argument_problem, without_a_sign
from woz_tui.config.yaml_cursor import (
    Cursor,
    read_flag,
    read_number,
    read_seconds,
    read_text,
    read_whole,
    read_word,
)
from woz_tui.config.yaml_nodes import ListNode, MappingNode, ScalarNode
from woz_tui.drivers.contract import FACE_CONSENT, Argument
from woz_tui.drivers.fields import Range
from woz_tui.protocol.messages import Json
from woz_tui.protocol.sentence import Sentence

#: Nothing in an experiment takes longer than a day.
_LONGEST = Range(0.0, 86_400.0, "s")
#: Kinds of arguments for which another text may stand in each condition, or several variants.
_CHOSEN = ("text", "choice", "file")


@dataclass(frozen=True, slots=True)
class Vocabulary:
    """All verbs of an experiment, and what their arguments may refer to.

    `another`: the robot that plays it instead of `robots`, which still decides what can be written.
    `deciding`: variables by which a text can be chosen. `own_variables`: those of the file.
    """

    robots: Robots
    own: Mapping[str, VerbOffer]
    variables: Collection[str]
    looker: CommandChecker
    conditions: Sequence[str] = ()
    another: Robots | None = None
    deciding: Deciding = field(default_factory=dict)
    own_variables: Variables = field(default_factory=Variables)

    def offers(self, verb: str) -> Sequence[VerbOffer]:
        """Who offers the verb; those that need no driver come before any driver's."""
        if verb in self.own:
            return (self.own[verb],)
        return self.robots.offers.get(verb, ())

    @property
    def names(self) -> list[str]:
        """Every verb, the robots' first."""
        return [*self.robots.offers, *self.own, WAIT.name]

    @property
    def performers(self) -> set[str]:
        """Who carries out verbs beside the drivers."""
        return {offer.driver for offer in self.own.values()}

    @property
    def targets(self) -> list[str]:
        """What `on` may name: robots, drivers, and drivers by their short names."""
        drivers = [spec.name for spec in self.robots.drivers]
        short = [name.rpartition(".")[2] for name in drivers]
        return list(dict.fromkeys([*self.robots.names, *drivers, *short]))


class CallReader:
    """Reads the verbs that stand together in one action or one step."""

    def __init__(self, vocabulary: Vocabulary) -> None:
        self._vocabulary = vocabulary

    def read(
        self, cursor: Cursor, table: dict[str, Cursor], on: Cursor | None, others: Collection[str]
    ) -> ParallelCalls | None:
        """`table` holds verbs and their arguments; `others` are the names that stand apart."""
        known = set(self._vocabulary.names)
        verbs = {name: entry for name, entry in table.items() if name in known}
        beside = {name: entry for name, entry in table.items() if name not in known}
        if WAIT.name in verbs:
            verbs.pop(WAIT.name).error(
                Sentence(
                    "check.wait_apart",
                    "wait must be a separate step: steps: [{{say: Hello}}, {{wait: 0.5}}, ...]",
                )
            )
        targets = self._targets(on)
        chosen = {name: self._offers_chosen(entry, name, targets) for name, entry in verbs.items()}
        shares = self._arguments_by_verb(verbs, beside, others)
        if not table and not self._vocabulary.robots.incomplete:
            verbs_known = listed(self._vocabulary.names)
            cursor.error(
                Sentence(
                    "check.no_verb",
                    "does nothing; add a verb: {verbs_known}",
                    verbs_known=verbs_known,
                )
            )
        calls: list[Call] = []
        left_out: list[LeftOut] = []
        for name, entry in verbs.items():
            beside_it = shares.get(name, {})
            own = [self._call(offer, entry, beside_it) for offer in chosen[name]]
            if self._vocabulary.another is not None and chosen[name]:
                substitute = _Substitute(self._arguments_of(name), self._vocabulary.another, entry)
                chosen[name] = substitute.offers(chosen[name])
                own = [
                    call
                    for offer in chosen[name]
                    if (call := substitute.call(offer, beside_it, self._call)) is not None
                ]
                left_out += substitute.left_out
            calls += own
        self._warn_of_same_lane(calls, verbs, chosen)
        return ParallelCalls(tuple(calls), tuple(left_out))

    def until_arrived(self, step: ParallelCalls, until: Cursor) -> ParallelCalls:
        """`step`, whose motions are waited for; an error if it has none that says so."""
        arriving = {
            (offer.verb.name, offer.driver)
            for name in {call.verb for call in step.calls}
            for offer in self._vocabulary.offers(name)
            if offer.verb.arrives
        }
        calls = tuple(
            replace(call, until=ARRIVED) if (call.verb, call.driver) in arriving else call
            for call in step.calls
        )
        if step.calls and calls == step.calls:
            verbs = ", ".join(f"{call.driver}'s {call.verb}" for call in step.calls)
            until.error(
                Sentence(
                    "check.no_arrival",
                    "{verbs} does not tell when it has arrived; leave out until",
                    verbs=verbs,
                )
            )
        return replace(step, calls=calls)

    def _call(self, offer: VerbOffer, entry: Cursor, beside: Mapping[str, Cursor]) -> Call:
        name = offer.verb.name
        arguments = _Arguments(self._vocabulary, offer, entry)
        args = arguments.read(beside)
        if offer.driver == ENGAGEMENT and (why := argument_problem(name, args)):
            entry.error(why)
        return Call(name, args, offer.driver, entry.place, choices=arguments.choices)

    def _targets(self, on: Cursor | None) -> list[Cursor] | None:
        if on is None:
            return None
        entries = [*on.items()] if isinstance(on.node, ListNode) else [on]
        if not entries:
            on.error(Sentence("check.names_nobody", "names no driver and no robot"))
        known = self._vocabulary.targets
        wanted = []
        for entry in entries:
            name = read_text(entry, Sentence("check.driver_or_robot", "a driver or robot"))
            if name is not None and name in known:
                wanted.append(entry)
            elif name is not None and not self._vocabulary.robots.incomplete:
                near = entry.report.hint(
                    name, known, or_list=Sentence("check.there_are", "there are")
                )
                entry.error(
                    Sentence(
                        "check.no_target",
                        "there is no driver or robot {name}{near}",
                        name=quoted(name),
                        near=near,
                    )
                )
        return wanted

    def _offers_chosen(
        self, verb: Cursor, name: str, outer: list[Cursor] | None
    ) -> list[VerbOffer]:
        """The drivers that this verb goes to: one, or one for each target. A consent goes to all of
        them that learn faces, and a withdrawal, too.

        `on` under the verb (`say: {text: Hello, on: left}`) comes before the one beside it, unless
        it is the name of an argument (`torque: {on: yes}`).
        """
        offers = self._vocabulary.offers(name)
        own = None if "on" in self._arguments_of(name) else dict(verb.entries()).get("on")
        targets = outer if own is None else self._targets(own)
        if offers and offers[0].driver in performers():
            return list(offers)
        if targets is None and len(offers) > 1 and name != FACE_CONSENT:
            who = together(offer.driver for offer in offers)
            verb.error(
                Sentence(
                    "check.choose_on",
                    "{who} offer {name!r}; choose one, for example on: {driver}",
                    who=who,
                    name=name,
                    driver=offers[0].driver,
                )
            )
            return []
        if targets is None:
            return list(offers)
        chosen: list[VerbOffer] = []
        for target in targets:
            found = self._offers_of_target(target, name, offers)
            chosen += [offer for offer in found if offer not in chosen]
        return chosen

    def _offers_of_target(
        self, target: Cursor, name: str, offers: Sequence[VerbOffer]
    ) -> list[VerbOffer]:
        """Who is meant by a robot's name, a driver's, or a driver's short one."""
        wanted = target.node.text if isinstance(target.node, ScalarNode) else ""
        fitting = [
            offer
            for offer in offers
            if f"{offer.driver}.".startswith(f"{wanted}.") or offer.driver.endswith(f".{wanted}")
        ]
        if len(fitting) == 1 or (fitting and name == FACE_CONSENT):
            return fitting
        if not fitting:
            who = ", ".join(offer.driver for offer in offers)
            target.error(
                Sentence(
                    "check.target_lacks_verb",
                    "{wanted!r} does not offer {name!r}, {who} does; to name it for this"
                    " verb alone, write {name}: {{on: ...}}",
                    wanted=wanted,
                    name=name,
                    who=who,
                )
            )
        else:
            who = together(offer.driver for offer in fitting)
            target.error(
                Sentence(
                    "check.target_unclear",
                    "{who} both offer {name!r}; choose one of them",
                    who=who,
                    name=name,
                )
            )
        return []

    def _arguments_by_verb(
        self, verbs: Mapping[str, Cursor], beside: Mapping[str, Cursor], others: Collection[str]
    ) -> dict[str, dict[str, Cursor]]:
        """Give each argument that stands beside the verbs to the one verb that takes it."""
        takes = {name: self._arguments_of(name) for name in verbs}
        for name, entry in verbs.items():
            for rival in (verb for verb in verbs if verb != name and name in takes[verb]):
                entry.error(
                    Sentence(
                        "check.verb_or_argument",
                        "is a verb and an argument of {rival!r}; write it as {rival}: {{...,"
                        " {name}: ...}}, or put the verbs into steps",
                        rival=rival,
                        name=name,
                    )
                )
        shares: dict[str, dict[str, Cursor]] = {}
        sectionless = self._report_sectionless(beside)
        for name, entry in beside.items():
            if name in sectionless:
                continue
            takers = [verb for verb, arguments in takes.items() if name in arguments]
            if len(takers) == 1:
                shares.setdefault(takers[0], {})[name] = entry
            elif takers:
                entry.error(
                    Sentence(
                        "check.argument_unclear",
                        "{verbs} both take {argument!r}; write it under one: {verb}: {{...,"
                        " {argument}: ...}}",
                        verbs=together(map(repr, takers)),
                        argument=name,
                        verb=takers[0],
                    )
                )
            else:
                self._report_unknown(entry, name, takes, others)
        return shares

    def _report_sectionless(self, beside: Mapping[str, Cursor]) -> set[str]:
        """Verbs of the engagement model where there is none (reported), and their arguments."""
        found: set[str] = set()
        for name, entry in beside.items():
            verb = ENGAGEMENT_VERBS.get(name)
            if verb is not None and ENGAGEMENT not in self._vocabulary.performers:
                entry.error(
                    Sentence(
                        "check.no_engagement",
                        "{name!r} is a verb of the engagement model, which this experiment"
                        " does not have; add a section to the file: engagement: {{}}",
                        name=name,
                    )
                )
                found |= {name, *(argument.name for argument in verb.arguments)}
        return found

    def _arguments_of(self, verb: str) -> dict[str, Argument]:
        return {
            argument.name: argument
            for offer in self._vocabulary.offers(verb)
            for argument in offer.verb.arguments
        }

    def _report_unknown(
        self,
        entry: Cursor,
        name: str,
        takes: Mapping[str, Mapping[str, Argument]],
        others: Collection[str],
    ) -> None:
        if self._vocabulary.robots.incomplete:
            return  # it may belong to a driver whose own errors come first
        if why := self._vocabulary.robots.why_lacking(name):
            entry.error(Sentence("check.nobody_offers_it", "no driver offers it; {why}", why=why))
            return
        owners = [verb for verb in self._vocabulary.names if name in self._arguments_of(verb)]
        if owners:
            entry.error(
                Sentence(
                    "check.argument_of_others",
                    "belongs to {verbs}, which is not here",
                    verbs=either(map(repr, owners[:3])),
                )
            )
            return
        arguments = [name for verb in self._vocabulary.names for name in self._arguments_of(verb)]
        near = [name for arguments_of in takes.values() for name in arguments_of]
        verbs = self._vocabulary.names
        entry.unknown(
            [*others, *near, *verbs, *arguments], Sentence("check.verbs_are", "verbs are"), verbs
        )

    def _warn_of_same_lane(
        self,
        calls: Sequence[Call],
        verbs: Mapping[str, Cursor],
        chosen: Mapping[str, Sequence[VerbOffer]],
    ) -> None:
        """Two verbs of one lane cannot run together, whatever the file hopes for."""
        lanes = {
            (offer.driver, offer.verb.name): offer.verb
            for offers in chosen.values()
            for offer in offers
        }
        seen: dict[tuple[str, str], str] = {}
        for call in calls:
            verb = lanes[call.driver, call.verb]
            if verb.stream or call.driver in performers():
                continue
            first = seen.setdefault((call.driver, verb.lane), call.verb)
            if first != call.verb:
                verbs[call.verb].warning(
                    Sentence(
                        "check.same_lane",
                        "waits until {first!r} has ended: both use the {lane} of {driver}",
                        first=first,
                        lane=verb.lane,
                        driver=call.driver,
                    )
                )


class _Substitute:
    """Reads one verb for another robot than the file's own.

    What is right with the file's own robot and not with this one is left out, and warned of.
    """

    def __init__(self, taken: Collection[str], another: Robots, entry: Cursor) -> None:
        self._taken = {*taken}  # what the file's own robots take with this verb
        self._another = another
        self._entry = entry
        self.left_out: list[LeftOut] = []

    def offers(self, own: Sequence[VerbOffer]) -> list[VerbOffer]:
        """Who carries it out instead: a driver of the same name, or the only one that can."""
        if own[0].driver in performers():
            return [*own]
        name = own[0].verb.name
        offers = self._another.offers.get(name, [])
        if name == FACE_CONSENT and offers:
            return offers
        if len(offers) > 1:
            drivers = {offer.driver for offer in own}
            offers = [offer for offer in offers if offer.driver in drivers] or offers
        if len(offers) > 1:
            who = together(offer.driver for offer in offers)
            self._entry.error(
                Sentence(
                    "check.robot_unclear",
                    "{who} of {label} both offer {name!r}",
                    who=who,
                    label=self._another.label,
                    name=name,
                )
            )
        if not offers and not self._another.incomplete:
            self._leave_out(
                name,
                self._another.why_lacking(name) or Sentence("check.not_offered", "not offered"),
            )
        return offers[:1]

    def call(
        self,
        offer: VerbOffer,
        beside: Mapping[str, Cursor],
        read: Callable[[VerbOffer, Cursor, Mapping[str, Cursor]], Call],
    ) -> Call | None:
        """The call with what this robot's verb takes; None: it is left out."""
        if offer.driver in performers():
            return read(offer, self._entry, beside)
        verb = offer.verb.name
        known = {argument.name for argument in offer.verb.arguments}
        dropped = self._taken - known
        report = ProblemReport()
        node = self._entry.node
        if isinstance(node, MappingNode):
            entries = {name: each for name, each in node.entries.items() if name not in dropped}
            node = MappingNode(node.place, entries, node.keys)
        entry = replace(self._entry, node=node, report=report)
        kept = {
            name: replace(each, report=report)
            for name, each in beside.items()
            if name not in dropped
        }
        call = read(offer, entry, kept)
        if report.errors:
            problem = report.errors[0]
            part = problem.path.removeprefix(self._entry.path)
            why = problem.message
            if part.startswith((".", "[")):
                why = Sentence("check.about", "{what}: {why}", what=part.lstrip("."), why=why)
            self._leave_out(verb, why)
            return None
        move = offer.verb.arguments[0].name if verb == PLAY and offer.verb.arguments else ""
        for warning in report.warnings:
            if move and warning.path in (self._entry.path, join(self._entry.path, move)):
                self._leave_out(verb, warning.message)  # a move that this robot does not have
                return None
            self._entry.report.warning(warning.place, warning.path, warning.message)
        for name in sorted(dropped & {*beside, *dict(self._entry.entries())}):
            self._leave_out(f"{verb}.{name}", Sentence("check.not_offered", "not offered"))
        return call

    def _leave_out(self, what: str, why: str) -> None:
        self.left_out.append(LeftOut(what, why))
        argument = what.partition(".")[2]
        robot = self._another.label
        self._entry.warning(
            Sentence(
                "check.argument_left_out",
                "{argument} is left out on {robot}: {why}",
                argument=quoted(argument),
                robot=robot,
                why=why,
            )
            if argument
            else Sentence("check.left_out", "is left out on {robot}: {why}", robot=robot, why=why)
        )


class _Arguments:
    """The arguments of one verb, from under it and from beside it."""

    def __init__(self, vocabulary: Vocabulary, offer: VerbOffer, cursor: Cursor) -> None:
        self._variables = vocabulary.variables
        self._conditions = vocabulary.conditions
        self._deciding = vocabulary.deciding
        self._own_variables = vocabulary.own_variables
        self._looker = vocabulary.looker
        self._offer = offer
        self._verb = offer.verb
        self._cursor = cursor
        self._known = {argument.name: argument for argument in offer.verb.arguments}
        # What moves the engagement model on is checked when the file is read.
        self._chosen = () if offer.driver == ENGAGEMENT else _CHOSEN
        #: The arguments that are chosen when the verb is played; known once it has been read.
        self.choices: dict[str, TextVariants] = {}

    def read(self, beside: Mapping[str, Cursor]) -> dict[str, Json]:
        given = self._given_under_verb()
        for name, entry in beside.items():
            if name in given:
                entry.error(
                    Sentence(
                        "check.set_twice",
                        "is set twice: here and under {name!r}",
                        name=self._verb.name,
                    )
                )
            elif name in self._known:
                given[name] = entry
            else:
                entry.error(
                    Sentence(
                        "check.not_its_argument",
                        "this {name!r} has no such argument",
                        name=self._verb.name,
                    )
                )
        args: dict[str, Json] = {}
        whole = True
        for argument in self._verb.arguments:
            written = given.get(argument.name)
            if written is not None and not self._misplaced(written):
                value = self._one_or_several(written, argument)
                if isinstance(value, TextVariants):
                    self.choices[argument.name] = value
                else:
                    args[argument.name] = value
            elif argument.required and written is None:
                what = (
                    Sentence("check.in_brackets", " ({text})", text=argument.summary)
                    if argument.summary
                    else ""
                )
                cursor, absent = self._cursor, join(self._cursor.path, argument.name)
                cursor.report.missing(
                    cursor.place,
                    cursor.path,
                    Sentence("check.needs", "needs {name!r}{what}", name=argument.name, what=what),
                    absent,
                )
                whole = False
        if whole and None not in args.values():
            self._looker.check(self._offer, args, given, self._cursor, self.choices)
        return args

    def _is_choice(self, entry: Cursor, argument: Argument) -> bool:
        """Whether the text is another one in each condition, or one of several."""
        return argument.kind in self._chosen and is_choice(entry, self._conditions)

    def _one_or_several(self, entry: Cursor, argument: Argument) -> Json | TextVariants:
        """The checked value, or texts of which one is chosen; None if it is wrong."""
        value: Json | TextVariants
        if self._is_choice(entry, argument):
            value = self._choice(entry, argument)
        else:
            value = self._value(entry, argument)
        if argument.kind not in _CHOSEN or not isinstance(value, str | TextVariants):
            return value
        texts = value if isinstance(value, TextVariants) else TextVariants({"": (value,)})
        try:
            placed = in_place(texts, self._own_variables)
        except ValueError as error:
            name = error.args[0]
            entry.error(
                Sentence(
                    "check.late_by_variable",
                    "{{{name}}} has another text in each condition, with something that is known"
                    " only when it is said, and here {by} decides: write its words out",
                    name=name,
                    by=texts.by,
                )
            )
            return None
        if placed is not texts and argument.kind not in self._chosen:
            entry.error(
                Sentence(
                    "check.model_by_condition",
                    "the engagement model knows no text by condition: write the words out",
                )
            )
            return None
        return value if placed is texts else placed

    def _choice(self, entry: Cursor, argument: Argument) -> TextVariants | None:
        def read(one: Cursor) -> str | None:
            text = self._value(one, argument)
            return text if isinstance(text, str) else None

        return read_choice(entry, self._conditions, read, self._deciding)

    def _misplaced(self, entry: Cursor) -> bool:
        """Whether the verb's main argument holds what belongs to another one; reported."""
        text = (
            entry.node.text if entry is self._cursor and isinstance(entry.node, ScalarNode) else ""
        )
        why = without_a_sign(self._verb.name, text)
        if why:
            entry.error(why)
        return bool(why)

    def _given_under_verb(self) -> dict[str, Cursor]:
        node = self._cursor.node
        main = self._verb.arguments[0] if self._verb.arguments else None
        if isinstance(node, ScalarNode) and node.is_empty:
            return {}
        if isinstance(node, MappingNode):
            return self._given_in_mapping(node, main)
        if main is None:
            if not (isinstance(node, ScalarNode) and node.text == "true"):
                self._cursor.error(
                    Sentence(
                        "check.takes_nothing",
                        "takes no arguments; write only {name}:",
                        name=self._verb.name,
                    )
                )
            return {}
        return {main.name: self._cursor}

    def _given_in_mapping(self, node: MappingNode, main: Argument | None) -> dict[str, Cursor]:
        """A mapping names arguments; for joints it may hold them directly, arguments between."""
        entries = dict(self._cursor.entries())
        if "on" not in self._known:
            entries.pop("on", None)  # whom it is for, see `CallReader`
        given = {name: entries.pop(name) for name in self._known if name in entries}
        if not given and main is not None and self._is_choice(self._cursor, main):
            return {main.name: self._cursor}
        if entries and main is not None and main.kind == "joints" and main.name not in given:
            joints = MappingNode(
                node.place, {name: node.entries[name] for name in entries}, dict(node.keys)
            )
            cursor = self._cursor
            given[main.name] = Cursor(joints, cursor.path, cursor.place, cursor.report)
            return given
        chosen = self._conditions if main is not None and main.kind in self._chosen else ()
        for name, entry in entries.items():
            if name in chosen and main is not None:
                entry.error(
                    Sentence(
                        "check.condition_misplaced",
                        "is a condition; put its text under {argument}: {{{condition}: ...}}",
                        argument=main.name,
                        condition=name,
                    )
                )
            else:
                entry.unknown(
                    [*self._known, *chosen],
                    Sentence("check.verb_takes", "{name} takes", name=self._verb.name),
                    [*self._known],
                )
        return given

    # -- from a node to the value that a driver is given ------------------------------------------

    def _value(self, cursor: Cursor, argument: Argument) -> Json:
        """The checked value; None if it is wrong (and reported)."""
        allowed = argument.range
        match argument.kind:
            case "text" | "choice" | "file" as kind:
                return self._text(cursor, argument, file=kind == "file")
            case "joints":
                table = cursor.table(
                    Sentence("check.joints", "joint names with degrees, such as {{pan: 20}}")
                )
                return None if table is None else self._angles(cursor, table, allowed)
            case "poses":
                entries = cursor.list(
                    Sentence("check.poses", "a list of poses, such as [{{pan: 20, seconds: 1}}]")
                )
                if entries == []:
                    cursor.error(Sentence("check.pose_missing", "a pose is missing here"))
                return None if entries is None else [self._pose(each, allowed) for each in entries]
            case "number":
                return read_number(cursor, allowed)
            case "whole":
                return read_whole(cursor, allowed)
            case "flag":
                return read_flag(cursor)
            case "seconds":
                return read_seconds(cursor, allowed or _LONGEST)
        cursor.error(
            Sentence(
                "check.unknown_kind",
                "the driver names an unknown kind of argument: {kind!r}",
                kind=argument.kind,
            )
        )
        return None

    def _text(self, cursor: Cursor, argument: Argument, *, file: bool) -> Json:
        names = self._offer.names if argument is self._verb.arguments[0] else {}
        if isinstance(cursor.node, ScalarNode) and cursor.node.text in names:
            cursor = replace(cursor, node=replace(cursor.node, text=names[cursor.node.text]))
        if argument.choices and not file:
            return read_word(cursor, argument.choices)
        text = read_text(
            cursor, Sentence("check.a_file", "a file") if file else Sentence("check.a_text", "text")
        )
        if text is None or (file and "://" in text and not text.lower().startswith("file:")):
            return text
        utterance_template.check(cursor, text, self._variables)
        if file:
            # Only looked for: it stays as written, so that no home folder gets into the log.
            resolve_path(cursor, text, must_exist=not utterance_template.names(text))
        return text

    def _angles(self, cursor: Cursor, table: Mapping[str, Cursor], allowed: Range | None) -> Json:
        if not table:
            cursor.error(Sentence("check.joints_missing", "the joints are missing here"))
        joints = self._offer.joints
        angles: dict[str, Json] = {}
        for written, entry in table.items():
            name = self._offer.names.get(written, written)
            if joints is not None and name not in joints:
                near = entry.report.hint(
                    name, joints, or_list=Sentence("check.joints_are", "the joints are")
                )
                entry.error(
                    Sentence(
                        "check.no_joint", "there is no joint {name!r}{near}", name=name, near=near
                    )
                )
            else:
                angles[name] = read_number(entry, allowed if joints is None else joints[name])
        return angles

    def _pose(self, cursor: Cursor, allowed: Range | None) -> Json:
        """`{joints: {pan: 20}, seconds: 1}`, or shorter `{pan: 20, seconds: 1}`."""
        table = cursor.table(Sentence("check.a_pose", "a pose, such as {{pan: 20, seconds: 1}}"))
        if table is None:
            return None
        seconds, nested = table.pop("seconds", None), table.get("joints")
        angles = table
        if nested is not None and isinstance(nested.node, MappingNode):
            angles = dict(nested.entries())
            for name, entry in table.items():
                if name != "joints":
                    entry.unknown(("joints", "seconds"), Sentence("check.pose_has", "a pose has"))
        pose = {"joints": self._angles(cursor, angles, allowed)}
        if seconds is not None:
            pose["seconds"] = read_seconds(seconds, _LONGEST)
        return pose
