"""Rules across the parts of an experiment: names, keys, what drivers will ask for.

Keys are compared in their normal form, across panels. Two actions whose keys are different but
look alike on a plain terminal (ctrl+i and tab) are no error here: the key map of that terminal
gives one of them a reserve key. What nobody can tell apart, or what would mean stop, is one.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass

from woz_tui.config.action_names import check_actions
from woz_tui.config.actions import ActionDraft
from woz_tui.config.annotated_decoder import values_with_note
from woz_tui.config.command_remarks import SECRET, hidden_arguments
from woz_tui.config.experiment import Action, Experiment, Panel
from woz_tui.config.file_position import FilePosition
from woz_tui.config.keys.keymap import FileKeys, actions_on, typeable
from woz_tui.config.problems import ProblemReport, join, quoted, together
from woz_tui.config.robots import DriverRequests, Robots, VerbOffer
from woz_tui.config.utterance_template import names
from woz_tui.config.yaml_cursor import Cursor, check_different, range_text, texts_of
from woz_tui.drivers.contract import FACE_CONSENT, Ask, Verb, gives_consent
from woz_tui.drivers.face_store import key_of
from woz_tui.drivers.fields import Port, Range
from woz_tui.protocol.messages import Json
from woz_tui.protocol.sentence import Sentence


def check_across(
    experiment: Experiment,
    table: Mapping[str, Cursor],
    drafts: Sequence[ActionDraft],
    report: ProblemReport,
) -> None:
    """Check what no single entry can know of; `table`: the file's top level; `drafts`: all actions
    with their places.
    """
    _check_ports(experiment, report)
    panels = table["panels"].items() if "panels" in table else ()
    titles = [
        (panel, name)
        for panel in panels
        for _, name in texts_of(dict(panel.entries()).get("title"))
    ]
    check_different(titles, Sentence("check.a_panel", "a panel"), ("title",))
    named = [(draft.cursor, draft.action.name) for draft in drafts]
    check_different(named, Sentence("check.an_action", "an action"), ("name", "label"))
    _check_keys(drafts, experiment.keyboard)
    actions = {draft.action.name: draft.action for draft in drafts}
    for draft in drafts:
        check_actions(draft.entries.get("then"), actions)
    _check_parts(experiment, report)
    _check_consents(experiment, drafts)


def _check_consents(experiment: Experiment, drafts: Sequence[ActionDraft]) -> None:
    """An action that learns a face does nothing where no action gives a consent for it."""
    calls = [(draft, call) for draft in drafts for call in draft.action.calls]
    given = [
        (call.driver, str(call.args.get("name", "{name}")))
        for _, call in calls
        if gives_consent(call.verb, call.args)
    ]
    needing = {
        (spec.name, verb.name): verb.arguments[0].name
        for spec in experiment.drivers
        for verb in spec.offer.verbs
        if verb.needs_consent and verb.arguments
    }
    for draft, call in calls:
        if (argument := needing.get((call.driver, call.verb))) is None:
            continue
        wanted = str(call.args.get(argument, "{name}"))
        if not any(driver == call.driver and _may_be(name, wanted) for driver, name in given):
            draft.cursor.warning(
                Sentence(
                    "check.no_consent",
                    "{verb} is refused without a consent, which no action gives; ask the"
                    " visitor, then play steps: [{{{face_consent}: {wanted}}}, {{{verb}:"
                    " {wanted}}}]",
                    verb=call.verb,
                    face_consent=FACE_CONSENT,
                    wanted=quoted(wanted),
                )
            )


def _may_be(name: str, other: str) -> bool:
    """Whether both may be one person's name; what stands in braces is known in the session."""
    return bool(names(name) or names(other)) or key_of(name) == key_of(other)


def _check_parts(experiment: Experiment, report: ProblemReport) -> None:
    """Two parts that differ by one slip of a finger are probably meant as one. A control panel of a
    part that is nobody's could play nothing.
    """
    parts = experiment.parts
    for spec in experiment.drivers:
        if parts and spec.offer.part and spec.offer.part not in parts:
            near = report.hint(
                spec.offer.part, parts, or_list=Sentence("check.parts_are", "parts are")
            )
            what = Sentence(
                "check.no_panel_for_part",
                "no panel is for the part {part}{near}",
                part=quoted(spec.offer.part),
                near=near,
            )
            report.error(spec.place, f"drivers.{spec.name}.part", what)
    first: dict[str, Panel] = {}
    for index, panel in enumerate(experiment.panels):
        for part in panel.parts:
            like = next((each for each in first if part not in first and _alike(part, each)), None)
            if like is not None:
                report.warning_at(
                    f"panels[{index}].for",
                    Sentence(
                        "check.parts_alike",
                        "the part {part} is nearly the part {like} of the panel {title};"
                        " they are two parts",
                        part=quoted(part),
                        like=quoted(like),
                        title=quoted(first[like].title),
                    ),
                )
            first.setdefault(part, panel)


def _alike(one: str, other: str) -> bool:
    """Whether letters are in another order or case, or one of them is missing or doubled."""
    short, long = sorted((one.casefold(), other.casefold()), key=len)
    if len(short) == len(long):
        return sorted(short) == sorted(long)
    shorter = (long[:at] + long[at + 1 :] for at, sign in enumerate(long) if sign.isalpha())
    return short in shorter


def _check_ports(experiment: Experiment, report: ProblemReport) -> None:
    """A serial port has one owner; two would read half of each other's bytes."""
    owner: dict[str, str] = {}
    for spec in experiment.drivers:
        for name, port in values_with_note(spec.settings, Port):
            if port in owner:
                report.error(
                    spec.place,
                    f"drivers.{spec.name}.{name}",
                    Sentence(
                        "check.port_taken",
                        "{port} is already the port of {owner}",
                        port=quoted(port),
                        owner=quoted(owner[port]),
                    ),
                )
            owner.setdefault(port, spec.name)


def check_covers(
    experiment: Experiment, verbs: Collection[str] | None, report: ProblemReport
) -> None:
    """Verbs that a panel's lock covers (`gaze`, `left.gaze`) are offered by somebody; None: not all
    are known.
    """
    offered = {
        f"{whose}.{verb.name}"
        for spec in experiment.drivers
        for whose in (spec.name, spec.name.partition(".")[0])
        for verb in spec.offer.verbs
    }
    for index, panel in enumerate(experiment.panels):
        for number, verb in enumerate(panel.covers):
            known = verbs and offered if "." in verb else verbs
            if known is not None and verb not in known:
                path = f"panels[{index}].covers[{number}]"
                report.error_at(
                    path,
                    Sentence(
                        "check.no_driver_offers",
                        "no driver offers {verb}{near}",
                        verb=quoted(verb),
                        near=report.hint(verb, known),
                    ),
                )


def _check_keys(drafts: Sequence[ActionDraft], layout: str) -> None:
    """Two things on one key, in the file's order."""
    keys = FileKeys(layout)
    for draft in drafts:
        key, cursor = draft.action.key, draft.entries.get("key")
        if not key or cursor is None:
            continue
        if forbidden := keys.forbidden(key):
            cursor.error(
                Sentence(
                    "check.another_key", "{forbidden}; choose another key", forbidden=forbidden
                )
            )
        elif taken := keys.taken(key):
            cursor.error(taken)
        else:
            keys.take(key, draft.action.label, draft.action.place)
            if not typeable(key, layout):
                cursor.warning(
                    Sentence(
                        "check.not_on_keyboard",
                        "the {layout} keyboard has no key for {key!r}; it gets a reserve key"
                        " (set your layout with keyboard:)",
                        layout=layout,
                        key=key,
                    )
                )


@dataclass(frozen=True, slots=True)
class _Requestable:
    """What can be asked for in this experiment."""

    robots: Robots
    own: Mapping[str, VerbOffer]
    actions: Mapping[str, Action]
    layout: str


def check_asks(
    robots: Robots,
    own: Mapping[str, VerbOffer],
    actions: Mapping[str, Action],
    layout: str,
    report: ProblemReport,
) -> None:
    """Report what nobody could carry out. What stands in no file of the user is only warned of."""
    if robots.incomplete:
        return
    known = _Requestable(robots, own, actions, layout)
    for asking in robots.asking:
        for path, ask in asking.spec.offer.asks:
            offers = _offers(ask, asking, known) if ask.what == "verb" else ()
            if hidden_arguments(offers[0].verb if len(offers) == 1 else None, ask.args):
                full, place, _ = _where(asking, path, report)
                report.error(place, full, SECRET)
            for message in _why_impossible(ask, offers, known, report):
                full, place, written = _where(asking, path, report)
                (report.error if written else report.warning)(place, full, message)


def _where(
    asking: DriverRequests, path: str, report: ProblemReport
) -> tuple[str, FilePosition, bool]:
    """The path and place of a setting, and whether it stands in a file: its own, or included."""
    full, file = join(asking.path, path), asking.spec.place.file
    if report.has_place(full, file):
        return full, report.place(full, file), "." in path
    inner = path.partition(".")[2]
    for source in report.included:
        if inner and report.has_place(inner, source.name):
            return inner, report.place(inner, source.name), True
    return full, report.place(full, file), False


def _why_impossible(
    ask: Ask, offers: Sequence[VerbOffer], known: _Requestable, report: ProblemReport
) -> Iterator[str]:
    if ask.what == "action" and ask.name not in known.actions:
        near = report.hint(
            ask.name, known.actions, or_list=Sentence("check.actions_are", "actions are")
        )
        yield Sentence(
            "check.no_action", "there is no action {name}{near}", name=quoted(ask.name), near=near
        )
    if ask.what == "key" and not actions_on(ask.name, known.actions.values(), known.layout):
        yield Sentence(
            "check.no_action_on_key", "no action has the key {name}", name=quoted(ask.name)
        )
    if ask.what != "verb":
        return
    if len(offers) == 1:
        yield from _wrong_arguments(offers[0].verb, ask.args, report)
    elif offers:
        who = together(offer.driver for offer in offers)
        yield Sentence(
            "check.several_offer",
            "{verb!r} is offered by {who}; name one of them with on",
            verb=ask.name,
            who=who,
        )
    else:
        verbs = [*known.robots.offers, *known.own]
        near = report.hint(ask.name, verbs)
        yield (
            Sentence(
                "check.does_not_offer",
                "{on!r} does not offer {verb}{near}",
                on=ask.on,
                verb=repr(ask.name),
                near=near,
            )
            if ask.on
            else Sentence(
                "check.no_driver_offers",
                "no driver offers {verb}{near}",
                verb=repr(ask.name),
                near=near,
            )
        )


def _wrong_arguments(verb: Verb, args: Mapping[str, Json], report: ProblemReport) -> Iterator[str]:
    takes = {argument.name: argument for argument in verb.arguments}
    for name, value in args.items():
        argument = takes.get(name)
        if argument is None:
            near = report.hint(name, takes, or_list=Sentence("check.it_takes", "it takes"))
            yield Sentence(
                "check.no_argument",
                "{verb} has no argument {argument!r}{near}",
                verb=verb.name,
                argument=name,
                near=near,
            )
            continue
        if argument.choices and value not in argument.choices:
            near = report.hint(
                str(value), argument.choices, or_list=Sentence("check.there_are", "there are")
            )
            yield Sentence(
                "check.not_one_of",
                "{value} is no {argument}{near}",
                value=quoted(str(value)),
                argument=argument.name,
                near=near,
            )
        numeric = argument.kind in ("number", "whole", "seconds")
        if numeric and (isinstance(value, bool) or not isinstance(value, int | float)):
            yield Sentence(
                "check.not_number",
                "{argument} must be a number, not {value}",
                argument=argument.name,
                value=quoted(str(value)),
            )
        elif isinstance(value, int | float) and not (argument.range or Range()).contains(value):
            yield Sentence(
                "check.not_in_range",
                "{argument} must be {allowed}, not {value:g}",
                argument=argument.name,
                allowed=range_text(argument.range or Range()),
                value=value,
            )
        if argument.kind == "flag" and not isinstance(value, bool):
            yield Sentence(
                "check.not_true_false",
                "{argument} must be true or false, not {value}",
                argument=argument.name,
                value=quoted(str(value)),
            )
    for name, argument in takes.items():
        if argument.required and name not in args:
            yield Sentence(
                "check.verb_needs", "{verb} needs {argument!r}", verb=verb.name, argument=name
            )


def _offers(ask: Ask, asking: DriverRequests, known: _Requestable) -> Sequence[VerbOffer]:
    """Who would carry it out: robots of an experiment keep to themselves."""
    if not ask.on and ask.name in known.own:
        return [known.own[ask.name]]
    offers = known.robots.offers.get(ask.name, [])
    robot, dot, _ = asking.spec.name.rpartition(".")
    on = f"{robot}{dot}{ask.on}" if ask.on else robot
    if not on:
        return offers
    if all(spec.name != on for spec in known.robots.drivers) and ask.on:
        on = ask.on  # of another robot
    return [one for one in offers if one.driver == on or one.driver.startswith(f"{on}.")]
