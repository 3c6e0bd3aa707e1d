"""A museum guide's session, for tests and for the pictures in the documentation."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec

from tests.console.scripted_feed import raw
from tests.protocol.feature_examples import feature_examples
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.panels import ActionView, PanelView
from woz_tui.protocol.welcome import WelcomeSettings

Ended = m.ActionDone | m.ActionFailed | m.ActionStopped | m.ActionRefused

SECOND = 1_000_000
MINUTE = 60 * SECOND
#: The moment all scenes show.
NOW = 12 * MINUTE + 31 * SECOND

OVERLOADED = "head: servo 2 (pitch) overloaded"

_SPEECH = (
    ("h", "Hello", "Hello {participant}, nice to see you."),
    ("w", "Welcome", "Welcome to the museum!"),
    ("m", "Map", "Please look at the map."),
    ("q", "Question", "Do you have a question?"),
    ("y", "Yes", "Yes, that is right."),
    ("n", "No", "No, I am afraid not."),
    ("r", "Repeat", "Could you say that again, please?"),
    ("b", "Goodbye", "Goodbye, and thank you for coming."),
)
_GESTURES = (
    ("1", "Nod"),
    ("2", "Shake head"),
    ("3", "Point left"),
    ("4", "Point right"),
    ("5", "Wave"),
    ("6", "Bow"),
)
_EMOTIONS = (
    ("f1", "Happy"),
    ("f2", "Sad"),
    ("f3", "Surprised"),
    ("f4", "Thinking"),
    ("f5", "Neutral"),
)
_EXHIBITS = (
    ("a", "Roman glass"),
    ("s", "Bronze helmet"),
    ("d", "Amphora"),
    ("f", "Mosaic floor"),
    ("g", "Coin hoard"),
    ("c r", "Restoration room"),
)
_REPAIR = (
    ("t", "Moment, please"),
    ("u", "Did not understand"),
    ("i", "Let us go on"),
    ("ctrl+1", "Call staff"),
    ("p", "Pause"),
)


def panels() -> list[PanelView]:
    """Five panels with thirty actions."""

    def simple(pairs: tuple[tuple[str, str], ...], *verbs: str) -> list[ActionView]:
        return [
            ActionView(name=label, label=label, key=key, verbs=list(verbs)) for key, label in pairs
        ]

    speech = [
        ActionView(name=label, label=label, key=key, verbs=["say"], utterances=[text])
        for key, label, text in _SPEECH
    ]
    return [
        PanelView(title="Speech", actions=speech),
        PanelView(title="Gestures", actions=simple(_GESTURES, "play")),
        PanelView(title="Emotion", actions=simple(_EMOTIONS, "emotion")),
        PanelView(title="Exhibits", actions=simple(_EXHIBITS, "say", "play")),
        PanelView(title="Repair", actions=simple(_REPAIR, "say")),
    ]


def many_panels(count: int) -> list[PanelView]:
    """`count` actions in panels of ten."""
    actions = [
        ActionView(name=f"action {n}", label=f"Action {n}", verbs=["play"]) for n in range(count)
    ]
    return [
        PanelView(title=f"Panel {start // 10}", actions=actions[start : start + 10])
        for start in range(0, count, 10)
    ]


def welcome(
    state: Sequence[m.Message] | None = None,
    recent: Sequence[m.Message] | None = None,
    *,
    shown: list[PanelView] | None = None,
    role: str = "wizard",
    t: int = NOW,
    settings: dict[str, m.Json] | None = None,
) -> r.Welcome:
    """The first message of a session with three drivers, two conditions and a script."""
    state, recent = healthy() if state is None else state, recent or []
    order = sorted((*state, *recent), key=lambda message: message.t)
    numbers = {id(message): number for number, message in enumerate(order)}

    def lines(messages: Sequence[m.Message]) -> list[msgspec.Raw]:
        """Numbered as the hub does, by their times."""
        numbered = [
            each if each.seq >= 0 else msgspec.structs.replace(each, seq=numbers[id(each)])
            for each in messages
        ]
        return raw(sorted(numbered, key=lambda each: each.seq))

    return r.Welcome(
        protocol=r.PROTOCOL,
        console="console1",
        role=role,
        seq=100,
        t=t,
        title="Museum guide",
        log="recordings/20260301-100000-P07-S01.jsonl",
        panels=panels() if shown is None else shown,
        script=["Hello", "Welcome", "Map", "Roman glass", "Bronze helmet", "Goodbye"],
        verbs={
            "head": ["play", "home", "gaze", "pose"],
            "voice": ["say", "volume"],
            "face": ["emotion", "eyes"],
        },
        variables=["condition", "participant", "session"],
        conditions=["warm", "cold"],
        keyboard="us",
        drivers=["head", "voice", "face", "range", "microphone"],
        state=lines(state),
        recent=lines(recent),
        settings=msgspec.convert(
            {"participant_pattern": "P\\d\\d", **(settings or {})}, WelcomeSettings
        ),
    )


def start(participant: str = "P07", condition: str = "warm") -> m.SessionStart:
    """The first line of the log."""
    return m.SessionStart(
        t=0,
        session="S01",
        participant=participant,
        condition=condition,
        wizard="W2",
        software={"name": "woz-tui"},
        experiment="guide.yaml",
        experiment_sha256="0" * 64,
        seed=7,
        clock={"source": "monotonic"},
    )


def healthy() -> list[m.Message]:
    """What holds when all is well."""
    return [
        start(),
        m.SessionChanged(trial=3, t=MINUTE),
        m.RecorderState(level="ok", lag_us=4_200, path="recordings/S01.jsonl", t=MINUTE),
        m.DriverConnected(driver="head", detail="3 servos XL330 on ttyUSB0", t=SECOND),
        m.DriverConnected(driver="voice", detail="espeak-ng 1.51", t=SECOND),
        m.DriverConnected(driver="face", detail="8x8 LED", t=SECOND),
        m.DriverConnected(driver="range", detail="TFmini on ttyACM0", t=SECOND),
        m.DriverConnected(driver="microphone", detail="16 kHz mono", t=SECOND),
        *feature_examples("scripts", "SCENE"),
    ]


def sensors(t: int = NOW) -> list[m.Message]:
    """One reading of each sensor."""
    return [
        reading(t, "distance", 0.84, driver="range", unit="m"),
        reading(t, "loudness", 0.028, driver="microphone"),
        reading(t, "loudness.threshold", 0.012, driver="microphone"),
        m.SensorChanged(sensor="loudness", state="speaking", was="quiet", t=t - SECOND),
        reading(t, "presence", 1.0),
        reading(t, "gaze", 1.0),
        reading(t, "identity", None, text="visitor 12"),
        *pose(t),
    ]


def pose(t: int = NOW) -> list[m.Message]:
    """Three joints, one of them on its way."""
    messages: list[m.Message] = []
    for name, present, wanted in (("yaw", 14.0, 30.0), ("pitch", -6.0, -6.0), ("roll", 2.0, 0.0)):
        messages.append(reading(t, f"joint.head.{name}", present, driver="head", unit="deg"))
        messages.append(reading(t, f"setpoint.head.{name}", wanted, driver="head", unit="deg"))
    return messages


def reading(
    t: int, sensor: str, value: float | None, *, text: str = "", driver: str = "", unit: str = ""
) -> m.Reading:
    """A reading with a time."""
    made = m.reading(sensor, value, text=text, driver=driver, unit=unit)
    return msgspec.structs.replace(made, t=t)


def played_action(
    run: str, action: str, t: int, took: float | None, *, how: str = "done", reason: str = ""
) -> list[m.Message]:
    """One run: requested, dispatched, and after `took` seconds its end; None: still running."""
    messages: list[m.Message] = [
        m.ActionRequested(run=run, action=action, source="key", t=t),
        m.Command(
            command=f"c-{run}", run=run, action=action, verb="say", args={}, source="key", t=t
        ),
        m.Dispatched(command=f"c-{run}", driver="voice", latency_us=400, t=t + 400),
    ]
    if took is None:
        return messages
    end = t + round(took * SECOND)
    kinds: dict[str, type[Ended]] = {
        "done": m.ActionDone,
        "failed": m.ActionFailed,
        "stopped": m.ActionStopped,
        "refused": m.ActionRefused,
    }
    messages.append(kinds[how](run=run, action=action, reason=reason, t=end))
    return messages


def actions_filled(action: str, text: str) -> m.ActionsFilled:
    """What an action would say now."""
    return m.ActionsFilled(actions={action: [[m.FilledCall(verb="say", args={"text": text})]]})


def history() -> list[m.Message]:
    """The last minutes."""
    return [
        m.ConsoleAttached(console="console1", role="wizard", t=9 * MINUTE),
        *played_action("a1", "Hello", NOW - 115 * SECOND, 2.4),
        *played_action("a2", "Happy", NOW - 111 * SECOND, 0.1),
        *played_action("a3", "Welcome", NOW - 96 * SECOND, 1.9),
        m.EngagementChanged(
            was="PersonDetected",
            now="EngagedWithKnown",
            outcome="recognized",
            why="visitor 12 looks at the robot from 0.9 m",
            verdicts={"presence": True, "gaze": True, "distance": True, "id": "visitor 12"},
            t=NOW - 90 * SECOND,
        ),
        *played_action("a4", "Point left", NOW - 71 * SECOND, 1.2),
        *played_action("a5", "Bow", NOW - 52 * SECOND, 0.8, how="failed", reason=OVERLOADED),
        m.Note(text="hesitates before the map", t=NOW - 40 * SECOND),
        *played_action("a6", "Question", NOW - 31 * SECOND, 1.7),
        m.Mistake(run="a6", action="Question", t=NOW - 28 * SECOND),
        m.Marker(t=NOW - 20 * SECOND),
        *played_action("a7", "Nod", NOW - 9 * SECOND, 1.1),
    ]


def speaking(left: float = 2.1, whole: float = 3.6) -> list[m.Message]:
    """An utterance in the middle, and one that waits behind it."""
    begun = NOW - round((whole - left) * SECOND)
    return [
        *played_action("a8", "Map", begun, None),
        m.Progress(command="c-a8", driver="voice", expected_us=round(whole * SECOND), t=begun),
        m.ActionRequested(run="a9", action="Question", source="key", t=NOW - SECOND // 2),
        m.Command(
            command="c-a9", run="a9", action="Question", verb="say", args={}, source="key", t=NOW
        ),
    ]
