"""What the console shows of a Pepper and may change: its settings, animations, tags, robots."""

from __future__ import annotations

from woz_drivers.pepper import tags
from woz_drivers.pepper.address import SIMULATED
from woz_drivers.pepper.animations_known import MOVES
from woz_drivers.pepper.autonomy_settings import FLAGS
from woz_drivers.pepper.settings import ENGAGEMENT_MODES, STATES, PepperSettings
from woz_tui.core.messages import Json
from woz_tui.core.robots import RobotOutline, Setting

#: Postures that a Pepper takes by `goToPosture`.
POSTURES = ["Stand", "StandInit", "StandZero", "Crouch"]


def outline(settings: PepperSettings) -> dict[str, Json]:
    """As the driver tells it."""
    return RobotOutline(
        settings=lines(settings),
        robots=list(dict.fromkeys((*settings.robots, SIMULATED))),
        moves=list(MOVES),
        tags=tags.offered(),
        camera=True,
    ).told()


def lines(settings: PepperSettings) -> list[Setting]:
    """All settings, section by section, each with the verb that changes it."""
    return [
        *_robot(settings),
        *_autonomy(),
        *_safety(),
        *_voice(),
        *_eyes(),
        *_tablet(),
    ]


def _robot(settings: PepperSettings) -> list[Setting]:
    section = "Robot"
    return [
        Setting(
            name="robot",
            section=section,
            label="robot",
            verb="connect",
            argument="robot",
            kind="choice",
            choices=list(dict.fromkeys((*settings.robots, SIMULATED))),
            help="which robot is played; any other address can be typed",
        ),
        Setting(
            name="awake",
            section=section,
            label="motors",
            verb="torque",
            argument="on",
            kind="flag",
            help="on: it stands and moves; off: it rests",
        ),
        Setting(
            name="posture",
            section=section,
            label="posture",
            verb="posture",
            argument="name",
            kind="choice",
            choices=POSTURES,
        ),
        Setting(name="battery", section=section, label="battery", kind="number"),
    ]


def _autonomy() -> list[Setting]:
    section, verb = "Autonomy", "autonomy"
    switches = [
        Setting(
            name=name,
            section=section,
            label=name.replace("_", " "),
            verb=verb,
            argument=name,
            kind="flag",
            help=what,
        )
        for name, what in FLAGS.items()
    ]
    state = Setting(
        name="state",
        section=section,
        label="autonomous life",
        verb=verb,
        argument="state",
        kind="choice",
        choices=[state for state in STATES if state],
        help="solitary and interactive: it does things by itself; disabled: only what you ask for",
    )
    engagement = Setting(
        name="engagement",
        section=section,
        label="engagement",
        verb=verb,
        argument="engagement",
        kind="choice",
        choices=[mode for mode in ENGAGEMENT_MODES if mode],
        help="how steadfast awareness is with the one whom it has noticed",
    )
    return [state, switches[0], engagement, *switches[1:]]


def _safety() -> list[Setting]:
    return [
        Setting(
            name=name,
            section="Safety",
            label=f"{name} distance",
            verb="collision",
            argument=name,
            kind="number",
            low=0.0,
            high=5.0,
            step=0.05,
            unit="m",
            help=what,
        )
        for name, what in (
            ("tangential", "kept from what it drives along"),
            ("orthogonal", "kept from what it drives towards"),
        )
    ]


def _voice() -> list[Setting]:
    section = "Voice"

    def number(name: str, argument: str, high: float, step: float, **more: object) -> Setting:
        return Setting(
            name=name,
            section=section,
            label=name.replace("_", " "),
            verb=name,
            argument=argument,
            kind="number",
            high=high,
            step=step,
            **more,  # type: ignore[arg-type]
        )

    return [
        number("volume", "level", 1.0, 0.05),
        number("speech_speed", "percent", 400.0, 5.0, low=50.0, unit="%", help="100 is normal"),
        number("speech_pitch", "pitch", 4.0, 0.1, help="0: its own voice; 1 to 4 times that"),
    ]


def _eyes() -> list[Setting]:
    return [
        Setting(
            name="eyes", section="Eyes", label="eyes", verb="eyes", argument="color", kind="color"
        ),
        Setting(
            name="eyes_brightness",
            section="Eyes",
            label="brightness",
            verb="eyes_brightness",
            argument="level",
            kind="number",
            step=0.1,
        ),
    ]


def _tablet() -> list[Setting]:
    section = "Tablet"
    return [
        Setting(
            name="tablet",
            section=section,
            label="shows",
            verb="screen",
            argument="file",
            help="a file, an address, or off: the default again",
        ),
        Setting(name="sound", section=section, label="sound", help="the sound file being played"),
        Setting(name="microphones", section=section, label="microphones"),
    ]
