"""What a welcome says beside the panels: how the session is set, and the study around it.

Each struct is a JSON object of the same shape on the socket and in `session.plan` of a log; a key
that an older log does not have has its default.
"""

from __future__ import annotations

import msgspec
from msgspec import UNSET, UnsetType

from woz_tui.protocol.envelope import Json
from woz_tui.protocol.panels import ActionView, PhaseView

#: The highest number of one digit.
_DIGIT = 9


class Allowance(msgspec.Struct, frozen=True, omit_defaults=True):
    """What a profile names; `hide`: the rest is not shown."""

    panels: list[str] = []
    actions: list[str] = []
    controls: list[str] = []
    verbs: list[str] = []
    hide: bool = False


class SlotView(msgspec.Struct, frozen=True, omit_defaults=True):
    """A slot of sentences: values that are offered, whether words that were heard are, and for how
    long a value is kept (trial, participant; empty: not).
    """

    offer: list[str] = []
    heard: bool = False
    keep: str = ""


class ModelLimits(msgspec.Struct, frozen=True, omit_defaults=True):
    """What limits the engagement model in time, in seconds; the defaults: there is no model.

    `handshake`: seconds of a whole one, which has `attempts`.
    """

    timeouts: dict[str, float | None] = {}
    handshake: float = 0.0
    attempts: int = 0

    def __bool__(self) -> bool:
        """Whether the session has a model."""
        return self != ModelLimits()


class DesignView(msgspec.Struct, frozen=True):
    """How conditions are ordered; `within`: each participant gets all; `trials` in each."""

    order: str = ""
    within: bool = True
    trials: int = 0


class ItemLabel(msgspec.Struct, frozen=True):
    """What a point of a scale or a choice is called."""

    value: int
    text: str = ""


class ItemCondition(msgspec.Struct, frozen=True, omit_defaults=True):
    """An earlier item's answer without which an item is not asked: one of `values`, or a number
    from `at_least` to `at_most`.
    """

    item: str
    values: tuple[int, ...] = ()
    at_least: float | None = None
    at_most: float | None = None


class QuestionnaireItem(msgspec.Struct, frozen=True, omit_defaults=True):
    """One question: a scale of whole numbers from `low` to `high`, a free text, or another `kind`:
    slider, number, choice, choices (several), month, page (an instruction without an answer).

    `ends` is what the scale's ends are called, `labels` what some of its points are; `numbers`:
    they are shown, with `shift` added to what is stored. `choices` have codes; that of `other`
    wants a text as well. `optional`: may be left out; `soft`: once it was asked for again.
    `does_not_apply` and `prefer_not` are ways to give no answer. `private`: the answer is in no
    export unless somebody asks. `flip`: chance decides which end stands on the left; `flipped`:
    the high one does. Items of one `group` stay together where chance decides the order.
    """

    name: str
    question: str = msgspec.field(default_factory=str)
    low: int = msgspec.field(default_factory=lambda: 1)
    high: int = msgspec.field(default_factory=lambda: 7)
    ends: tuple[str, str] = msgspec.field(default_factory=lambda: ("", ""))
    text: bool = msgspec.field(default_factory=bool)
    optional: bool = msgspec.field(default_factory=bool)
    kind: str = "scale"
    stem: str = ""
    labels: tuple[ItemLabel, ...] = ()
    choices: tuple[ItemLabel, ...] = ()
    other: int | None = None
    numbers: bool = True
    shift: int = 0
    step: int = 1
    unit: str = ""
    lines: int = 0
    private: bool = False
    soft: bool = False
    reverse: bool = False
    flip: bool = False
    flipped: bool = False
    group: str = ""
    does_not_apply: str = ""
    prefer_not: str = ""
    only_if: ItemCondition | None = None

    @property
    def digits(self) -> bool:
        """Whether each point of the scale is one digit."""
        return self.low >= 0 and self.high <= _DIGIT

    @property
    def asks(self) -> str:
        """Its kind; `text` for a free text."""
        return "text" if self.text else self.kind


class QuestionnaireScore(msgspec.Struct, frozen=True, omit_defaults=True):
    """What several items amount to: `how` is mean, sum, sus or weighted. Those of `reverse` count
    from the other end. `weights`: of each item, or `pairs`: items whose answers are places in
    `items`; each weighs as often as it was chosen. So many may be `missing`. `onto`: the ends of
    another scale onto which the score is laid.
    """

    name: str
    how: str = "mean"
    items: tuple[str, ...] = ()
    reverse: tuple[str, ...] = ()
    weights: tuple[float, ...] = ()
    pairs: tuple[str, ...] = ()
    missing: int = 0
    onto: tuple[float, float] | None = None


class QuestionnaireVersion(msgspec.Struct, frozen=True):
    """What a questionnaire says in another language."""

    language: str
    title: str = ""
    introduction: str = ""
    items: tuple[QuestionnaireItem, ...] = ()


class Questionnaire(msgspec.Struct, frozen=True, omit_defaults=True):
    """Items asked together; `when` is start, trial, condition, end or hand. `shuffled`: chance
    decides their order. `versions`: the same in other languages. `role`: suspicion, if it asks who
    was thought to be behind the robot.
    """

    name: str
    title: str = msgspec.field(default_factory=str)
    introduction: str = msgspec.field(default_factory=str)
    when: str = msgspec.field(default_factory=lambda: "end")
    items: tuple[QuestionnaireItem, ...] = msgspec.field(default_factory=tuple)
    shuffled: bool = False
    language: str = ""
    versions: tuple[QuestionnaireVersion, ...] = ()
    scores: tuple[QuestionnaireScore, ...] = ()
    role: str = ""

    @property
    def heading(self) -> str:
        """Its title, or its name."""
        return self.title or self.name


class PreflightCheck(msgspec.Struct, frozen=True):
    """What a human has to see to before the first participant, and whether it is ticked."""

    check: str
    ok: bool = False


class PerceptionView(msgspec.Struct, frozen=True):
    """What is not shown to the wizard (`hide`), or not legibly (`blur`)."""

    hide: list[str] = []
    blur: list[str] = []


class ShapingView(msgspec.Struct, frozen=True):
    """How soon the robot may answer one of the `cues`: `floor` and `jitter` in seconds."""

    floor: float = 0.0
    jitter: float = 0.0
    cues: list[str] = []


class QuestionnaireWords(msgspec.Struct, frozen=True, omit_defaults=True):
    """What a participant reads of the console, in the language of the experiment. What stands
    between braces is filled in; `stop_key` and `go_on_key` are letters.
    """

    wait: str = "Please wait."
    thanks: str = "Thank you!"
    moment: str = "Just a moment, please."
    kept: str = "What you have answered is kept."
    stopped: str = "The robot has been stopped."
    questions_one: str = "1 question."
    questions: str = "{count} questions."
    position: str = "{number} of {count}"
    optional: str = "optional"
    left_out: str = "left out"
    no_answer: str = "no answer"
    finish: str = "These answers are correct: finish"
    stop_question: str = "Stop here and leave the rest unanswered?"
    stop_kept: str = "What has been answered so far is kept."
    keys_begin: str = "enter begins · Ctrl+D: decline"
    keys_scale: str = "{low} to {high}, or {left} {right} and enter · {up} back"
    keys_scale_enter: str = "{low} to {high} and enter · {up} back"
    keys_text: str = "Enter: next · {up} in the first line: back"
    keys_skip: str = "Tab: skip"
    keys_stop: str = "Ctrl+D: stop here"
    keys_summary: str = "enter finishes · {up} choose one to change"
    keys_decline: str = "{stop}: stop here · {go_on}: go on"
    stop_key: str = "y"
    go_on_key: str = "n"
    press_again: str = "Press again to confirm."
    open_item: str = "This one has no answer yet."
    answer_first: str = "Please answer first."
    answer_or_skip: str = "Please answer first, or press Tab to skip."
    number: str = "A number from {low} to {high}, please."
    number_or_skip: str = "A number from {low} to {high}, or Tab to skip."
    month: str = "Year and month, please, such as 2026-11."
    step: str = "In steps of {step}, please: {below} or {above}."
    choose: str = "Please choose one of these."
    choose_some: str = "Please choose at least one of these."
    soft: str = "There is no answer yet. Press Tab once more to leave it open."
    soft_button: str = "There is no answer yet. You can leave it out."
    other: str = "Please say which:"
    no_answer_how: str = "Without an answer, because:"
    keys_choice: str = "a digit or letter, or {up} {down} and enter"
    keys_several: str = "space or its key chooses · enter: next"
    keys_slider: str = "{left} {right} or a number, then enter · {up} back"
    keys_points: str = "{left} {right} and enter · {up} back"
    keys_month: str = "year and month, then enter · {up} back"
    keys_page: str = "enter: next · {up} back"
    keys_other: str = "Enter: next · {up} in the first line: back"
    keys_no_answer: str = "a digit chooses · {up} back"
    keys_ways: str = "Tab: {way}"
    wants_answer: str = "Please answer this question, or press Ctrl+D to stop."
    too_long: str = "At most {most} characters."
    refused: str = "This answer was not taken. Please try again."
    begin: str = "Begin"
    next: str = "Next"
    back: str = "Back"
    skip: str = "Leave out"
    stop_here: str = "Stop here"
    go_on: str = "Go on"
    change: str = "Change"
    not_sent: str = "Not sent yet; it is tried again."


#: What every word says by itself.
ENGLISH = QuestionnaireWords()


class StudySettings(msgspec.Struct, frozen=True):
    """What the file says of the study, and how it stands at this moment.

    `blind`: condition -> label; for whoever is blind to the condition, label -> label.
    `by_condition`: variable -> condition -> text. The last six are as of this moment: `assigned`
    is the participant's order of conditions, `trial` the number of the next one or of that which
    is `running`, `due` names questionnaires. `words`: what participants read of the console, in the
    `language` of the experiment (its code).
    """

    design: DesignView | None = None
    blind: dict[str, str] = {}
    questionnaires: list[Questionnaire] = []
    preflight: list[PreflightCheck] = []
    perception: PerceptionView = PerceptionView()
    shaping: ShapingView | None = None
    answers: dict[str, list[str]] = {}
    by_condition: dict[str, dict[str, str]] = {}
    assigned: list[str] = []
    planned: int = 0
    trial: int = 1
    running: bool = False
    on_break: bool = False
    due: list[str] = []
    words: QuestionnaireWords = ENGLISH
    language: str = ""


class ReplayedLog(msgspec.Struct, frozen=True):
    """The log that a replay plays: at `t` microseconds the clock on the wall said `ts`. `coder` is
    who codes it; empty: nobody.
    """

    t: int = 0
    ts: str = ""
    notes: list[str] = []
    wizard: str = ""
    experiment: str = ""
    software: str = ""
    lines: int = 0
    coder: str = ""


#: A press that may be older is not played, in seconds, unless the experiment says otherwise.
STALE_S = 1.5


class WelcomeSettings(msgspec.Struct, frozen=True, kw_only=True):
    """See `docs/reference/protocol.md`. `outlines` are as the drivers' classes give them; `replay`
    is there in a replay alone.
    """

    stale_after: float = 0.0
    dead_man: float = 0.0
    abandon_after: float = 0.0
    driving: str = ""
    participant_pattern: str = ""
    joints: dict[str, tuple[float, float]] = {}
    outlines: dict[str, Json] = {}
    moves: dict[str, list[str]] = {}
    values: dict[str, str] = {}
    steps: dict[str, float] = {}
    lanes: dict[str, dict[str, str]] = {}
    repairs: list[ActionView] = []
    profiles: list[str] = []
    profile: str = ""
    allows: dict[str, Allowance] = {}
    engagement: ModelLimits = ModelLimits()
    phases: list[PhaseView] = []
    slots: dict[str, SlotView] = {}
    participant_fields: dict[str, list[str]] = {}
    sensors: list[str] = []
    study: StudySettings = StudySettings()
    replay: ReplayedLog | UnsetType = UNSET

    @property
    def beside_panels(self) -> list[ActionView]:
        """Actions of features, which stand on no panel."""
        return self.repairs
