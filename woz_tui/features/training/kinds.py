"""What is said of trainings in the log and on the socket."""

from __future__ import annotations

from woz_tui.protocol.envelope import Message
from woz_tui.protocol.kinds import FeatureKinds
from woz_tui.protocol.requests import Request

#: How an answer is judged (see `CueAnswered`).
RIGHT, WRONG, MISSED, UNCALLED, VOID = "right", "wrong", "missed", "uncalled", "void"


class TrainingChanged(Message, frozen=True, kw_only=True, tag="training.changed"):
    """How far a training of the wizard is: `state` is waits (for the key that begins it), runs or
    over. `planned`: how many cues there are. When it is over, the counts are as in `cue.answered`,
    and `median_us` is the median reaction time to all that was answered (-1: nothing was).
    """

    state: str
    planned: int
    right: int = 0
    wrong: int = 0
    missed: int = 0
    uncalled: int = 0
    median_us: int = -1


class CueGiven(Message, frozen=True, kw_only=True, tag="cue.given"):
    """Training: the simulated visitor did something that wants an answer: one of the actions that
    `expects` names, within `window_us`. `sort`: approach, question, silence, turn-away, leave ...
    """

    cue: str
    sort: str
    text: str = ""
    expects: list[str]
    window_us: int


class CueAnswered(Message, frozen=True, kw_only=True, tag="cue.answered"):
    """What the wizard made of it. `judged`: right, wrong (another action), missed (nothing in time)
    uncalled (an action without a cue, then `cue` is empty) or void (the stop was pressed, or the
    training ended meanwhile). `reaction_us`: from the cue to the request (-1: none).
    """

    cue: str
    judged: str
    action: str = ""
    run: str = ""
    reaction_us: int = -1


class AskTraining(Request, frozen=True, kw_only=True, tag="training"):
    """Begin the training that waits for it."""


KINDS = FeatureKinds(
    messages=(TrainingChanged, CueGiven, CueAnswered),
    requests=(AskTraining,),
    open=(TrainingChanged, CueGiven, CueAnswered),
)
