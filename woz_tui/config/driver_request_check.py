"""What drivers will ask the session for, checked when the file is read: a panel's buttons name
verbs, controls and actions that must exist.

A driver class tells by `asks(settings) -> Iterable[tuple[str, Ask]]`: each with the path of the
setting that says so, below the driver's own.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass

from woz_tui.config.command_remarks import SECRET, hidden_arguments
from woz_tui.config.experiment import FilePosition
from woz_tui.config.problems import ProblemReport, join, quoted
from woz_tui.config.robots import DriverRequests, Robots, VerbOffer
from woz_tui.drivers.contract import Argument, Ask, Verb
from woz_tui.drivers.fields import Range
from woz_tui.protocol.messages import Json


@dataclass(frozen=True, slots=True)
class _Known:
    """What can be asked for in this experiment."""

    robots: Robots
    own: Mapping[str, VerbOffer]
    actions: Collection[str]


def check_asks(
    robots: Robots, own: Mapping[str, VerbOffer], actions: Collection[str], report: ProblemReport
) -> None:
    """Report what nobody could carry out. What stands in no file of the user is only warned of."""
    if robots.incomplete:
        return
    known = _Known(robots, own, actions)
    for asking in robots.asking:
        for path, ask in asking.asks:
            offers = _offers(ask, asking, known) if ask.what == "verb" else ()
            if hidden_arguments(offers[0].verb if len(offers) == 1 else None, ask.args):
                full, place, _ = _where(asking, path, report)
                report.error(place, full, SECRET)
            for message in _wrong(ask, offers, known, report):
                full, place, written = _where(asking, path, report)
                (report.error if written else report.warning)(place, full, message)


def _where(
    asking: DriverRequests, path: str, report: ProblemReport
) -> tuple[str, FilePosition, bool]:
    """The path and place of a setting, and whether it stands in a file: its own, or included."""
    full = join(asking.path, path)
    if report.has_place(full, asking.file):
        return full, report.place(full, asking.file), "." in path
    inner = path.partition(".")[2]
    for source in report.included:
        if inner and report.has_place(inner, source.name):
            return inner, report.place(inner, source.name), True
    return full, report.place(full, asking.file), False


def _wrong(
    ask: Ask, offers: Sequence[VerbOffer], known: _Known, report: ProblemReport
) -> Iterator[str]:
    if ask.what == "action" and ask.name not in known.actions:
        near = report.hint(ask.name, known.actions, or_list="actions are")
        yield f"there is no action {quoted(ask.name)}{near}"
    if ask.what != "verb":
        return
    if len(offers) == 1:
        yield from _arguments(offers[0].verb, ask.args, report)
    elif offers:
        who = " and ".join(offer.driver for offer in offers)
        yield f"{ask.name!r} is offered by {who}; name one of them with on"
    else:
        verbs = [*known.robots.offers, *known.own]
        whom = f"{ask.on!r} does not offer" if ask.on else "no driver offers"
        yield f"{whom} {ask.name!r}{report.hint(ask.name, verbs)}"


def _arguments(verb: Verb, args: Mapping[str, Json], report: ProblemReport) -> Iterator[str]:
    takes = {argument.name: argument for argument in verb.arguments}
    for name, value in args.items():
        if name in takes:
            yield from _value(takes[name], value, report)
        else:
            near = report.hint(name, takes, or_list="it takes")
            yield f"{verb.name} has no argument {name!r}{near}"
    for name, argument in takes.items():
        if argument.required and name not in args:
            yield f"{verb.name} needs {name!r}"


def _offers(ask: Ask, asking: DriverRequests, known: _Known) -> Sequence[VerbOffer]:
    """Who would carry it out: robots of an experiment keep to themselves."""
    if not ask.on and ask.name in known.own:
        return [known.own[ask.name]]
    offers = known.robots.offers.get(ask.name, [])
    robot, dot, _ = asking.driver.rpartition(".")
    on = f"{robot}{dot}{ask.on}" if ask.on else robot
    if not on:
        return offers
    if all(spec.name != on for spec in known.robots.drivers) and ask.on:
        on = ask.on  # of another robot
    return [one for one in offers if one.driver == on or one.driver.startswith(f"{on}.")]


def _value(argument: Argument, value: Json, report: ProblemReport) -> Iterator[str]:
    if argument.choices and value not in argument.choices:
        near = report.hint(str(value), argument.choices, or_list="there are")
        yield f"{quoted(str(value))} is no {argument.name}{near}"
    numeric = argument.kind in ("number", "whole", "seconds")
    if numeric and (isinstance(value, bool) or not isinstance(value, int | float)):
        yield f"{argument.name} must be a number, not {quoted(str(value))}"
    elif isinstance(value, int | float) and not (argument.range or Range()).contains(value):
        yield f"{argument.name} must be {argument.range}, not {value:g}"
    if argument.kind == "flag" and not isinstance(value, bool):
        yield f"{argument.name} must be true or false, not {quoted(str(value))}"
