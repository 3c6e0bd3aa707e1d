"""The model beside a second one, written as plainly as the formulas stand there (E1, E5)."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from woz_tui.experiment.engagement import EngagementSettings
from woz_tui.sensing.rows import Rows

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
    """The table of the paper as a function; a handshake is begun three times at most."""

    def __init__(self) -> None:
        self.state = "Wait"
        self.failed = 0

    def step(self, event: str | None, present: bool, engaged: bool, known: bool) -> str | None:
        found = self.edge(event, present, engaged, known)
        if found is None:
            return None
        outcome, self.state = found
        self.failed += outcome == "eng2unknow"
        if self.state in ("Wait", "PersonDetected"):
            self.failed = 0
        return outcome

    def edge(
        self, event: str | None, present: bool, engaged: bool, known: bool
    ) -> tuple[str, str] | None:
        by_event = {
            ("Wait", "stop"): ("end", "stop"),
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
        return None


EVENTS = [
    *("handshake_fail", "handshake_ok", "reply_done", "robot_initiative", "say_done"),
    *("speech_end", "speech_error", "speech_start", "stop", "think_done"),
]
missing = st.none() | st.just("NaN")
#: Mostly somebody is with the robot, so that the machine gets somewhere.
row = st.fixed_dictionaries(
    {
        "dt": st.sampled_from([333, 333, 334, 334, 500, 1000, 1001, 2500]),
        "presence": st.sampled_from([1, 1, 1, 0]) | missing,
        "gaze": st.sampled_from([1, 1, 1, 0]) | missing,
        "id": st.sampled_from(["Anna", "Anna", "Bert", UNKNOWN]) | st.none(),
        "distance": st.sampled_from([0.9, 0.9, 1.3, 1.31, 0.3, 7.0, "Infinity", 0, -1]) | missing,
        "events": st.lists(st.sampled_from(EVENTS[:-2] + EVENTS[-1:]), max_size=2),
    }
)


@given(
    st.lists(row, max_size=60),
    st.integers(1, 6),
    st.sampled_from(["0", "0.1", "0.3", "0.5", "0.7", "1"]),
    st.sampled_from(["zero-fill", "partial", "hold"]),
)
def test_the_model_says_what_the_plain_one_says(
    rows: list[dict[str, Any]], n: int, threshold: str, start_up: str
) -> None:
    model = Rows(EngagementSettings(samples=n, threshold=float(threshold), start_up=start_up))
    plain = {key: Plain(n, threshold, start_up) for key in ("presence", "gaze", "distance", "id")}
    machine, milliseconds = Machine(), 0
    for given_row in rows:
        milliseconds += given_row["dt"]
        said = model.take({**given_row, "t": milliseconds / 1000})
        for key, sign in plain.items():
            sign.hear(Fraction(milliseconds, 1000), _meant(key, given_row[key]))
        verdicts = {key: plain[key].verdict() for key in ("presence", "gaze", "distance")}
        name = plain["id"].name()
        engaged = all(verdicts.values())
        outcomes = [
            machine.step(event, verdicts["presence"] == 1, engaged, name != UNKNOWN)
            for event in given_row["events"] or [None]
        ]
        taken = [outcome for outcome in outcomes if outcome is not None]
        # A sign that fell silent says no rather than nothing.
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
