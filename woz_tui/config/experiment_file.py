"""The shapes of an experiment file, panels and actions: what each may say.

One shape gives the decoder, the JSON schema and the reference page. Sections whose shape is also
what the session works with are in `experiment`, `study` and `engagement`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, cast

from woz_tui.config.annotated_decoder import names_of
from woz_tui.config.experiment import (
    ARRIVED,
    ArrowKeySteps,
    SessionSettings,
)
from woz_tui.config.feature_section import FeatureSection
from woz_tui.config.keys.keyboard_layouts import LAYOUTS
from woz_tui.config.languages import DEFAULT
from woz_tui.config.study import Study
from woz_tui.drivers.fields import (
    Doc,
    Entry,
    NotBlank,
    NotEmpty,
    OneOf,
    OneOrMore,
    ReadApart,
    Unique,
)
from woz_tui.feature import pieces
from woz_tui.protocol.sentence import Sentence

WHEN_BUSY = ("queue", "replace", "refuse")


@dataclass(frozen=True, slots=True, kw_only=True)
class ActionEntry(Entry):
    """What an action may say beside verbs and their arguments."""

    what = Sentence("check.an_action", "an action")
    example = "{key: h, label: Hello, say: Hello!}"
    either = ("label", "name")
    key: Annotated[Any, ReadApart("key"), Doc("a, A, !, F1, ctrl+a; c r: first c, then r")] = None
    label: Annotated[str, NotBlank(), Doc("text on the button")] = ""
    name: Annotated[str, NotBlank(), Doc("name for scripts and programs (default: the label)")] = ""
    help: Annotated[str, NotBlank(), Doc("a sentence for the wizard")] = ""
    locked: Annotated[bool, Doc("shown, but cannot be played")] = False
    when_busy: Annotated[
        str,
        OneOf(WHEN_BUSY),
        Doc("what the key does while the action runs or waits (default: it counts once)"),
    ] = ""
    on: Annotated[Any, ReadApart("on"), Doc("driver or robot; a list for several at once")] = None
    until: Annotated[
        str,
        OneOf((ARRIVED,)),
        Doc("arrived: the step ends when its motion has arrived, not when the robot has taken it"),
    ] = ""
    steps: Annotated[
        Any,
        ReadApart("steps"),
        Doc("steps run one after the other; verbs in one step run at the same time"),
    ] = None
    then: Annotated[
        tuple[str, ...],
        OneOrMore(Sentence("check.action_name", "the name of an action")),
        Doc("names of actions to be within reach behind it"),
    ] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class PanelEntry(Entry):
    """What a panel may say."""

    what = Sentence("check.a_panel", "a panel")
    example = "{title: Speech, actions: [...]}"
    either = ("actions", "covers")
    title: Annotated[str, Doc("unique in the file")]
    locked: Annotated[bool, Doc("locked until the wizard unlocks it (`:`, then its name)")] = False
    covers: Annotated[
        tuple[str, ...],
        Doc(
            "verbs (of one robot: left.gaze) that cannot be sent by hand while the panel is locked,"
            " or by wizards who play another part"
        ),
    ] = ()
    for_: Annotated[
        tuple[str, ...],
        OneOrMore(Sentence("check.part_name", "the name of a part")),
        Unique(),
        Doc("parts, one of which a wizard has to play to use the panel: `woz attach --as PART`"),
    ] = ()
    actions: Annotated[Any, ReadApart("actions"), Doc("buttons, in this order")] = None


@dataclass(frozen=True, slots=True)
class ParticipantsEntry(Entry):
    """What the section `participants` may say."""

    what = Sentence("check.the_section", "the section")
    example = "{pattern: 'P\\d\\d'}"
    pattern: Annotated[str, Doc("regular expression of codes")] = ""
    fields: Annotated[
        Any,
        ReadApart("participant_fields"),
        Doc(
            "what is known of each: text, or one of several words; {participant.NAME} in sentences"
        ),
    ] = None
    table: Annotated[
        str, Doc("CSV file with these fields, one line for each code (column: participant)")
    ] = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class ExperimentKeys(Study, Entry):
    """The top level of an experiment file, without what features add."""

    what = Sentence("check.an_experiment", "an experiment")
    title: Annotated[str, Doc("name of the experiment")]
    robot: Annotated[
        Any,
        ReadApart("robot_or_file"),
        Doc("a robot that `woz robots` lists, a robot file, or drivers right here"),
    ] = None
    robots: Annotated[
        Any,
        ReadApart(dict[str, Annotated[Any, ReadApart("robot_or_file")]]),
        NotEmpty(),
        Doc("several robots by name"),
    ] = None
    participants: Annotated[ParticipantsEntry, Doc("what participants' codes look like")] = (
        ParticipantsEntry()
    )
    conditions: Annotated[
        tuple[str, ...], Unique(), Doc("what differs between participants or trials")
    ] = ()
    variables: Annotated[
        Any,
        ReadApart(dict[str, str | dict[str, str]]),
        Doc("values for {name} in utterances; a mapping gives one for each condition"),
    ] = None
    language: Annotated[str, ReadApart(), Doc("in which the console speaks to participants")] = (
        DEFAULT
    )
    keyboard: Annotated[str, OneOf(tuple(LAYOUTS)), Doc("the wizard's keyboard")] = "us"
    session: Annotated[SessionSettings, Doc("time limits of the session")] = SessionSettings()  # noqa: RUF009 - frozen
    sensors: Annotated[
        tuple[str, ...],
        Unique(),
        Doc("what stands first among the sensors on the screen: their names, engagement, pose"),
    ] = ()
    steps: Annotated[ArrowKeySteps, Doc("size of one step of an arrow key")] = ArrowKeySteps()  # noqa: RUF009 - frozen
    engagement: Annotated[
        Any,
        ReadApart("engagement"),
        Doc("engagement model: whether a visitor is engaged with the robot"),
    ] = None
    panels: Annotated[
        tuple[PanelEntry, ...],
        ReadApart(),
        NotEmpty(),
        Doc("groups of actions, in the order of the screen"),
    ]


def _with_features() -> type[ExperimentKeys]:
    keys = dict.fromkeys(section.keys for section in pieces("section", FeatureSection).values())
    body = {"__doc__": "The top level of an experiment file."}
    whole = type("ExperimentFile", (*keys, ExperimentKeys), body)
    return cast("type[ExperimentKeys]", dataclass(frozen=True, kw_only=True)(whole))


ExperimentFile = _with_features()

#: Words of the top level of which one stands in each file of our own format.
OWN_ONLY = frozenset({"panels", "robot", "robots"})
#: Everything that an experiment file may say at its top level, the study last.
TOP_LEVEL = tuple(sorted(names_of(ExperimentFile), key=names_of(Study).__contains__))
