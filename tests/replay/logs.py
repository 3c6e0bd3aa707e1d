"""Logs made of messages, as the hub would have stamped them, and a look at what a console gets."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from datetime import UTC, datetime, timedelta
from typing import Any

import msgspec

from tests.protocol.feature_examples import feature_examples
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.state.event_sentences import EventLine
from woz_tui.console.state.view_models import SensorView
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.panels import ActionView, PanelView
from woz_tui.protocol.welcome import WelcomeSettings
from woz_tui.replay.player import Incoming, ReplayPlayer, ReplayStart
from woz_tui.replay.recording import Recording
from woz_tui.system.clock import timestamp

SECOND = 1_000_000
BEGAN = datetime(2026, 3, 1, 10, 0, tzinfo=UTC)

START = m.SessionStart(
    session="S01",
    participant="P07",
    condition="warm",
    wizard="W2",
    software={"name": "woz-tui", "version": "0.1.0"},
    experiment="guide.yaml",
    experiment_sha256="0" * 64,
    seed=7,
    clock={"source": "monotonic"},
)
PLAN = m.SessionPlan(
    title="Museum guide",
    panels=[
        PanelView(
            title="Speech",
            actions=[
                ActionView(name="Hello", label="Hello", key="h", verbs=["say"]),
                ActionView(name="Go", label="Go", key="g", verbs=["play"]),
            ],
        )
    ],
    script=["Hello", "Go"],
    verbs={"robot": ["say", "play"]},
    variables=[],
    conditions=["warm", "cold"],
    keyboard="us",
    drivers=["robot"],
    settings=msgspec.convert({
        "study": {
            "design": {"order": "latin-square", "within": True, "trials": 2},
            "blind": {},
            "questionnaires": [
                {
                    "name": "robot",
                    "title": "Robot",
                    "introduction": "",
                    "when": "trial",
                    "items": [],
                }
            ],
            "preflight": [{"check": "table", "ok": False}],
            "perception": {"hide": [], "blur": []},
            "shaping": None,
            "by_condition": {},
        }
    }, WelcomeSettings),
)  # fmt: skip


def stamped(timed: Iterable[tuple[float, m.Message]]) -> list[m.Message]:
    """Messages with the seconds at which they were published."""
    return [
        msgspec.structs.replace(
            message,
            seq=seq,
            t=round(at * SECOND),
            ts="" if codec.is_sample(message) else timestamp(BEGAN + timedelta(seconds=at)),
        )
        for seq, (at, message) in enumerate(timed)
    ]


class KeptSamples:
    """Samples in memory."""

    def __init__(self, samples: Sequence[m.Message], length_us: int = 0) -> None:
        self._samples = samples
        self.length_us = length_us

    def between(self, after_us: int, until_us: int) -> Iterable[m.Message]:
        return [each for each in self._samples if after_us < each.t <= until_us]

    def at(self, t_us: int) -> Iterable[m.Message]:
        last = {_name(each): each for each in self._samples if each.t <= t_us}
        return list(last.values())


def _name(sample: m.Message) -> str:
    return sample.sensor if isinstance(sample, m.Reading) else type(sample).__name__


def recording_of(messages: Sequence[m.Message]) -> Recording:
    """A recording of messages, samples apart from the rest."""
    lines = [message for message in messages if not codec.is_sample(message)]
    samples = [message for message in messages if codec.is_sample(message)]
    return Recording(
        lines, KeptSamples(samples, max((each.t for each in messages), default=0)), PLAN
    )


def played_action(run: str, action: str, at: float, took: float) -> list[tuple[float, m.Message]]:
    """An action from its press to its end."""
    command = f"c{run}"
    return [
        (at, m.ActionRequested(run=run, action=action, panel="Speech", source="key", key="h")),
        (
            at,
            m.Command(command=command, run=run, action=action, verb="say", args={}, source="key"),
        ),
        (at, m.Dispatched(command=command, driver="robot", latency_us=200)),
        (
            at + took,
            m.Done(command=command, driver="robot", sent={}, latency_us=200, duration_us=1),
        ),
        (at + took, m.ActionDone(run=run, action=action)),
    ]


def story() -> list[m.Message]:
    """A minute: two actions, a marker, a mistake, a stop, an idle stretch of 30 s, the end."""
    timed: list[tuple[float, m.Message]] = [
        (0, START),
        (0.1, m.DriverConnected(driver="robot", detail="simulated")),
        (0.2, PLAN),
        *played_action("a1", "Hello", 3, 2),
        (6, m.Marker(text="smile")),
        *played_action("a2", "Go", 8, 4),
        (13, m.Mistake(run="a2", action="Go", text="too late")),
        (15, m.StopPressed(source="key")),
        (15.5, m.StopConfirmed(confirmed=["robot"], missing=[], elapsed_us=500_000)),
        (18, m.StopReleased(source="key")),
        (50, m.Note(text="comes back")),
        (55, m.SessionChanged(trial=2)),
        (60, m.SessionEnd(reason="wizard", sha256="0" * 64)),
    ]
    timed += [(n * 0.5, m.reading("distance", 3 - n / 60, unit="m")) for n in range(1, 119)]
    timed += [(n * 10.0 + 0.01, m.ClockTie(wall="")) for n in range(6)]
    return stamped(sorted(timed, key=lambda pair: pair[0]))


def _words(event: EventLine) -> object:
    """An event; how a trial began is told by what is known of the study when it is read."""
    return (event.t, event.text) if event.text.startswith("Trial") else event


class Viewer:
    """A console's picture fed by a player, in a time that the test moves on."""

    def __init__(
        self, recording: Recording, start: ReplayStart | None = None, **options: Any
    ) -> None:
        self.player = ReplayPlayer(recording, start, **options)
        self.state = ConsoleState()
        self.now = 0
        self.messages: list[Incoming] = []
        self._take(self.player.begin(0))

    def wait(self, seconds: float, ticks: int = 1) -> None:
        """Let time pass, in so many ticks."""
        end = self.now + round(seconds * SECOND)
        for left in range(ticks, 0, -1):
            self.now += (end - self.now) // left
            self._take(self.player.tick(self.now))

    def ask(self, request: r.Request) -> r.Reply:
        """Ask and get the reply."""
        told = self.player.ask(msgspec.structs.replace(request, ref=5), self.now)
        self._take(told)
        (reply,) = (each for each in told if isinstance(each, r.Reply))
        assert reply.ref == 5
        return reply

    def do(self, what: Any, **fields: Any) -> r.Reply:
        """A request of the replay."""
        return self.ask(r.AskReplay(what=what, **fields))

    def go(self, seconds: float) -> None:
        """Seek to a time."""
        assert self.do("go", to=f"{seconds:.6f}").ok

    def _take(self, told: list[Incoming]) -> None:
        self.messages += told
        # As over a socket: what a console gets is what the wire's codec makes of it.
        decoded = [
            codec.decode_incoming(codec.encode(each)) if isinstance(each, msgspec.Struct) else each
            for each in told
        ]
        self.state.apply(decoded, self.now)

    def kinds(self) -> list[str]:
        """Kinds of the log's lines that came, samples left out; then forget everything."""
        found = [
            str(each.__struct_config__.tag)
            for each in self.messages
            if isinstance(each, m.Message) and not codec.is_sample(each)
        ]
        self.messages = []
        return found

    @property
    def visible_state(self) -> dict[str, object]:
        """What a wizard sees now."""
        return seen_by_wizard(self.state, self.now)


def seen_by_wizard(state: ConsoleState, local: int = 0) -> dict[str, object]:
    """Everything that is on the screen at a moment, as plain data."""
    session, study = state.session, state.session.study
    return {
        "participant": (study.participant, study.condition, study.number),
        "panels": state.panels,
        "features": [[*each.lines] for each in session.histories.values()],
        "locks": {panel: panel_locked.locked for panel, panel_locked in session.locks.items()},
        "drivers": state.drivers,
        "sensors": [state.sensor(name) for name in state.sensors],
        "stop": session.stop,
        "engagement": session.model.changed,
        "shown": session.model.shown,
        "modes": {driver: mode_changed.now for driver, mode_changed in session.modes.items()},
        "active": [(run, state.runs.get(run)) for run in state.runs.active],
        "outcomes": dict(state.runs.outcomes),
        "failures": [failure.run for failure in state.runs.failures],
        "recorder": session.recorder,
        "events": [_words(event) for event in state.events],
        "study": {
            name: getattr(study, name)
            for name in ("trial", "last_ended", "in_break", "planned", "order", "next_trial")
        },
        "questions": {name: getattr(state.study, name) for name in ("checks", "participants")},
        "asked": [shown(state) for shown in feature_examples("questionnaires", "SHOWN")],
        "model": (state.engaged.speaking(session.t), state.engaged.transcripts()),
        "changes": [*state.engaged.changes],
        "robots": session.robots.shown,
        "bodies": (session.bodies, session.faces, session.controls),
        "profile": [shown(state) for shown in feature_examples("profiles", "SHOWN")],
        "under way": state.moves(session.t),
        "ended": state.ended,
        "now": state.now(local),
    }


def distance(viewer: Viewer) -> SensorView:
    """The sensor of this name, as the wizard sees it."""
    sensor = viewer.state.sensor("distance")
    assert sensor is not None
    return sensor
