"""The section `engagement`: the model's settings, and what happens when a state is entered.

engagement:
  samples: 8
  on_enter:
    PersonDetected: [{eyes: white}, {wait: 0.5}, {say: "Come nearer"}]
    EngagedWithKnown: {say: "Hello {visitor}"}
    Wait: Good bye            # an action of a panel, played as it stands there
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from woz_tui.config import utterance_template
from woz_tui.config.actions import ActionDraft, StepReader
from woz_tui.config.annotated_decoder import (
    INVALID,
    fields_of,
    find_note,
    read_settings,
    split_annotation,
)
from woz_tui.config.engagement import EngagementSettings, HandshakeSettings, SoundSettings
from woz_tui.config.engagement_words import CONDITION, SIGNS, STATES, STOPPED
from woz_tui.config.experiment import Action, Engagement, ParallelCalls, Step, Wait
from woz_tui.config.performers import ENGAGEMENT
from woz_tui.config.problems import ProblemReport, quoted, together
from woz_tui.config.robots import Robots
from woz_tui.config.sensor_names import published_names
from woz_tui.config.session_verbs import ENGAGEMENT_VERBS
from woz_tui.config.sign_values import SENSOR
from woz_tui.config.verb_calls import Vocabulary
from woz_tui.config.yaml_cursor import Cursor, read_text
from woz_tui.config.yaml_nodes import ListNode, ScalarNode
from woz_tui.drivers.contract import (
    DIRECTION,
    FACE_CONSENT,
    GAZE,
    LEARN_FACE,
    SPEECH,
    SPEECH_TEXT,
    gives_consent,
)
from woz_tui.drivers.fields import OneOf
from woz_tui.protocol.messages import Json
from woz_tui.protocol.sentence import Sentence

#: What the section has beside its settings.
ON_ENTER = "on_enter"
#: States that can be entered.
ENTERED = (*STATES, STOPPED)

#: What an action may say and the step of an effect may not.
_OF_ACTIONS = ("steps", "key", "label", "help", "locked", "when_busy")
#: Variables of the handshake's sentences.
_UNDERSTOOD = ("name",)


def effect_name(state: str) -> str:
    """What the action is called that belongs to a state."""
    return f"on {state}"


class EngagementReader:
    """Reads the section; `actions` are those of all panels by name."""

    def __init__(
        self, vocabulary: Vocabulary, steps: StepReader, actions: Mapping[str, Action]
    ) -> None:
        self._vocabulary = vocabulary
        self._steps = steps
        self._actions = actions

    def read(self, cursor: Cursor) -> Engagement | None:
        """The section, or None after everything that is wrong has been reported."""
        if (
            cursor.table(
                Sentence(
                    "check.engagement_settings",
                    "settings such as {{samples: 8}}, or {{}} for the defaults",
                )
            )
            is None
        ):
            return None
        settings: Any = read_settings(cursor, EngagementSettings, others=(ON_ENTER,))
        sections = dict(cursor.entries())
        _check_sentences(sections.get("handshake"))
        effects: dict[str, Action] = {}
        plays: dict[str, tuple[str, ...]] = {}
        entered = sections.get(ON_ENTER)
        expected = Sentence(
            "check.states", "a mapping of states, such as {{Wait: [{{eyes: off}}]}}"
        )
        states = entered.table(expected) if entered is not None else None
        for state, entry in (states or {}).items():
            if state not in ENTERED:
                entry.unknown(ENTERED, Sentence("check.states_are", "states are"))
                continue
            steps, names = self._entered(entry)
            if steps:
                name = effect_name(state)
                effects[state] = Action(
                    name=name, label=name, key="", panel="", steps=steps, place=entry.place
                )
            if names:
                plays[state] = names
        return None if settings is INVALID else Engagement(settings, effects, plays)

    def _entered(self, cursor: Cursor) -> tuple[tuple[Step, ...], tuple[str, ...]]:
        """Steps of its own, and names of actions."""
        entries = list(cursor.items()) if isinstance(cursor.node, ListNode) else [cursor]
        if not entries:
            cursor.error(Sentence("check.value_missing", "a value is missing here"))
        steps: list[Step] = []
        names: list[str] = []
        for entry in entries:
            if isinstance(entry.node, ScalarNode):
                name = self._action_named(entry, late=any(isinstance(step, Wait) for step in steps))
                names += [] if name is None else [name]
                continue
            verbs = _only_verbs(entry)
            step = self._steps.step(verbs) if verbs is not None else None
            if step is not None:
                _no_chase(entry, step)
                steps.append(step)
        return tuple(steps), tuple(names)

    def _action_named(self, cursor: Cursor, *, late: bool) -> str | None:
        """The name of an action; `late`: it stands behind a pause."""
        name = read_text(
            cursor,
            Sentence(
                "check.action_or_verbs", "the name of an action, or verbs such as {{say: Hello}}"
            ),
        )
        if name is None:
            return None
        action = self._actions.get(name)
        if action is None:
            meant = cursor.report.hint(
                name, self._actions, or_list=Sentence("check.actions_are", "actions are")
            )
            if name in self._vocabulary.names:
                meant = Sentence(
                    "check.verb_in_braces", "; write a verb in braces: {{{verb}: ...}}", verb=name
                )
            cursor.error(
                Sentence(
                    "check.no_action",
                    "there is no action {name}{near}",
                    name=quoted(name),
                    near=meant,
                )
            )
            return None
        if action.locked:
            cursor.warning(
                Sentence("check.locked", "{name} is locked and cannot be played", name=quoted(name))
            )
        if late:
            cursor.warning(
                Sentence(
                    "check.starts_at_once",
                    "{name} starts at once and does not wait: actions run in parallel to the steps",
                    name=quoted(name),
                )
            )
        for step in action.steps:
            _no_chase(cursor, step)
        return name


def _only_verbs(cursor: Cursor) -> Cursor | None:
    """Without what only actions of panels have, which is reported; None if that is all."""
    strange = {name: entry for name, entry in cursor.entries() if name in _OF_ACTIONS}
    for name, entry in strange.items():
        entry.error(
            Sentence(
                "check.steps_in_list",
                "put the steps in a list directly under the state: [{{say: Hello}}, {{wait: 0.5}}]",
            )
            if name == "steps"
            else Sentence(
                "check.of_panels", "belongs to actions of panels; put one there and name it here"
            )
        )
    verbs = [name for name, _ in cursor.entries() if name not in strange]
    return cursor.only(verbs) if verbs or not strange else None


def _no_chase(cursor: Cursor, step: Step) -> None:
    """A state that is left by its own effect could lead round in a circle for ever."""
    for call in step.calls if isinstance(step, ParallelCalls) else ():
        step_on = call.verb == "engagement" and call.args.get("run") == "step"
        if call.driver == ENGAGEMENT and (call.verb == "force" or step_on):
            cursor.error(
                Sentence(
                    "check.changes_state",
                    "{verb!r} changes the state, which is not allowed here: the states"
                    " could change in an endless loop",
                    verb=call.verb,
                )
            )


def _check_sentences(handshake: Cursor | None) -> None:
    """The handshake's sentences know `{name}` and nothing else."""
    sections = dict(handshake.entries()) if handshake is not None else {}
    for item in fields_of(HandshakeSettings):
        bare, notes = split_annotation(item.annotation)
        entry = sections.get(item.name)
        if entry is None or bare is not str or find_note(notes, OneOf) is not None:
            continue
        if isinstance(entry.node, ScalarNode):
            utterance_template.check(entry, entry.node.text, _UNDERSTOOD)


SECTION = "engagement"


def check_engagement(
    engagement: Engagement, robots: Robots, drafts: Sequence[ActionDraft], report: ProblemReport
) -> None:
    """Report what does not fit together; `drafts` are all actions of the panels."""
    _check_names(engagement, drafts)
    _check_confirmation(engagement.settings, report)
    _check_partners(engagement.settings, report)
    if robots.incomplete:
        return
    _check_verbs(robots, report)
    published = [
        name for names in published_names(robots.drivers).values() for name in names.values()
    ]
    _check_sensors(engagement.settings, published, report)
    by_actions = {sign for draft in drafts for sign in signs_given(draft.action)}
    by_buttons = {
        sign
        for asking in robots.asking
        for _, ask in asking.spec.offer.asks
        if ask.what == "verb"
        for sign in _signs_of_verb(ask.name, ask.args)
    }
    given = {*published, *by_actions, *by_buttons}
    _check_signs(engagement.settings, given, published, report)
    _check_choices(engagement.settings, published, report)
    agrees = any(
        gives_consent(call.verb, call.args) for draft in drafts for call in draft.action.calls
    )
    _check_handshake(engagement.settings, robots, published, report, agrees=agrees)
    _check_looks(engagement.settings, robots, published, report)


def _check_names(engagement: Engagement, drafts: Sequence[ActionDraft]) -> None:
    taken = {effect_name(state) for state in engagement.effects}
    for draft in drafts:
        if draft.action.name in taken:
            entries = draft.entries
            entries.get("name", entries.get("label", draft.cursor)).error(
                Sentence(
                    "check.effect_name",
                    "{name} is what {section}.on_enter calls its own action; choose another name",
                    name=quoted(draft.action.name),
                    section=SECTION,
                )
            )


def _check_confirmation(settings: EngagementSettings, report: ProblemReport) -> None:
    """Nobody can say whether a name was understood that they have not heard."""
    if "name" not in utterance_template.names(settings.handshake.confirm):
        path = f"{SECTION}.handshake.confirm"
        message = Sentence(
            "check.not_repeated",
            "does not repeat what was understood; put {{name}} into it, as in '{{name}}, right?'",
        )
        report.warning_at(path, message)


def _check_partners(settings: EngagementSettings, report: ProblemReport) -> None:
    """Only a camera that turns with the head finds somebody else."""
    attention = settings.attention
    if attention.mode == "Unengaged" and not (attention.look and attention.camera == "head"):
        message = Sentence(
            "check.semi_engaged",
            "acts as SemiEngaged: to find somebody where a sound came from, the"
            " robot needs look: true and a camera on its head, camera: head",
        )
        report.warning_at(f"{SECTION}.attention.mode", message)


def _check_looks(
    settings: EngagementSettings, robots: Robots, published: list[str], report: ProblemReport
) -> None:
    """A robot that looks to a sound must hear where it is, and turn its head."""
    if not settings.attention.look:
        return
    turns, hears = GAZE in robots.offers, _given_as(DIRECTION, published)
    if not (turns and hears):
        gaze, direction = quoted(GAZE), quoted(DIRECTION)
        message = (
            Sentence(
                "check.cannot_look",
                "the robot does not look to sounds: no driver offers {gaze}",
                gaze=gaze,
            )
            if hears
            else Sentence(
                "check.cannot_hear_where",
                "the robot does not look to sounds: no driver publishes {direction}",
                direction=direction,
            )
            if turns
            else Sentence(
                "check.neither_looks_nor_hears",
                "the robot does not look to sounds: no driver offers {gaze} and none"
                " publishes {direction}",
                gaze=gaze,
                direction=direction,
            )
        )
        report.warning_at(f"{SECTION}.attention.look", message)


def _check_verbs(robots: Robots, report: ProblemReport) -> None:
    for name in ENGAGEMENT_VERBS:
        for offer in robots.offers.get(name, ()):
            report.warning_at(
                SECTION,
                Sentence(
                    "check.offers_too",
                    "{driver} offers {name!r} too; in actions it means the engagement model's",
                    driver=offer.driver,
                    name=name,
                ),
            )


def _check_sensors(
    settings: EngagementSettings, published: list[str], report: ProblemReport
) -> None:
    """Sensors that the section names must be there, and each can give one thing only."""
    names = {sign: settings.sign(sign).sensor or sign for sign in SIGNS}
    names["sound"] = settings.sound.sensor
    default = {**{sign: sign for sign in SIGNS}, "sound": SoundSettings().sensor}
    for part, name in names.items():
        path = f"{SECTION}.{part}.sensor"
        other = next((part for part, used in names.items() if used == name), part)
        if name != default[part] and name not in published:
            near = report.hint(
                name, published, or_list=Sentence("check.sensors_are", "sensors are")
            )
            report.error_at(
                path,
                Sentence(
                    "check.no_sensor",
                    "there is no sensor {name}{near}",
                    name=quoted(name),
                    near=near,
                ),
            )
        elif other != part and name in published:
            message = Sentence(
                "check.sensor_given", "{name} already gives {other}", name=quoted(name), other=other
            )
            report.error_at(path, message)


def _check_signs(
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
        message: str = Sentence(
            "check.no_driver_gives_sign",
            "no driver gives {signs}, so engagement never begins; add an action for the wizard,"
            " such as {{key: ..., label: ..., toggle: {sign}}}",
            signs=together(missing),
            sign=missing[0],
        )
        if rest:
            message = Sentence(
                "check.or_leave_it_out",
                "{message}, or leave it out: signs: [{rest}]",
                message=message,
                rest=rest,
            )
        report.warning_at(path, message)


def _check_choices(
    settings: EngagementSettings, published: list[str], report: ProblemReport
) -> None:
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
                Sentence(
                    "check.choose_sensor",
                    "{sensors} give {name}; choose one: {part}: {{sensor: {sensor}}}",
                    sensors=together(several),
                    name=name,
                    part=part,
                    sensor=several[0],
                ),
            )


def _check_handshake(
    settings: EngagementSettings,
    robots: Robots,
    published: list[str],
    report: ProblemReport,
    *,
    agrees: bool,
) -> None:
    """A robot that asks for names must be able to ask, to hear the answer, to know them again:
    with a consent, for which it asks itself or for which an action is there (`agrees`).
    """
    path = f"{SECTION}.handshake.by"
    if settings.handshake.by != "robot":
        return
    if "say" not in robots.offers:
        message = Sentence(
            "check.cannot_ask",
            "the robot cannot ask for a name: no driver offers 'say'; write by: wizard",
        )
        report.warning_at(path, message)
    elif not _given_as(SPEECH_TEXT, published):
        message = Sentence(
            "check.cannot_hear_answer",
            "no driver recognises the answer as text (a microphone's transcribe,"
            " a pepper's recognition); type the name with visitor, or lead it"
            " yourself, by: wizard",
        )
        report.warning_at(path, message)
    elif _given_as("identity", published) and LEARN_FACE not in robots.offers:
        message = Sentence(
            "check.learns_no_faces",
            "returning visitors are not recognised: no driver offers {verb}",
            verb=quoted(LEARN_FACE),
        )
        report.warning_at(path, message)
    elif _given_as("identity", published) and not (settings.handshake.face_consent or agrees):
        message = Sentence(
            "check.nobody_agrees",
            "returning visitors are not recognised: nobody says that their face"
            " may be learnt; have the robot ask, with face_consent, or add an"
            " action for the wizard, such as {{key: ..., label: ..., steps:"
            ' [{{{face_consent}: "{{visitor}}"}}, {{{learn_face}:'
            ' "{{visitor}}"}}]}}',
            face_consent=FACE_CONSENT,
            learn_face=LEARN_FACE,
        )
        report.warning_at(path, message)
    if settings.handshake.face_consent and LEARN_FACE not in robots.offers:
        message = Sentence(
            "check.not_asked", "it is not asked: no driver offers {verb}", verb=quoted(LEARN_FACE)
        )
        report.warning_at(f"{SECTION}.handshake.face_consent", message)


def _given_as(name: str, published: list[str]) -> bool:
    """Whether some driver publishes this, whoever else does."""
    return name in published or bool(_several(name, published))


def _several(name: str, published: list[str]) -> list[str]:
    """Readings of this name that have a robot's or a driver's name in front."""
    return [each for each in published if each.endswith(f".{name}")]


def signs_given(action: Action) -> Iterator[str]:
    """Signs that an action gives by the wizard's hand."""
    for step in action.steps:
        for call in step.calls if isinstance(step, ParallelCalls) else ():
            if call.driver == ENGAGEMENT:
                yield from _signs_of_verb(call.verb, call.args)


def _signs_of_verb(verb: str, args: Mapping[str, Json]) -> Sequence[str]:
    """Signs that a verb gives; giving them back to their sensors is the opposite."""
    if verb == "visitor":
        return ("identity",)
    if verb not in ("toggle", "sense") or args.get("value") == SENSOR:
        return ()
    sign = str(args.get("sign"))
    return CONDITION if sign == "all" else (sign,)
