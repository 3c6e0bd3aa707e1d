"""What is said of proposals in the log and on the socket."""

from __future__ import annotations

from typing import Literal

import msgspec

from woz_tui.protocol.envelope import Json, Message, RestrictedMessage
from woz_tui.protocol.kinds import EndedKind, FeatureKinds
from woz_tui.protocol.requests import Request


class SuggestSettings(Message, frozen=True, kw_only=True, tag="suggest.settings"):
    """From here on the wizard is offered what these `sources` propose (logs, model, program), and
    these `programs` do nothing that the wizard does not approve. `after_us`: no sooner after the
    visitor's speech.
    """

    sources: list[str] = msgspec.field(default_factory=list)
    programs: list[str] = msgspec.field(default_factory=list)
    after_us: int = 0


class SuggestTrial(Message, frozen=True, kw_only=True, tag="suggest.trial"):
    """In this trial proposals are `offered`, or not: with `trials: half` chance has decided it.
    Approvals of programs that only propose are asked for all the same.
    """

    trial: int
    offered: bool


class SuggestRehearsed(Message, frozen=True, kw_only=True, tag="suggest.rehearsed"):
    """Training: with the cue `cue` these actions (`items`; none: it goes without) are proposed,
    unless it is answered before. `fits`: one of them answers it; else they were planted.
    """

    cue: str
    items: list[str]
    fits: bool = False


class SuggestModel(Message, frozen=True, kw_only=True, tag="suggest.model"):
    """`woz suggest` asks this model from here on: the address `url`, the name that is asked for,
    the settings of the request (`sampling`), and the `prompt` before the dialogue.
    """

    url: str = ""
    name: str = ""
    sampling: dict[str, float] = {}
    prompt: str = ""


class SuggestAsked(Message, frozen=True, kw_only=True, tag="suggest.asked"):
    """A model was asked. `asked`: the whole request as it went out; `model`: the name with which
    the server answered, `fingerprint` its own word for its version; `answer`: all that it wrote;
    `prompt_sha256`: of the prompt. `first_us`, `took_us`: from the request to the first piece and
    to the end. `error`: why nothing came of it. `warm_up`: before anybody had said anything, so
    that the model is loaded and has read its prompt; nothing of the answer was offered.
    """

    cue: str = ""
    asked: dict[str, Json] = {}
    model: str = ""
    fingerprint: str = ""
    answer: str = ""
    prompt_sha256: str = ""
    first_us: int = -1
    took_us: int = 0
    error: str = ""
    warm_up: bool = False


class SuggestState(Message, frozen=True, kw_only=True, tag="suggest.state"):
    """How it stands with the model from here on: loading (nobody gets sentences yet), ready (its
    last warm-up took `first_us` until the first piece), failing (`why`: slow, unreachable, refuses,
    cut, odd, or empty where it answers with nothing that can be offered; it is asked again after a
    while), dropped (nothing of its last answer could be offered, `why` as of failing; it is asked
    on), gone (`woz suggest` has left). `model`: the name with which the server answered.
    """

    how: str
    why: str = ""
    model: str = ""
    first_us: int = -1


class ProposedItem(msgspec.Struct, frozen=True, omit_defaults=True):
    """One item of a set: an action by its name (`args`: its slots), a sentence, or a verb with its
    arguments, in which nothing is filled in any more. `on`: the driver that is to do it, where the
    program names one; `when_busy`: what it is to do where its lane is occupied. Of sentences of a
    program: how like one of the robot's last three it is (`likeness`, 0 to 1), the share of
    questions among them and it (`asking`), and what of that the wizard reads (`marks`: repeats,
    asks again).
    """

    id: str
    action: str = ""
    text: str = ""
    verb: str = ""
    args: dict[str, Json] = {}
    on: str = ""
    when_busy: str = ""
    likeness: float = 0.0
    asking: float = 0.0
    marks: list[str] = []


class SuggestOffered(RestrictedMessage, frozen=True, kw_only=True, tag="suggest.offered"):
    """The set `set` is offered. `source`: logs, model or program; `who`: the program's name.
    `approval`: the program waits, and does nothing that is not taken. `cue`: driver and segment of
    the visitor's words that it answers. It expires at `until` (0: not by itself).
    """

    kept_whole = True
    set: str
    source: str
    who: str = ""
    approval: bool = False
    items: list[ProposedItem]
    cue: str = ""
    until: int = 0


class SuggestRanked(Message, frozen=True, kw_only=True, tag="suggest.ranked"):
    """Why the items of a set were chosen (`reasons`: script, order, words), and how likely each
    is. Where something is kept from the wizard, nobody at a console gets it.
    """

    set: str
    reasons: list[str]
    scores: list[float]


class SuggestShown(Message, frozen=True, kw_only=True, tag="suggest.shown"):
    """These `items` of a set stood on the screen of a wizard for the first time; whether they were
    read nobody knows. `after_us`: from the offer.
    """

    names_console = True
    set: str
    items: list[str]
    after_us: int = 0
    console: str = ""


class SuggestTaken(RestrictedMessage, frozen=True, kw_only=True, tag="suggest.taken"):
    """A set ended: the wizard took `item`. `how`: key; edited (`text` was said in its place);
    own_key (the action was played by its own key). `run`: what came of it, an action's run or a
    command. `after_us`: from the offer.
    """

    names_console = True
    kept_whole = True
    set: str
    item: str
    how: str
    run: str = ""
    after_us: int = 0
    text: str = ""
    console: str = ""


class SuggestGone(Message, frozen=True, kw_only=True, tag="suggest.gone"):
    """A set ended, and nothing of it was taken. `how`: other_act, superseded, expired, stop,
    dismissed, refused (it was taken, and was not possible), withdrawn, reloaded, moved_on (another
    trial or phase), end.
    """

    set: str
    how: str


class AskTake(Request, frozen=True, kw_only=True, tag="take"):
    """Take an item of the set `set`. `text`: say this in place of its sentence. Refused if the set
    has ended: what is asked for is what was seen.
    """

    aged = True
    plays = True
    set: str
    item: str
    text: str = ""
    key: str = ""
    age_us: int = 0
    stale: bool = False


class AskDismiss(Request, frozen=True, kw_only=True, tag="dismiss"):
    """Take nothing of the set `set`."""

    set: str


class AskShown(Request, frozen=True, kw_only=True, tag="shown"):
    """Of a wizard's console: these `items` of the set `set` stand on its screen now."""

    set: str
    items: list[str]


class AskPropose(Request, frozen=True, kw_only=True, tag="propose"):
    """Offer the wizard up to three sentences (`texts`) or actions by their names, for `within`
    seconds. They stand in place of what this program proposed before. The reply's `data` has
    `set`. `cue`: the driver and segment of the visitor's words that it answers. `source`: model,
    where one wrote the sentences.
    """

    texts: list[str] = []
    actions: list[str] = []
    within: float = 10.0
    source: Literal["program", "model"] = "program"
    cue: str = ""


class AskModelTold(Request, frozen=True, kw_only=True, tag="model-told"):
    """Of `woz suggest`: what it asked a model, and what came of it, for the log (as in
    `suggest.asked`). `given_up`: it asks no more for a while; the wizard is told by `model-state`.
    """

    cue: str = ""
    asked: dict[str, Json] = {}
    model: str = ""
    fingerprint: str = ""
    answer: str = ""
    prompt_sha256: str = ""
    first_us: int = -1
    took_us: int = 0
    error: str = ""
    given_up: bool = False
    warm_up: bool = False


#: What a program may tell of its model.
ModelStateWord = Literal["loading", "ready", "dropped", "failing"]


class AskModelState(Request, frozen=True, kw_only=True, tag="model-state"):
    """Of `woz suggest`: how it stands with its model now, for the log and the wizard (as in
    `suggest.state`).
    """

    how: ModelStateWord
    why: str = ""
    model: str = ""
    first_us: int = -1


MESSAGES = (
    *(SuggestSettings, SuggestModel, SuggestAsked, SuggestState, SuggestTrial, SuggestRehearsed),
    *(SuggestOffered, SuggestRanked, SuggestTaken, SuggestGone, SuggestShown),
)
KINDS = FeatureKinds(
    messages=MESSAGES,
    requests=(AskTake, AskDismiss, AskPropose, AskModelTold, AskModelState, AskShown),
    open=(SuggestSettings, SuggestModel, SuggestState, SuggestGone, SuggestShown, SuggestTrial),
    unlisted=(SuggestRanked, SuggestAsked, SuggestShown, SuggestRehearsed),
    ended=(EndedKind(SuggestOffered, (SuggestTaken, SuggestGone), "set"),),
)
