"""What robots show of the engagement model, and the pictures it is shown with."""

from __future__ import annotations

import io
import wave
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import pytest
from PIL import Image, ImageChops, ImageSequence

from tests.session.rig import HERE, NoSettings, action, call, experiment, together
from tools import signal_pictures
from woz_tui.config.engagement import EngagementSettings
from woz_tui.config.engagement_words import STATES
from woz_tui.config.experiment import DriverSpec, Engagement, Experiment
from woz_tui.drivers.bundled_media import FOLDER, located
from woz_tui.drivers.contract import Argument, Offer, Verb
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json
from woz_tui.session.state_signals import (
    NEARLY,
    SIGNALS,
    StateSignals,
    default_signals,
    nearly,
)

FILE = Argument("file", "file", required=True)
EYES = Verb("eyes", "", (Argument("color", "text", required=True), Argument("animation", "choice")))
SCREEN, SOUND = Verb("screen", "", (FILE,)), Verb("sound", "", (FILE,))
SIGNS = ("presence", "gaze", "distance")


def make_experiment(
    tmp_path: Path, robots: Mapping[str, tuple[Verb, ...]], engagement: Engagement | None = None
) -> Experiment:
    drivers = tuple(
        DriverSpec(name, "t", NoSettings(), Offer(verbs=verbs), HERE)
        for name, verbs in robots.items()
    )
    return replace(experiment(tmp_path), drivers=drivers, engagement=engagement or Engagement())


def shown_signals(experiment: Experiment, situation: str) -> list[tuple[str, str, Json]]:
    """Driver, verb, main argument; files by their own names."""
    return [
        (one.driver, one.verb, str(next(iter(one.args.values()))).removeprefix("woz:"))
        for one in default_signals(experiment)[situation]
    ]


@pytest.mark.parametrize(
    ("state", "eyes", "screen"),
    [
        ("Wait", "off", "waiting.gif"),
        ("PersonDetected", "white", "detected.gif"),
        ("EngagedWithUnknown", "green", "microphone.gif"),
        ("EngagedWithKnown", "green", "microphone.gif"),
        ("UserSpeaks", "green", "recording.gif"),
        ("RobotThinks", "white", "thinking.gif"),
        ("RobotReplies", "blue", "talking.gif"),
        ("RobotSpeaks", "blue", "talking.gif"),
    ],
)
def test_every_state_has_its_eyes_and_its_picture(
    tmp_path: Path, state: str, eyes: str, screen: str
) -> None:
    """E6: what each state shows."""
    one = make_experiment(tmp_path, {"robot": (EYES, SCREEN)})
    assert shown_signals(one, state) == [("robot", "eyes", eyes), ("robot", "screen", screen)]


def test_only_the_end_of_an_utterance_beeps(tmp_path: Path) -> None:
    """E6: the beep belongs to one state, which every utterance enters once."""
    one = make_experiment(tmp_path, {"robot": (SOUND,)})
    assert set(SIGNALS) == {*STATES, NEARLY, "stop"}
    assert {name for name in SIGNALS if shown_signals(one, name)} == {"RobotThinks"}


def test_every_robot_shows_what_it_can(tmp_path: Path) -> None:
    silent = Verb("say", "", (Argument("text", "text"),))
    plain = Verb("eyes", "", (Argument("color", "text"),))
    picky = Verb("eyes", "", (Argument("color", "choice", choices=("red", "green")),))
    odd = Verb("screen", "", (FILE, Argument("page", "whole", required=True)))
    robots = {"left.face": (EYES,), "right": (plain, SOUND), "third": (picky, odd), "x": (silent,)}
    one = make_experiment(tmp_path, robots)
    calls = default_signals(one)["RobotThinks"]
    assert [(each.driver, dict(each.args)) for each in calls] == [
        ("left.face", {"color": "white", "animation": "blink"}),
        ("right", {"color": "white"}),
        ("right", {"file": "woz:beep.wav"}),
    ]
    assert ("third", "eyes", "green") in shown_signals(one, "UserSpeaks")


def test_files_are_found_from_the_experiments_folder_also_through_links(tmp_path: Path) -> None:
    (tmp_path / "deep" / "er").mkdir(parents=True)
    (tmp_path / "link").symlink_to(tmp_path / "deep" / "er")
    for folder in (tmp_path, tmp_path / "link"):
        one = replace(
            make_experiment(folder, {"robot": (SCREEN, SOUND)}), path=folder / "made.yaml"
        )
        calls = [each for calls in default_signals(one).values() for each in calls]
        assert calls
        for each in calls:
            assert str(each.args["file"]).startswith("woz:")
            given = str(located(SCREEN, each.args, folder)["file"])
            assert not Path(given).is_absolute()
            assert (folder / given).is_file()


@pytest.mark.parametrize(
    ("verb", "source", "run", "passing"),
    [
        ("eyes", "engagement", "", True),
        ("sound", "engagement", "", True),
        ("say", "engagement", "", False),
        ("eyes", "engagement", "a00001", False),
        ("eyes", "key", "", False),
    ],
)
def test_signals_are_worth_no_line_of_their_own(
    verb: str, source: str, run: str, passing: bool
) -> None:
    command = m.Command(command="c1", run=run, verb=verb, args={}, source=source)
    assert command.passing is passing


def test_what_the_experiment_says_takes_the_place_of_the_default(tmp_path: Path) -> None:
    effect = action("on RobotThinks", together(call("eyes", "left", color="red")))
    one = make_experiment(tmp_path, {"left": (EYES, SCREEN, SOUND), "right": (EYES,)})
    one = replace(
        one,
        engagement=Engagement(effects={"RobotThinks": effect}, plays={"UserSpeaks": ("Welcome",)}),
    )
    assert shown_signals(one, "RobotThinks") == [
        ("right", "eyes", "white"),
        ("left", "screen", "thinking.gif"),
        ("left", "sound", "beep.wav"),
    ]
    assert len(shown_signals(one, "UserSpeaks")) == 3
    screen = replace(
        one.panels[0].actions[0], name="Show", steps=(together(call("screen", "left", file="a")),)
    )
    panels = (replace(one.panels[0], actions=(screen,)),)
    one = replace(one, panels=panels, engagement=Engagement(plays={"UserSpeaks": ("Show",)}))
    assert shown_signals(one, "UserSpeaks") == [
        ("left", "eyes", "green"),
        ("right", "eyes", "green"),
    ]


def test_they_can_be_switched_off(tmp_path: Path) -> None:
    off = Engagement(EngagementSettings(signals="none"))
    assert default_signals(make_experiment(tmp_path, {"robot": (EYES,)}, off)) == {}
    assert default_signals(experiment(tmp_path)) == {}


@pytest.mark.parametrize(
    ("verdicts", "uses", "is_so"),
    [
        ({"presence": 1, "gaze": 1, "distance": 0}, SIGNS, True),
        ({"presence": 1, "gaze": 1, "distance": 1}, SIGNS, False),
        ({"presence": 1, "gaze": 0, "distance": 0}, SIGNS, False),
        ({"presence": 1, "gaze": None, "distance": 0}, SIGNS, False),
        ({"presence": 1, "gaze": 1, "distance": None}, SIGNS, False),
        ({"presence": 1, "gaze": 0, "distance": 0}, ("presence", "distance"), True),
        ({"presence": 1, "gaze": 1, "distance": 0}, ("presence", "gaze"), False),
        ({"presence": 0, "gaze": 1, "distance": 0}, ("gaze", "distance"), False),
    ],
)
def test_nearly_engaged(verdicts: dict[str, Json], uses: tuple[str, ...], is_so: bool) -> None:
    assert nearly(verdicts, uses) is is_so


def test_who_is_nearly_engaged_sees_green_come_and_go_until_they_are_not(tmp_path: Path) -> None:
    """E6: intermittent green while all conditions hold but the distance."""
    signals = StateSignals(make_experiment(tmp_path, {"robot": (EYES, SCREEN)}))
    assert signals.nearly_engaged(True) == ()  # nothing was entered yet
    assert [one.verb for one in signals.entered("PersonDetected")] == ["eyes", "screen"]
    [green] = signals.nearly_engaged(True)
    assert green.args == {"color": "green", "animation": "intermittent"}
    assert signals.nearly_engaged(True) == ()
    [white] = signals.nearly_engaged(False)
    assert (white.verb, white.args["color"]) == ("eyes", "white")
    signals.nearly_engaged(True)
    assert len(signals.entered("EngagedWithKnown")) == 2
    assert signals.nearly_engaged(True) == ()


# -- pictures and sound ---------------------------------------------------------------------------


@pytest.mark.parametrize("name", signal_pictures.PICTURES)
def test_the_pictures_are_as_they_are_drawn(name: str) -> None:
    drawn = [
        frame.convert("RGB") for frame in signal_pictures.frames(signal_pictures.PICTURES[name])
    ]
    with Image.open(FOLDER / f"{name}.gif") as kept:
        assert (kept.size, kept.info["loop"]) == ((800, 480), 0)
        lasts = 0
        for moment in ImageSequence.Iterator(kept):
            assert any(
                ImageChops.difference(moment.convert("RGB"), frame).getbbox() is None
                for frame in drawn
            )
            lasts += moment.info["duration"]
    assert 800 <= lasts <= 2500


def test_the_beep_is_short_soft_and_as_it_is_computed() -> None:
    with wave.open(str(FOLDER / "beep.wav")) as sound:
        assert sound.getnchannels() == 1
        assert sound.getnframes() / sound.getframerate() < 0.33
        samples = sound.readframes(sound.getnframes())
    assert samples == signal_pictures.beep()
    loudest = max(abs(value) for value in memoryview(samples).cast("h"))
    assert 2_000 < loudest < 10_000


def test_everything_that_is_shown_is_there_and_small() -> None:
    files = {name for one in SIGNALS.values() for name in (one.screen, one.sound) if name}
    data = {path.name for path in FOLDER.iterdir() if path.suffix in (".gif", ".wav")}
    assert files == data
    assert sum((FOLDER / name).stat().st_size for name in files) < 200_000


def test_two_drawings_are_the_same(tmp_path: Path) -> None:
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        signal_pictures.draw("microphone", tmp_path / folder)
    first = (tmp_path / "a" / "microphone.gif").read_bytes()
    assert first == (tmp_path / "b" / "microphone.gif").read_bytes()
    assert Image.open(io.BytesIO(first)).format == "GIF"
