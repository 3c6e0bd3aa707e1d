"""Rules between the section `engagement` and the rest of an experiment: who gives the signs, and
which names and verbs the model takes.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from woz_tui.config import utterance_template
from woz_tui.config.actions import ActionDraft
from woz_tui.config.engagement import CONDITION, SIGNS, EngagementSettings, SoundSettings
from woz_tui.config.engagement_effects import effect_name
from woz_tui.config.experiment import Action, Engagement, ParallelCalls
from woz_tui.config.problems import ProblemReport, join, quoted
from woz_tui.config.robots import Robots
from woz_tui.config.sensor_names import published_names
from woz_tui.config.session_verbs import ENGAGEMENT, ENGAGEMENT_VERBS
from woz_tui.config.sign_values import SENSOR
from woz_tui.drivers.contract import LEARN_FACE, SPEECH, SPEECH_TEXT
from woz_tui.protocol.messages import Json

SECTION = "engagement"


def check_engagement(
    engagement: Engagement, robots: Robots, drafts: Sequence[ActionDraft], report: ProblemReport
) -> None:
    """Report what does not fit together; `drafts` are all actions of the panels."""
    _names(engagement, drafts, report)
    _confirmation(engagement.settings, report)
    if robots.incomplete:
        return
    _verbs(robots, report)
    published = [
        name for names in published_names(robots.drivers).values() for name in names.values()
    ]
    _sensors(engagement.settings, published, report)
    given = {*published, *_given(drafts), *_asked(robots)}
    _signs(engagement.settings, given, published, report)
    _choices(engagement.settings, published, report)
    _handshake(engagement.settings, robots, published, report)


def _names(engagement: Engagement, drafts: Sequence[ActionDraft], report: ProblemReport) -> None:
    taken = {effect_name(state) for state in engagement.effects}
    for draft in drafts:
        if draft.action.name in taken:
            path = next(
                path
                for name in ("name", "label", "")
                if report.has_place(path := join(draft.path, name), draft.action.place.file)
                or not name
            )
            report.error_at(
                path,
                f"{quoted(draft.action.name)} is what {SECTION}.on_enter calls its own action;"
                " choose another name",
            )


def _confirmation(settings: EngagementSettings, report: ProblemReport) -> None:
    """Nobody can say whether a name was understood that they have not heard."""
    if "name" not in utterance_template.names(settings.handshake.confirm):
        path = f"{SECTION}.handshake.confirm"
        said = "does not repeat what was understood; put {name} into it, as in '{name}, right?'"
        report.warning_at(path, said)


def _verbs(robots: Robots, report: ProblemReport) -> None:
    for name in ENGAGEMENT_VERBS:
        for offer in robots.offers.get(name, ()):
            report.warning_at(
                SECTION,
                f"{offer.driver} offers {name!r} too; in actions it means the engagement model's",
            )


def _sensors(settings: EngagementSettings, published: list[str], report: ProblemReport) -> None:
    """Sensors that the section names must be there, and each can give one thing only."""
    names = {sign: settings.sign(sign).sensor or sign for sign in SIGNS}
    names["sound"] = settings.sound.sensor
    default = {**{sign: sign for sign in SIGNS}, "sound": SoundSettings().sensor}
    for part, name in names.items():
        path = f"{SECTION}.{part}.sensor"
        other = next((part for part, used in names.items() if used == name), part)
        if name != default[part] and name not in published:
            near = report.hint(name, published, or_list="sensors are")
            report.error_at(path, f"there is no sensor {quoted(name)}{near}")
        elif other != part and name in published:
            said = f"{quoted(name)} already gives {other}"
            report.error_at(path, said)


def _signs(
    settings: EngagementSettings, given: set[str], published: list[str], report: ProblemReport
) -> None:
    """Somebody must give each sign of the condition: a sensor or the wizard."""
    path = f"{SECTION}.signs"
    missing = [
        sign
        for sign in settings.signs
        if not settings.sign(sign).sensor and sign not in given and not _several(sign, published)
    ]
    if missing:
        rest = ", ".join(sign for sign in settings.signs if sign not in missing)
        report.warning_at(
            path,
            f"no driver gives {' and '.join(missing)}, so engagement never begins; add an action"
            f" for the wizard, such as {{key: ..., label: ..., toggle: {missing[0]}}}"
            + (f", or leave it out: signs: [{rest}]" if rest else ""),
        )


def _choices(settings: EngagementSettings, published: list[str], report: ProblemReport) -> None:
    """Where several robots give the same, one of them must be named."""
    wanted = {sign: sign for sign in (*settings.signs, "identity")}
    wanted = {part: name for part, name in wanted.items() if not settings.sign(part).sensor}
    if SPEECH not in {name.rpartition(".")[2] for name in published}:
        wanted["sound"] = settings.sound.sensor
    for part, name in wanted.items():
        several = _several(name, published)
        if several and name not in published:
            path = f"{SECTION}.{part}"
            report.warning_at(
                path,
                f"{' and '.join(several)} give {name}; choose one:"
                f" {part}: {{sensor: {several[0]}}}",
            )


def _handshake(
    settings: EngagementSettings, robots: Robots, published: list[str], report: ProblemReport
) -> None:
    """A robot that asks for names must be able to ask, to hear the answer, to know them again."""
    path = f"{SECTION}.handshake.by"
    if settings.handshake.by != "robot":
        return
    if "say" not in robots.offers:
        said = "the robot cannot ask for a name: no driver offers 'say'; write by: wizard"
        report.warning_at(path, said)
    elif not _given_as(SPEECH_TEXT, published):
        said = (
            "no driver recognises the answer as text (a microphone's transcribe,"
            " a pepper's recognition); type the name with visitor, or lead it yourself, by: wizard"
        )
        report.warning_at(path, said)
    elif _given_as("identity", published) and LEARN_FACE not in robots.offers:
        said = f"returning visitors are not recognised: no driver offers {quoted(LEARN_FACE)}"
        report.warning_at(path, said)


def _given_as(name: str, published: list[str]) -> bool:
    """Whether some driver publishes this, whoever else does."""
    return name in published or bool(_several(name, published))


def _several(name: str, published: list[str]) -> list[str]:
    """Readings of this name that have a robot's or a driver's name in front."""
    return [each for each in published if each.endswith(f".{name}")]


def _given(drafts: Sequence[ActionDraft]) -> Iterator[str]:
    """Signs that some action gives."""
    for draft in drafts:
        yield from signs_given(draft.action)


def signs_given(action: Action) -> Iterator[str]:
    """Signs that an action gives by the wizard's hand."""
    for step in action.steps:
        for call in step.calls if isinstance(step, ParallelCalls) else ():
            if call.driver == ENGAGEMENT:
                yield from _of_verb(call.verb, call.args)


def _of_verb(verb: str, args: Mapping[str, Json]) -> Sequence[str]:
    """Signs that a verb gives; giving them back to their sensors is the opposite."""
    if verb == "visitor":
        return ("identity",)
    if verb not in ("toggle", "sense") or args.get("value") == SENSOR:
        return ()
    sign = str(args.get("sign"))
    return CONDITION if sign == "all" else (sign,)


def _asked(robots: Robots) -> Iterator[str]:
    """Signs that some driver's buttons give."""
    for asking in robots.asking:
        for _, ask in asking.asks:
            if ask.what == "verb":
                yield from _of_verb(ask.name, ask.args)
