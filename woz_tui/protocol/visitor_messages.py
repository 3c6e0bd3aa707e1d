"""What is said about a visitor: how the engagement model sees them, what they say, who they are.

Everybody imports these from `woz_tui.protocol.messages`, where all messages are together.
"""

from __future__ import annotations

import msgspec

from woz_tui.protocol.envelope import Json, Message


class EngagementChanged(
    Message, frozen=True, kw_only=True, omit_defaults=True, tag="engagement.changed"
):
    """The engagement machine moved; `why` gives the reason in words.

    `verdicts`: presence, gaze, distance (near) as 0, 1 or null, identity as text. `visitor` is the
    code of whoever is known. `forced`: the wizard did it, or a verdict it rests on is the wizard's.
    """

    was: str
    now: str
    outcome: str
    why: str
    verdicts: dict[str, Json]
    visitor: str = ""
    forced: bool = False


class EngagementAdopted(
    Message, frozen=True, kw_only=True, omit_defaults=True, tag="engagement.settings"
):
    """The model goes by these settings from here on: all that the experiment's section says, with
    the defaults, but without the path `visitors`. Told when the session begins and when a reload
    changes them; an empty object: the section is gone, and the model with it.
    """

    settings: dict[str, Json]


class SignShown(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """A sign of the visitor: what was sensed last, and what the filter makes of it.

    `raw` is the last sample (0/1, metres), `raw_name` an identity. `verdict` is 0, 1 or null (no
    verdict yet), `name` that of an identity. `count` of `places` samples speak for it, `needed` of
    them suffice; a joint filter has places 100 and counts per cent. `forced`: it is the wizard's.
    """

    raw: float | None = None
    raw_name: str = ""
    verdict: int | None = None
    name: str = ""
    count: int = 0
    needed: int = 0
    places: int = 0
    filter: str = ""
    stale: bool = False
    forced: bool = False


class EngagementShown(
    Message, frozen=True, kw_only=True, omit_defaults=True, tag="engagement.shown"
):
    """The model as it stands; told when something of it changes, at most some times a second.

    `since` and `waits_since` are times `t` in microseconds: when the state was entered, and since
    when the visitor waits for an answer (-1: nobody does). `trail` has the last states, oldest
    first, the present one at its end. `run` is run, hold or off; `next` is where a held machine
    would go.
    `uses` names the signs of the condition. `attempt` counts a handshake's questions.
    """

    state: str
    since: int
    trail: list[str]
    signs: dict[str, SignShown]
    run: str
    uses: list[str]
    social_distance: float
    engaged: bool
    next: str = ""
    waits_since: int = -1
    visitor: str = ""
    attempt: int = 0
    attention: str = ""


class SpeechStarted(Message, frozen=True, kw_only=True, omit_defaults=True, tag="speech.started"):
    """Somebody speaks. `segment` counts from 1; `began` is where it begins, pre-roll included, in
    microseconds on the axis of `t`.
    """

    driver: str
    segment: int
    began: int


class SpeechEnded(Message, frozen=True, kw_only=True, omit_defaults=True, tag="speech.ended"):
    """They have stopped. `began` and `ended` in microseconds on the axis of `t`, pre-roll and
    trailing silence included; `file` is relative to the log's folder (empty: nothing was kept, and
    `detail` says why where that was not wanted). `loudest` is an RMS, 0..1 of full scale.
    """

    driver: str
    segment: int
    began: int
    ended: int
    file: str = ""
    loudest: float | None = None
    detail: str = ""


class SpeechText(Message, frozen=True, kw_only=True, omit_defaults=True, tag="speech.text"):
    """What a segment says, as a program understood it. An empty text means that nothing
    was understood, or that it failed: then `detail` says why. `took_us`: from the end of speech.
    """

    driver: str
    segment: int
    text: str
    took_us: int = 0
    detail: str = ""


#: What a driver that cuts speech into segments tells of them.
Speech = SpeechStarted | SpeechEnded | SpeechText


class VisitorChanged(Message, frozen=True, kw_only=True, omit_defaults=True, tag="visitor.changed"):
    """The store of visitors changed. `what`: met, learnt, profile, renamed (then `was` is the old
    code) or forgotten. `about` has what is known of them (age_group, address), nothing else.
    """

    visitor: str
    what: str
    was: str = ""
    about: dict[str, str] = msgspec.field(default_factory=dict)
