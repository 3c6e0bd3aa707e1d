"""The settings of a Reachy Mini in a robot file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated

from woz_drivers.programs.simulated_process import SIMULATED, robot_place
from woz_drivers.reachy_mini.moves import EMOTIONS, MOVES, data_set_and_name
from woz_drivers.speech.settings import PlayedTalkSettings, SynthesisSettings
from woz_tui.drivers.fields import Doc, Range, Section, Sibling
from woz_tui.drivers.robot_settings import RobotSetting, problem_at

#: Where the vendor's daemon listens unless it is told otherwise.
PORT = 8000
#: ALSA's name for its loudspeaker on the computer inside the wireless one; programs share it.
LOUDSPEAKER = "plug:reachymini_audio_sink"
MODES = ("normal", "tracking", "demo")
#: What can be shown and changed, by name.
SETTINGS = {
    row.name: row
    for row in (
        RobotSetting(
            *("Motors", "awake", "flag", "on: it holds its pose; off: it is limp"),
            *("torque", "on"),
            label="Motors",
        ),
        RobotSetting(
            *("Motors", "mode", "choice"),
            *("tracking: the head follows faces; demo: it shows its moves", "mode", "mode"),
            label="Mode",
            choices=MODES,
        ),
        RobotSetting(
            *("Voice", "volume", "number", "how loud its loudspeaker is, if it has one"),
            *("volume", "level"),
            label="Volume",
        ),
        RobotSetting(
            *("Voice", "wobble", "flag", "the head moves along with speech and sounds"),
            *("wobble", "on"),
            file="wobble",
            label="Wobbling",
        ),
    )
}
ADDRESS_EXAMPLES = f"write reachy-mini.local, 127.0.0.1:{PORT} or {SIMULATED}"


@dataclass(frozen=True, slots=True)
class ReachyMiniSettings(Section):
    """One Reachy Mini: where its daemon is, and what the driver does with it."""

    address: Annotated[
        str, Doc("the daemon's host or host:port, such as reachy-mini.local; or simulated")
    ] = SIMULATED
    follows: Annotated[
        str, Sibling(), Doc("driver of type body that moves it; empty: it moves as it is asked to")
    ] = ""
    twitches: Annotated[
        float,
        Range(0, 60, "/min"),
        Doc("how often the antennas twitch, as eyes blink, while it follows a body"),
    ] = 8.0
    voice: Annotated[
        SynthesisSettings, Doc("how its speech is made; the robot itself has no voice")
    ] = field(default_factory=SynthesisSettings)
    wobble: Annotated[bool, SETTINGS["wobble"].doc] = True
    face: Annotated[bool, Doc("have the daemon look for a face: presence, face.x, face.y")] = True
    direction: Annotated[bool, Doc("read the direction of sound, and whether it is speech")] = True
    release_media: Annotated[
        bool,
        Doc("have the daemon let go of camera and microphones, for drivers on its computer that"
            " see faces and hear speech instead of it"),
    ] = False  # fmt: skip
    talk: Annotated[
        PlayedTalkSettings | None,
        Doc("somebody can talk through its loudspeaker live, on the daemon's computer or with a"
            " `play` of yours: verbs `talk` and `end_talk`"),
    ] = None  # fmt: skip
    rate: Annotated[float, Range(1, 20, "Hz"), Doc("readings a second")] = 5.0
    recorded: Annotated[
        Mapping[str, str],
        Doc("recorded moves that `play` takes, too: {sway: dances/side_to_side_sway}"),
    ] = field(default_factory=dict)
    emotions: Annotated[
        Mapping[str, str],
        Doc("recorded moves in place of the driver's emotions: {happy: emotions/cheerful1}"),
    ] = field(default_factory=dict)
    libraries: Annotated[
        bool, Doc("ask the daemon at the start which recorded moves are installed")
    ] = True
    sleeps: Annotated[
        bool, Doc("left alone it lies down and its motors go off; else it stays as it is")
    ] = True
    pace: Annotated[
        float, Range(0.01, 100), Doc("of the simulated robot only: how fast its time passes")
    ] = 1.0

    def problems(self) -> list[tuple[str, str]]:
        """What no daemon can be reached with, by the setting's path."""
        found = [(f"voice.{path}", what) for path, what in self.voice.problems()]
        if self.talk is not None:
            found += self.talk.problems(LOUDSPEAKER)
        with problem_at("address", found):
            _ = self.place
        for path, moves in (("recorded", self.recorded), ("emotions", self.emotions)):
            for name, move in moves.items():
                if path == "emotions" and name not in EMOTIONS:
                    known = ", ".join(EMOTIONS)
                    found.append((f"emotions.{name}", f"there is no such emotion; {known}"))
                with problem_at(f"{path}.{name}", found):
                    data_set_and_name(move)
        return found

    @property
    def place(self) -> str:
        """`host:port` of the daemon; empty for the simulated one. Raises `RejectedError`."""
        return robot_place(self.address, PORT, ADDRESS_EXAMPLES)

    @property
    def playable(self) -> tuple[str, ...]:
        """Everything that `play` takes."""
        return tuple(sorted({*MOVES, *self.recorded}))

    @property
    def looks(self) -> bool:
        """Whether the daemon is to look for a face."""
        return self.face and not self.release_media

    @property
    def hears_speech(self) -> bool:
        """Whether it is told when somebody speaks."""
        return self.direction and not self.release_media
