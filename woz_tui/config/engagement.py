"""What an experiment file may say under `engagement`: signs, filters, timeouts, effects.

The shapes alone; `woz_tui.sensing` does something with them. Defaults are those of the paper (U.
Maniscalco, P. Storniolo, A. Messina, Int. J. of Social Robotics 14, 2022, doi
10.1007/s12369-021-00855-w) and, where it is silent, of the program that its authors published;
`docs/explanation/engagement-paper.md` tells which is which.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Annotated

from woz_tui.config.engagement_words import (
    CAMERAS,
    CONDITION,
    FILTERS,
    MODES,
    RUNS,
    SIGNS,
    START_UPS,
    TURNS,
    VISITOR,
)
from woz_tui.drivers.fields import Doc, OneOf, Path, Range, Seconds, Section
from woz_tui.protocol.sentence import Sentence

_Places = Annotated[int, Range(1, 1000), Doc("samples in the queue (n)")]
_Share = Annotated[float, Range(0, 1), Doc("share of the queue that decides (t_r)")]
_Stale = Annotated[
    float, Seconds(0.05, 60.0), Doc("time without a valid sample after which the sign is stale")
]


@dataclass(frozen=True, slots=True)
class SignSettings:
    """One sign; what is left out is as the whole engagement has it."""

    sensor: Annotated[
        str, Doc("reading that gives it, such as left.gaze; default: the sign's own name")
    ] = ""
    filter: Annotated[str | None, OneOf(FILTERS), Doc("fifo, joint; median for distance")] = None
    samples: _Places | None = None
    threshold: _Share | None = None
    stale: _Stale | None = None
    rate: Annotated[
        float | None,
        Range(0.1, 1000, "Hz"),
        Doc("most samples per second that are used, for fast sensors; default: all"),
    ] = None


@dataclass(frozen=True, slots=True)
class SoundSettings:
    """When the visitor speaks, where no microphone driver cuts speech into segments itself."""

    sensor: Annotated[str, Doc("reading that gives the loudness")] = "loudness"
    threshold: Annotated[
        float | None,
        Range(0, 1),
        Doc("sound above this RMS is speech; default: the microphone's value"),
    ] = None
    hang_over: Annotated[float, Seconds(0.05, 10), Doc("silence of this length ends speech")] = 1.0


@dataclass(frozen=True, slots=True)
class JointSettings:
    """The joint filter's one number; the others stand in `woz_tui/sensing/joint_filter.py`."""

    glance: Annotated[
        float,
        Seconds(0.1, 10),
        Doc(
            "how long an engaged visitor glances away on average; with a longer time, turning away"
            " is noticed later"
        ),
    ] = 0.56


@dataclass(frozen=True, slots=True)
class Timeouts:
    """Seconds; none: never. Edges beyond the paper's table are off unless a time is given."""

    unrecognized: Annotated[
        float, Seconds(0, 60), Doc("longest time for which an engaged visitor can have no name")
    ] = 0.0
    lost: Annotated[
        float, Seconds(0, 60), Doc("time for which the condition must fail until a visitor is lost")
    ] = 0.0
    approach: Annotated[
        float | None, Seconds(0.1, 3600), Doc("a person who does not engage: back to Wait")
    ] = None
    listening: Annotated[
        float | None, Seconds(0.1, 3600), Doc("speech that never ends: an error")
    ] = 60.0
    thinking: Annotated[
        float | None, Seconds(0.1, 3600), Doc("nobody answers: give up (beyond the table)")
    ] = None
    talking: Annotated[
        float | None, Seconds(0.1, 3600), Doc("the robot's utterance never ends: give up")
    ] = 120.0
    absent: Annotated[
        float | None,
        Seconds(0.1, 3600),
        Doc(
            "nobody is there during a handshake, or while somebody speaks or the robot thinks or"
            " speaks: Wait; default: at once, with turns: paper never (beyond the table)"
        ),
    ] = None
    unengaged: Annotated[
        float | None,
        Seconds(0.1, 3600),
        Doc(
            "whoever spoke has not been engaged for so long, and for `lost`, while they speak or"
            " the robot thinks or replies: they are lost; never with turns: paper (beyond the"
            " table)"
        ),
    ] = 10.0

    @property
    def turn_lost(self) -> float | None:
        """Seconds out of engagement after which whoever spoke is lost in their turn: no sooner than
        outside of one. None: never.
        """
        return None if self.unengaged is None else max(self.unengaged, self.lost)


@dataclass(frozen=True, slots=True)
class HandshakeSettings:
    """How an unknown visitor gets a name. `{name}` in the sentences is what was understood."""

    by: Annotated[
        str,
        OneOf(("wizard", "robot", "nobody")),
        Doc("who leads the handshake; nobody: no handshakes"),
    ] = "wizard"
    attempts: Annotated[int, Range(1, 20), Doc("how often a name is asked for")] = 3
    seconds: Annotated[float, Seconds(1, 600), Doc("longest time for the whole handshake")] = 60.0
    silence: Annotated[
        float, Seconds(1, 60), Doc("time without an answer after which it asks again")
    ] = 8.0
    ask: Annotated[str, Doc("asks for the name")] = "I do not think we have met. What is your name?"
    again: Annotated[str, Doc("asks once more")] = "Sorry, what is your name?"
    confirm: Annotated[str, Doc("repeats the name to confirm it")] = "{name}, is that right?"
    taken: Annotated[str, Doc("when a visitor of this name is known already")] = (
        "I know {name} already. Is that you?"
    )
    another: Annotated[str, Doc("when it is another visitor")] = (
        "Then please tell me another name for you."
    )
    face_consent: Annotated[
        str,
        Doc(
            "asks whether it may learn their face; only a yes lets it; empty: it does not ask, and"
            " learns only whose consent the wizard gives"
        ),
    ] = ""
    welcome: Annotated[str, Doc("at the end")] = "Nice to meet you, {name}!"
    give_up: Annotated[str, Doc("when it did not work")] = "Never mind, let us go on."
    yes: Annotated[tuple[str, ...], Doc("answers that confirm")] = ("yes", "yeah", "right", "ok")
    no: Annotated[tuple[str, ...], Doc("answers that deny")] = ("no", "nope", "wrong")


@dataclass(frozen=True, slots=True)
class AttentionSettings:
    """What the robot does about a sound elsewhere (modes of NAOqi's basic awareness)."""

    mode: Annotated[str, OneOf(MODES), Doc("what may distract it from an engaged visitor")] = (
        "SemiEngaged"
    )
    look: Annotated[bool, Doc("turn the head towards where a sound comes from")] = False
    seconds: Annotated[float, Seconds(0.2, 30), Doc("how long it looks there")] = 2.0
    within: Annotated[
        float, Range(0, 180, "degrees"), Doc("directions that differ less than this are the same")
    ] = 15.0
    camera: Annotated[
        str, OneOf(CAMERAS), Doc("where the camera is: on the head, it sees who is where it looks")
    ] = "body"


@dataclass(frozen=True, slots=True)
class EngagementSettings(Section):
    """The model's settings. Distances in metres, times in seconds, rates in samples a second."""

    start: Annotated[str, OneOf(RUNS), Doc("run, hold (only the wizard changes it) or off")] = "run"
    signs: Annotated[
        tuple[Annotated[str, OneOf(CONDITION)], ...],
        Doc("signs that the condition of engagement uses"),
    ] = CONDITION
    rate: Annotated[float, Range(0.1, 1000, "Hz"), Doc("samples a second of a sensor")] = 3.0
    filter: Annotated[str, OneOf(FILTERS), Doc("fifo, median (distance only) or joint")] = "fifo"
    samples: _Places = 8
    threshold: _Share = 0.5
    start_up: Annotated[
        str,
        OneOf(START_UPS),
        Doc("queue that is not full: empty places count as no, or are ignored"),
    ] = "zero-fill"
    stale: _Stale = 1.0
    social_distance: Annotated[float, Range(0.1, 10, "m"), Doc("near enough to talk (S_d)")] = 1.3
    farthest: Annotated[float, Range(0.5, 100, "m"), Doc("beyond the range of the sensor")] = 5.0
    presence: SignSettings = field(default_factory=SignSettings)
    gaze: SignSettings = field(default_factory=SignSettings)
    distance: SignSettings = field(default_factory=SignSettings)
    identity: SignSettings = field(default_factory=SignSettings)
    joint: JointSettings = field(default_factory=JointSettings)
    sound: SoundSettings = field(default_factory=SoundSettings)
    turns: Annotated[
        str,
        OneOf(TURNS),
        Doc(
            "visitor: a turn ends when whoever spoke has gone, was replaced by somebody else, or"
            " has not been engaged for timeouts.unengaged; paper: not before it is over"
        ),
    ] = VISITOR
    timeouts: Timeouts = field(default_factory=Timeouts)
    handshake: HandshakeSettings = field(default_factory=HandshakeSettings)
    attention: AttentionSettings = field(default_factory=AttentionSettings)
    visitors: Annotated[
        str, Path(), Doc("file with the visitors who have a name; default: beside the logs")
    ] = ""
    signals: Annotated[
        str, OneOf(("default", "none")), Doc("default: eyes, screen and beep by state, if any")
    ] = "default"

    def sign(self, name: str) -> SignSettings:
        settings: SignSettings = getattr(self, name)
        return settings

    @property
    def limits(self) -> dict[str, float | None]:
        """The timeouts that count, by name; None: never."""
        unengaged = self.timeouts.turn_lost if self.turns == VISITOR else None
        return {**asdict(self.timeouts), "unengaged": unengaged}

    def problems(self) -> list[tuple[str, str]]:
        """What is wrong between settings: pairs of a setting's name and a sentence."""
        found: list[tuple[str, str]] = []
        for name in SIGNS:
            if name != "distance" and self.sign(name).filter == "median":
                median = Sentence(
                    "check.median_of_sign", "a median is for distance; take fifo or joint"
                )
                found.append((f"{name}.filter", median))
            stale = self.sign(name).stale
            if stale is not None and stale * self.rate < 1:
                found.append((f"{name}.stale", self._too_soon(stale)))
        if not self.signs:
            one = Sentence(
                "check.signs_missing", "name at least one of {signs}", signs=", ".join(CONDITION)
            )
            found.append(("signs", one))
        elif len(set(self.signs)) < len(self.signs):
            found.append(("signs", Sentence("check.sign_twice", "a sign appears here twice")))
        if self.stale * self.rate < 1:
            found.append(("stale", self._too_soon(self.stale)))
        if self.social_distance >= self.farthest:
            beyond = Sentence(
                "check.beyond_farthest",
                "lies beyond farthest ({farthest:g} m)",
                farthest=self.farthest,
            )
            found.append(("social_distance", beyond))
        both = {word.casefold() for word in self.handshake.yes} & {
            word.casefold() for word in self.handshake.no
        }
        if both:
            unclear = Sentence(
                "check.yes_and_no", "{words} means both yes and no", words=", ".join(sorted(both))
            )
            found.append(("handshake.no", unclear))
        return found

    def _too_soon(self, stale: float) -> str:
        return Sentence(
            "check.too_soon",
            "{stale:g} s is shorter than the time between two samples"
            " ({period:.2g} s at {rate:g} Hz)",
            stale=stale,
            period=1 / self.rate,
            rate=self.rate,
        )
