"""What an experiment file may say about the study around the robot.

The shapes alone: who gets which condition (`design`), what is asked of people (`questionnaires`,
`preflight`), what shapes the wizard's answers (`shaping`, `perception`), and how wizards are
trained (`training`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated

from woz_tui.drivers.fields import Doc, OneOf, Range, Seconds, Unique

ORDERS = ("latin-square", "blocks", "fixed")
#: What a cue is, to which a robot's answer may come too soon.
CUES = ("speech", "engagement", "marker")
#: What of the screen can be kept from the wizard; all but `transcript` can only be hidden.
PERCEIVED = (
    *("transcript", "distance", "loudness", "presence", "gaze", "identity", "direction"),
    *("engagement", "joints", "face"),
)
BLURRED = ("transcript", "distance", "loudness")
#: What a simulated visitor can do that wants an answer.
TRAINING_CUES = ("approach", "question", "silence", "turn-away", "leave")


@dataclass(frozen=True, slots=True)
class Design:
    """Which participant gets which condition, in which order.

    `within`: each gets all of them; otherwise each gets one. A Latin square is Williams' (each
    condition stands equally often at each place, and, as far as their number allows, equally often
    behind each other one: E. J. Williams, Aust. J. Chem. 2, 1949). `blocks` are shuffled, with each
    condition equally often in each. `fixed`: the order in which the file lists them.
    """

    order: Annotated[str, OneOf(ORDERS), Doc("latin-square, blocks or fixed")] = "latin-square"
    within: Annotated[bool, Doc("each participant gets all conditions; false: one of them")] = True
    trials: Annotated[int, Range(1, 1000), Doc("trials in each condition")] = 1
    block: Annotated[
        int | None, Range(1, 1000), Doc("participants per block; default: the number of conditions")
    ] = None
    seed: Annotated[int, Range(0, 999_999), Doc("seed of the shuffling")] = 0
    #: Condition -> what the wizard is told instead; empty: the wizard is told the condition.
    blind: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class QuestionnaireItem:
    """One item of a questionnaire: a scale from `low` to `high` (whole numbers), or a free text.

    `ends` is what the scale's ends are called. `optional`: may be left out.
    """

    name: str
    question: str
    low: int = 1
    high: int = 7
    ends: tuple[str, str] = ("", "")
    #: A free text instead of a scale.
    text: bool = False
    optional: bool = False


@dataclass(frozen=True, slots=True)
class Questionnaire:
    """Items asked together. `when`: end (of the session), trial (after each one), condition (after
    the last trial of each) or hand (by key alone).
    """

    name: str
    title: str
    items: tuple[QuestionnaireItem, ...]
    when: str = "end"
    introduction: str = ""


@dataclass(frozen=True, slots=True)
class ResponseShaping:
    """How soon the robot may answer a cue: not before `floor`, and up to `jitter` later at random,
    so that a wizard's quickness does not tell. An answer that comes later anyway is not held up.
    """

    floor: Annotated[
        float, Seconds(0, 60), Doc("shortest time from the cue to the robot's action, in seconds")
    ] = 0.0
    jitter: Annotated[
        float, Seconds(0, 60), Doc("longest random time that is added, in seconds")
    ] = 0.0
    cues: Annotated[tuple[str, ...], OneOf(CUES), Unique(), Doc("speech, engagement, marker")] = (
        "speech",
    )


@dataclass(frozen=True, slots=True)
class PerceptionLimits:
    """What the wizard does not get to see, so as to know no more than the robot could."""

    hide: Annotated[tuple[str, ...], OneOf(PERCEIVED), Unique(), Doc("what is hidden")] = ()
    blur: Annotated[
        tuple[str, ...], OneOf(BLURRED), Unique(), Doc("what is shown only roughly")
    ] = ()


@dataclass(frozen=True, slots=True)
class TrainingCue:
    """Something the simulated visitor does, and the actions that answer it rightly."""

    sort: str
    answers: tuple[str, ...]
    #: What the visitor says with it; one of these at random.
    says: tuple[str, ...] = ()
    #: Seconds in which the answer must come; None: as the section says.
    window: float | None = None


@dataclass(frozen=True, slots=True)
class Training:
    """What `woz train` does. Without cues it makes them from the experiment's actions."""

    cues: tuple[TrainingCue, ...] = ()
    count: Annotated[int, Range(1, 1000), Doc("cues in one training")] = 20
    window: Annotated[float, Seconds(0.5, 60), Doc("time limit for an answer, in seconds")] = 4.0
    pause: Annotated[float, Seconds(0.5, 60), Doc("seconds between two cues, on average")] = 3.0


@dataclass(frozen=True, slots=True)
class Study:
    """All of it; an experiment without these sections has the defaults."""

    design: Design | None = None
    questionnaires: tuple[Questionnaire, ...] = ()
    #: What a human has to see to before the first participant, in words.
    preflight: tuple[str, ...] = ()
    shaping: ResponseShaping | None = None
    #: Cue -> verbs and titles of panels that answer it, for the figures; others are answered by
    #: speech.
    answers: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    perception: PerceptionLimits = field(default_factory=PerceptionLimits)
    training: Training = field(default_factory=Training)
