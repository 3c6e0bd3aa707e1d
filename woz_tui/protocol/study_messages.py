"""The experiment around the robot: who gets which condition, trials.

And what makes a log readable by itself: the experiment's files and what consoles were shown.
All others import them from `woz_tui.protocol.messages`.
"""

from __future__ import annotations

import msgspec

from woz_tui.protocol.envelope import Message, RestrictedMessage
from woz_tui.protocol.panels import PanelView
from woz_tui.protocol.sentence import Wording
from woz_tui.protocol.welcome import WelcomeSettings

# -- a log that needs nothing beside it -----------------------------------------------------------


class ExperimentFiles(Message, frozen=True, kw_only=True, tag="experiment.files"):
    """The experiment as it was read: name of each file, relative to the experiment's folder, and
    its text, the experiment itself first. At the beginning and after each reload. `left_out` names
    files that are too large to be kept here. `files_sha256` is what `sha256sum` says of each, those
    left out included; of the texts here alone, `~` stands for the home folder.
    """

    experiment_sha256: str
    files: dict[str, str]
    left_out: list[str] = []
    files_sha256: dict[str, str] = {}


class SessionPlan(Message, frozen=True, kw_only=True, tag="session.plan"):
    """What consoles are shown, as in a `welcome` (docs/reference/protocol.md), so that a replay can
    show the same: when the session begins and whenever it changes. `simulated`: drivers whose
    hardware is (None: not recorded).
    """

    title: str
    panels: list[PanelView]
    script: list[str] = msgspec.field(default_factory=lambda: [])
    verbs: dict[str, list[str]]
    variables: list[str]
    conditions: list[str]
    keyboard: str
    drivers: list[str]
    settings: WelcomeSettings
    simulated: list[str] | None = None


# -- conditions and trials ------------------------------------------------------------------------


class ConditionsAssigned(Message, frozen=True, kw_only=True, tag="condition.assigned"):
    """The order in which the participant gets the conditions; with one condition for each
    participant, that one. `method` is latin-square, blocks or fixed, or `hand` where the wizard
    chose otherwise; `row` counts the rows of the square, or the places of all blocks, from 0 (-1:
    none). `trials`: in each condition (0: as the file says). `over`: numbers of the trials
    that the participant has had in this order already (None: nobody said). `wording`: code and
    values of `why`.
    """

    participant: str
    order: list[str]
    method: str
    row: int = -1
    why: str = ""
    trials: int = 0
    over: list[int] | None = None
    wording: dict[str, Wording] = {}


class TrialStarted(Message, frozen=True, kw_only=True, tag="trial.started"):
    """A trial begins. `planned`: how many there are to be (0: nobody said)."""

    names_console = True
    trial: int
    condition: str = ""
    planned: int = 0
    console: str = ""


class TrialEnded(RestrictedMessage, frozen=True, kw_only=True, tag="trial.ended"):
    """It is over. `outcome`: done, aborted (to be run again) or excluded (not to be analysed)."""

    names_console = True
    trial: int
    outcome: str
    text: str = ""
    console: str = ""


class BreakStarted(RestrictedMessage, frozen=True, kw_only=True, tag="break.started"):
    """A break: what happens now belongs to no trial."""

    names_console = True
    text: str = ""
    console: str = ""


class BreakEnded(RestrictedMessage, frozen=True, kw_only=True, tag="break.ended"):
    """The break is over."""

    names_console = True
    text: str = ""
    console: str = ""


# -- asked of people ------------------------------------------------------------------------------


class PreflightChecked(Message, frozen=True, kw_only=True, tag="preflight.checked"):
    """One line of the preflight list: `level` is ok, warning or error; `source` is robot for what a
    program found out, and else who ticked it.
    """

    check: str
    level: str
    detail: str = ""
    source: str


# -- what shapes a wizard's answers ---------------------------------------------------------------


class ActionScheduled(Message, frozen=True, kw_only=True, tag="action.scheduled"):
    """An action or a single command waits for the moment `at` for which it was asked, on the axis
    of `t`; then it is looked at once more, and begins or is refused.
    """

    run: str
    action: str
    at: int


class PerceptionChanged(Message, frozen=True, kw_only=True, tag="perception.changed"):
    """What the wizard can see from here on: not what is `hidden`, and of what is `blurred` only
    that it is there.
    """

    hidden: list[str]
    blurred: list[str]


# -- run again ----------------------------------------------------------------------------------


class RerunStarted(Message, frozen=True, kw_only=True, tag="rerun.started"):
    """This session runs the commands of another one again: `original` is the name of its log,
    `original_session` its code, `original_sha256` of the bytes of its action log's lines.
    `commands`: how many are to come.
    """

    original: str
    original_session: str
    original_sha256: str = ""
    commands: int = 0


class RerunSent(Message, frozen=True, kw_only=True, tag="rerun.sent"):
    """A command was sent again: `command` is its id here, `original_command` there. `due` is when
    it should have been, on this session's axis of `t`; `late_us` how much later it was.
    """

    command: str
    original_command: str
    due: int
    late_us: int


class RerunSkipped(RestrictedMessage, frozen=True, kw_only=True, tag="rerun.skipped"):
    """A command of the original that is not sent again, and why."""

    original_command: str
    reason: str


class RerunEnded(Message, frozen=True, kw_only=True, tag="rerun.ended"):
    """The re-run is over: how many were sent and skipped, and the lateness of those sent."""

    reason: str
    sent_again: int
    skipped_commands: int
    late_p50_us: int = 0
    late_max_us: int = 0


#: All of this module, for the union of all messages.
STUDY_MESSAGES: tuple[type[Message], ...] = (
    ExperimentFiles,
    SessionPlan,
    ConditionsAssigned,
    TrialStarted,
    TrialEnded,
    BreakStarted,
    BreakEnded,
    PreflightChecked,
    ActionScheduled,
    PerceptionChanged,
    RerunStarted,
    RerunSent,
    RerunSkipped,
    RerunEnded,
)
