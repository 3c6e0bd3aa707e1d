"""The model beside a second one, written as plainly as the formulas stand there (E1, E5)."""

from __future__ import annotations

import random
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from woz_tui.config.engagement import EngagementSettings, Timeouts
from woz_tui.sensing.sample_rows import SampleRowReader

UNKNOWN = "Unknown"


@dataclass
class Plain:
    """All samples of a sign that were ever heard; each verdict is computed from scratch."""

    n: int
    threshold: str
    start_up: str
    heard: list[Any] = field(default_factory=list)
    last: Fraction | None = None
    given: str = ""
    ever: bool = False

    def hear(self, t: Fraction, value: Any) -> None:
        self.grow_old(t)
        if value is not None:
            self.heard.append(value)
            self.last, self.ever = t, True

    def grow_old(self, t: Fraction) -> None:
        if self.last is not None and t - self.last > 1:
            self.heard, self.given, self.last = [], "", None

    def enough(self, count: int) -> bool | None:
        held = len(self.heard[-self.n :])
        if self.start_up == "hold" and held < self.n:
            return None
        places = held if self.start_up == "partial" else self.n
        return held > 0 and Fraction(count, places) >= Fraction(self.threshold)

    def verdict(self) -> int | None:
        enough = self.enough(sum(self.heard[-self.n :]))
        return None if enough is None else int(enough)

    def name(self) -> str:
        window = self.heard[-self.n :]
        names = [name for name in window if name != UNKNOWN]
        if not names:
            return UNKNOWN
        most = max(map(names.count, names))
        if not self.enough(most):
            return UNKNOWN
        tied = {name for name in names if names.count(name) == most}
        if self.given not in tied:
            self.given = next(name for name in reversed(names) if name in tied)
        return self.given


class Machine:
    """The table of the paper as a function; a handshake is begun three times at most.

    `absent`: the limit of the extension in seconds; None: `turns` says whether at once or never.
    """

    def __init__(self, absent: Fraction | None, turns: str) -> None:
        self.state = "Wait"
        self.failed = 0
        self.absent, self.turns = absent, turns
        self.seen: Fraction | None = None
        self.gone = Fraction(0)
        self.name = self.face = self.visitor = ""
        self.replaced = False

    def recognise(self, name: str) -> None:
        """Whose turn it is stays so, whoever is recognised in it."""
        self.name = name = name if name != UNKNOWN else ""
        if name and name != self.face:
            self.face = name
            self.replaced = self.state in TURN and self.visitor not in ("", name)
            self.visitor = self.visitor if self.replaced else name
        elif self.state == "Wait" or not self.visitor:
            self.face = self.visitor = name

    def look(self, t: Fraction, present: bool) -> None:
        """For how long nobody has been there by now; before the first row, all the time."""
        if present:
            self.seen = None
        elif self.seen is None:
            self.seen = t
        self.gone = Fraction(0) if present else t - (self.seen or Fraction(0))

    def step(self, event: str | None, present: bool, engaged: bool, known: bool) -> str | None:
        found = self.edge(event, present, engaged, known)
        if found is None:
            return None
        outcome, self.state = found
        if self.replaced and self.state not in TURN:
            self.replaced, self.visitor = False, self.face
        if self.state in ("Wait", "EngagedWithUnknown"):
            self.visitor = self.name
        self.failed += outcome == "eng2unknow"
        if self.state in ("Wait", "PersonDetected"):
            self.failed = 0
        return outcome

    def edge(
        self, event: str | None, present: bool, engaged: bool, known: bool
    ) -> tuple[str, str] | None:
        by_event = {
            ("Handshake", "handshake_ok"): ("eng2know", "EngagedWithKnown"),
            ("Handshake", "handshake_fail"): ("eng2unknow", "EngagedWithUnknown"),
            ("EngagedWithKnown", "speech_start"): ("listening", "UserSpeaks"),
            ("EngagedWithKnown", "robot_initiative"): ("speaking", "RobotSpeaks"),
            ("UserSpeaks", "speech_end"): ("done", "RobotThinks"),
            ("UserSpeaks", "speech_error"): ("error", "EngagedWithKnown"),
            ("RobotThinks", "think_done"): ("done", "RobotReplies"),
            ("RobotReplies", "reply_done"): ("done", "EngagedWithKnown"),
            ("RobotSpeaks", "say_done"): ("done", "EngagedWithKnown"),
        }
        by_signs = {
            "Wait": ((present, "human_presence", "PersonDetected"),),
            "PersonDetected": (
                (not present, "human_absence", "Wait"),
                (engaged and known, "recognized", "EngagedWithKnown"),
                (engaged, "unrecognized", "EngagedWithUnknown"),
            ),
            "EngagedWithUnknown": (
                (not engaged, "error", "PersonDetected"),
                (self.failed < 3, "handshake", "Handshake"),
                (known, "recognized", "EngagedWithKnown"),
            ),
            "EngagedWithKnown": ((not engaged, "error", "PersonDetected"),),
        }
        lost = self.state == "EngagedWithKnown" and not engaged
        if event is not None and (self.state, event) in by_event and not lost:
            return by_event[self.state, event]
        for holds, outcome, to in by_signs.get(self.state, ()):
            if holds:
                return outcome, to
        if self.absent is None:
            over = self.turns == "visitor" and not present
        else:
            over = not present and self.gone >= self.absent
        if over and self.state in BUSY:
            return "human_absence", "Wait"
        another = self.turns == "visitor" and self.replaced and self.state in TURN
        return ("error", "PersonDetected") if another else None


TURN = ("UserSpeaks", "RobotThinks", "RobotReplies")
BUSY = ("Handshake", "UserSpeaks", "RobotThinks", "RobotReplies", "RobotSpeaks")


EVENTS = [
    *("handshake_fail", "handshake_ok", "reply_done", "robot_initiative", "say_done"),
    *("speech_end", "speech_error", "speech_start", "think_done"),
]
#: What may become of a sample, now and then.
ODD: dict[str, list[Any]] = {
    "presence": [1, 0, None, "NaN"],
    "gaze": [1, 0, None, "NaN"],
    "id": ["Anna", "Bert", UNKNOWN, None],
    "distance": [0.9, 1.3, 1.31, 0.3, 7.0, "Infinity", 0, -1, None, "NaN"],
}


class Visitors:
    """Rows about people who come, stay for a while and go, with some odd samples and events."""

    def __init__(self, chance: random.Random) -> None:
        self.chance = chance
        self.milliseconds = 0
        self.usual: dict[str, Any] = {}

    def row(self) -> dict[str, Any]:
        chance = self.chance
        if not self.usual or chance.random() < 0.05:
            there = chance.random() < 0.7
            name = chance.choice(["Anna", "Bert", UNKNOWN, UNKNOWN])
            self.usual = {"presence": there, "gaze": there, "id": name if there else UNKNOWN}
            self.usual["distance"] = 0.9 if there else 3.0
        self.milliseconds += chance.choice([*[333, 334] * 10, 500, 1000, 1001, 2500])
        found = {
            key: chance.choice(ODD[key]) if chance.random() < 0.05 else value
            for key, value in self.usual.items()
        }
        events = chance.choices(EVENTS, k=chance.choice([0, 0, 1, 2]))
        return {"t": self.milliseconds / 1000, **found, "events": events}


@given(
    st.integers(0, 10**6),
    st.integers(1, 6),
    st.sampled_from(["0", "0.1", "0.3", "0.5", "0.7", "1"]),
    st.sampled_from(["zero-fill", "partial", "hold"]),
    st.tuples(st.sampled_from([None, "0.1", "2", "7.5"]), st.sampled_from(["visitor", "paper"])),
)
def test_the_model_says_what_the_plain_one_says(
    seed: int, n: int, threshold: str, start_up: str, ends: tuple[str | None, str]
) -> None:
    """With `turns: paper` and without `timeouts.absent` there is the paper's table alone."""
    absent, turns = ends
    limits = Timeouts(absent=None if absent is None else float(absent), unengaged=None)
    settings = EngagementSettings(
        samples=n, threshold=float(threshold), start_up=start_up, turns=turns, timeouts=limits
    )
    model = SampleRowReader(settings)
    plain = {key: Plain(n, threshold, start_up) for key in ODD}
    machine = Machine(None if absent is None else Fraction(absent), turns)
    visitors = Visitors(random.Random(seed))
    for _ in range(150):
        row = visitors.row()
        said = model.add(row)
        for key, sign in plain.items():
            sign.hear(Fraction(visitors.milliseconds, 1000), _meant(key, row[key]))
        verdicts = {key: plain[key].verdict() for key in ("presence", "gaze", "distance")}
        name = plain["id"].name()
        machine.recognise(name)
        machine.look(Fraction(visitors.milliseconds, 1000), verdicts["presence"] == 1)
        outcomes = [
            machine.step(event, verdicts["presence"] == 1, all(verdicts.values()), name != UNKNOWN)
            for event in row["events"] or [None]
        ]
        taken = [outcome for outcome in outcomes if outcome is not None]
        for key, verdict in verdicts.items():
            silent = plain[key].ever and plain[key].last is None
            assert said[key] == (0 if silent else verdict)
        assert (said["id"], said["state"]) == (name, machine.state)
        assert said["outcome"] == (taken[-1] if taken else None)


def _meant(key: str, value: Any) -> Any:
    if value is None or value == "NaN":
        return None
    if key == "id":
        return value
    if key != "distance":
        return value == 1
    metres = float("inf") if value == "Infinity" else value
    return metres <= 1.3 if metres > 0 else None
