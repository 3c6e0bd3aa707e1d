"""A robot with a body, a face and a MIDI panel, as the console hears of it."""

from __future__ import annotations

import msgspec

from tests.console import scenes
from woz_tui.motion.light_frames import LightFrame
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r

NOW = scenes.NOW
LIGHTS = (24, 16)

#: EyePi: its first joint turns about the vertical, the others lean and nod.
EYEPI: dict[str, m.Json] = {
    "kind": "body",
    "joints": [
        {"name": "pitch", "axis": "z", "offset": [0.02, 0.0, 0.04],
         "min": -90.0, "max": 90.0, "home": 0.0},
        {"name": "middle", "axis": "-y", "offset": [0.02, 0.0, 0.03],
         "min": 0.0, "max": 90.0, "home": 72.0},
        {"name": "top", "axis": "y", "offset": [0.08, 0.0, 0.0],
         "min": 0.0, "max": 90.0, "home": 63.0},
    ],
    "eyes": [0.03, 0.0, 0.02],
    "view": "x",
    "face": {"width": 24, "height": 16},
}  # fmt: skip
_LABELS = {
    **{f"knob-{n}": label for n, label in ((1, "pitch"), (2, "tempo"), (3, "smoothing"),
                                           (4, "compression"), (8, "eye-x"))},
    **{f"slider-{n}": label for n, label in ((1, "middle"), (2, "top"), (3, "zoom"),
                                             (5, "arousal"), (6, "valence"), (7, "intensity"))},
    **{f"button-{n}": label for n, label in (
        (3, "nod"), (11, "shake"), (19, "dance"), (4, "normal"), (12, "normal"), (20, "normal"),
        (5, "demo"), (13, "tracking"), (21, "saccade"), (22, "crash"), (7, "neutral"),
        (15, "sleepy"), (23, "sad"), (8, "happy"), (16, "amazed"), (24, "angry"))},
    "stop": "stop", "cycle": "release", "play": "script", "record": "mark",
}  # fmt: skip
_LEFT = {"cycle": (1, 2), "marker-set": (1, 3), "stop": (3, 4), "play": (1, 5), "record": (2, 5)}


def panel() -> dict[str, m.Json]:
    """A panel of eight strips: knob, three buttons, slider; keys at the left."""
    rows = (("knob", 1, 1), ("button", 1, 2), ("button", 9, 3), ("button", 17, 4), ("slider", 1, 5))
    controls: list[m.Json] = []
    for kind, first, row in rows:
        for index in range(8):
            name = f"{kind}-{first + index}"
            controls.append(
                {"name": name, "kind": kind, "column": 4 + index, "row": row,
                 "label": _LABELS.get(name, "")}
            )  # fmt: skip
    for name, (column, row) in _LEFT.items():
        label = _LABELS.get(name, "")
        controls.append(
            {"name": name, "kind": "button", "column": column, "row": row, "label": label}
        )
    return {"kind": "panel", "name": "Oosterkamp's appendix A", "controls": controls}


def discs(x: int = 0, *, height: int = 16) -> LightFrame:
    """Two round eyes, `x` lights beside their middle."""
    rows = []
    for y in range(height):
        lights = ""
        for column in range(24):
            near = min((column - x - middle) ** 2 + (y - 7) ** 2 for middle in (6, 17))
            lights += "1" if near <= 9 else "0"
        rows.append(int(lights, 2))
    return LightFrame(24, tuple(rows))


def face(
    frame: LightFrame | None = None, driver: str = "body", brightness: float = 1.0
) -> m.FaceShown:
    """A face with eyes."""
    frame = frame or discs()
    return m.FaceShown(
        driver=driver,
        width=frame.width,
        rows=frame.hex,
        emotion="happy",
        intensity=0.8,
        brightness=brightness,
        t=NOW,
    )


def body_changed(driver: str = "body", **values: m.Json) -> m.BodyChanged:
    """What a body tells of itself."""
    told: dict[str, m.Json] = {
        "mode": "normal",
        "move": "",
        "emotion": "happy",
        "intensity": 0.8,
        "valence": 0.6,
        "arousal": 0.2,
        "personality": "upbeat",
        "tempo": 2.13,
        "breathing_rate": 0.53,
        "blink_rate": 12.0,
        "smoothing": 0.0,
        "compression": 0.25,
    }
    return m.BodyChanged(driver=driver, values={**told, **values}, t=NOW)


def joints(
    reached: dict[str, float] | None, wanted: dict[str, float], robot: str = "", t: int = NOW
) -> list[m.Message]:
    """Where the joints are, and where they shall be."""
    told: list[m.Message] = []
    for kind, angles in (("joint", reached or {}), ("setpoint", wanted)):
        for name, value in angles.items():
            sensor = f"{robot}{kind}.{name}"
            told.append(scenes.reading(t, sensor, value, driver=f"{robot}body", unit="deg"))
    return told


def alive(robot: str = "", **values: m.Json) -> list[m.Message]:
    """A body in the middle of a move: the reached pose behind the one that is wanted."""
    driver = f"{robot}body"
    return [
        m.DriverConnected(driver=driver, detail="EyePi", t=scenes.SECOND),
        face(driver=driver),
        body_changed(driver, **values),
        *joints(
            {"pitch": 20.0, "middle": 60.0, "top": 50.0},
            {"pitch": 35.0, "middle": 72.0, "top": 40.0},
            robot,
        ),
    ]


def controls_moved(
    values: dict[str, int], waiting: dict[str, int] | None = None, lit: tuple[str, ...] = ()
) -> m.ControlsMoved:
    """Knobs of the panel."""
    targets = waiting or {}
    return m.ControlsMoved(
        driver="panel", values=values, waiting=list(targets), targets=targets, lit=list(lit), t=NOW
    )


def welcome(
    state: list[m.Message] | None = None, robots: tuple[str, ...] = ("",), *, knobs: bool = True
) -> r.Welcome:
    """A session whose robots have bodies; the first one's panel."""
    outlines: dict[str, m.Json] = {f"{robot}body": EYEPI for robot in robots}
    if knobs:
        outlines["panel"] = panel()
    made = scenes.welcome(
        state=[*scenes.healthy(), *(state or [])],
        recent=scenes.history(),
        settings={"outlines": outlines},
    )
    bodies = [f"{robot}body" for robot in robots]
    return msgspec.structs.replace(made, drivers=[*bodies, *(["panel"] if knobs else []), "voice"])
