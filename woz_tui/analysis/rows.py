"""What happened in a session, one by one: cues, trials, stops, answers, with times like `t`."""

from __future__ import annotations

from dataclasses import dataclass

#: What can be a cue. `training` are those of `woz train`.
CUE_SORTS = ("speech", "engagement", "marker", "training")
#: What can become of a cue.
CUE_FATES = ("answered", "anticipated", "missed", "overtaken", "cut")
#: Outcomes of trials whose data do not count unless somebody wants all of them.
NOT_COUNTED = ("aborted", "excluded")


@dataclass(frozen=True, slots=True)
class Cue:
    """Something that wants an answer, and what the wizard made of it.

    Attributes:
        sort: One of `CUE_SORTS`.
        t: Its moment.
        what: The state, the number of the utterance, the marker's text, the trained cue's sort.
        fate: One of `CUE_FATES`.
        reaction_us: To the act that answered it; None: nothing did.
        action: Name of that action, or the verb of a command that belonged to none.
        run: Id of that run, or of the command.
        echo: It followed within a second of another open cue and stands for the same event, so
            the figures over all sorts leave it out.
        judged: Of trained cues: right, wrong or missed.
        trial: Number of the trial, -1 outside.
    """

    sort: str
    t: int
    what: str
    fate: str
    reaction_us: int | None = None
    action: str = ""
    run: str = ""
    echo: bool = False
    judged: str = ""
    participant: str = ""
    condition: str = ""
    trial: int = -1
    counted: bool = True


@dataclass(frozen=True, slots=True)
class Trial:
    """A trial; `end` is None if it never ended, then `outcome` is empty."""

    trial: int
    participant: str
    condition: str
    begin: int
    end: int | None
    outcome: str
    text: str
    actions: int

    @property
    def counted(self) -> bool:
        """Whether its data are to be analysed."""
        return self.outcome not in NOT_COUNTED


@dataclass(frozen=True, slots=True)
class Span:
    """Something that lasted: a break, a lost driver. `end` is None if it lasted to the end."""

    begin: int
    end: int | None
    name: str
    text: str = ""


@dataclass(frozen=True, slots=True)
class Stop:
    """A stop. `elapsed_us` and the drivers are None and empty if no confirmation is in the log;
    a driver of several parts is followed by those in brackets. `unreached`: those of `missing`
    that were not connected.
    """

    t: int
    source: str
    scope: str
    confirmed: tuple[str, ...] = ()
    missing: tuple[str, ...] = ()
    unreached: tuple[str, ...] = ()
    elapsed_us: int | None = None
    released: int | None = None


@dataclass(frozen=True, slots=True)
class Mark:
    """A marker, note or mistake (`sort`); of a mistake also which run of which action."""

    t: int
    sort: str
    text: str = ""
    action: str = ""
    run: str = ""
    source: str = ""


@dataclass(frozen=True, slots=True)
class Visit:
    """A stay in a state of the engagement model, or (`state` is `engaged`) an unbroken engagement.

    `cut`: it was not over when the log, or the model, ended.
    """

    state: str
    begin: int
    end: int
    outcome: str = ""
    visitor: str = ""
    cut: bool = False
    participant: str = ""
    condition: str = ""
    trial: int = -1


@dataclass(frozen=True, slots=True)
class Difference:
    """A robot's setting was other than asked for, within one trial and condition.

    Attributes:
        setting: Its name.
        value: What the robot had, in words.
        wanted: What was asked for.
        begin: When it was read so.
        end: When it was read otherwise, the robot was lost, or the trial or condition changed.
        changed: It began then; else it goes on from before a change of trial or condition.
        cut: It lasted when the log ended.
        trial: Number of the trial, -1 outside.
    """

    driver: str
    setting: str
    value: str
    wanted: str
    begin: int
    end: int
    changed: bool = True
    cut: bool = False
    participant: str = ""
    condition: str = ""
    trial: int = -1
    counted: bool = True


@dataclass(frozen=True, slots=True)
class Answer:
    """The last answer to an item in one round of a questionnaire.

    `value` is None for texts and for what was left out; `low` and `high` are None unless the item
    is a scale.
    """

    questionnaire: str
    round: int
    item: str
    question: str
    value: float | None
    text: str
    skipped: bool
    answered_us: int | None
    low: float | None = None
    high: float | None = None
    participant: str = ""
    condition: str = ""
    trial: int = -1


@dataclass(frozen=True, slots=True)
class Round:
    """A questionnaire put to somebody once. `reason`: done, declined, left; empty: no end."""

    questionnaire: str
    round: int
    title: str
    t: int
    reason: str
    answered: int
    items: int


@dataclass(frozen=True, slots=True)
class Restriction:
    """From `t` on the wizard did not see what is `hidden`, nor legibly what is `blurred`."""

    t: int
    hidden: tuple[str, ...]
    blurred: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Shaping:
    """From `t` on answers to these cues were held back: `floor_us`, and up to `jitter_us` more."""

    t: int
    floor_us: int
    jitter_us: int
    cues: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class PanelOffer:
    """A panel that the wizard had, as it was at the beginning."""

    title: str
    actions: tuple[str, ...]
    locked: bool


@dataclass(frozen=True, slots=True)
class ConsoleChange:
    """A console came (`why` is empty) or went."""

    t: int
    console: str
    role: str
    lost: bool
    why: str = ""
