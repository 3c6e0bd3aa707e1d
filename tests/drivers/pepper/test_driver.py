"""The driver as a whole: contract, the line to the robot, settings after a loss, any call."""

from __future__ import annotations

import asyncio
import contextlib
from pathlib import Path

import pytest
from woz_drivers.naoqi_robot.settings import AutonomySettings, VoiceSettings
from woz_drivers.pepper import Pepper
from woz_drivers.pepper.model import PEPPER
from woz_drivers.pepper.settings import PepperSettings

from tests.drivers.pepper.robot_rig import QUIET, connected_driver, connected_robot
from tests.drivers.published_messages import PATIENCE_S, BusJob, PublishedMessages
from tests.fakes.naoqi import stand_in, stand_in_here
from woz_tui.bus.bus import Bus
from woz_tui.bus.hub import Hub
from woz_tui.drivers.contract import DeviceLostError, DriverError, RejectedError
from woz_tui.drivers.plugins import installed
from woz_tui.protocol.messages import (
    Command,
    Done,
    DriverConnected,
    DriverLost,
    End,
    Failed,
    Json,
    SettingsShown,
)
from woz_tui.protocol.robot_outline import RobotOutline

#: Every verb of the driver; a robot file and an experiment rely on these names.
VERBS = {
    *("say", "read", "volume", "speech_speed", "speech_pitch", "play", "posture", "pose", "home"),
    *("torque", "gaze", "nudge", "hip", "drive", "eyes", "eyes_animation", "eyes_brightness"),
    *(
        "sound",
        "utter",
        "screen",
        "tablet",
        "autonomy",
        "collision",
        "picture",
        "record_sound",
        "listen",
    ),
    *("learn_face", "face_consent", "track", "connect", "disconnect", "naoqi"),
    "naoqi_drive",
}


def test_verbs_lanes_joints_and_sensors_are_those_that_files_rely_on() -> None:
    settings = PepperSettings(robots=())
    verbs = {verb.name: verb for verb in Pepper.offer(settings).verbs}
    assert set(verbs) == VERBS
    assert verbs["gaze"].stream
    assert [name for name, verb in verbs.items() if verb.drives] == [
        "drive",
        "track",
        "naoqi_drive",
    ]
    assert {verbs[name].lane for name in ("play", "posture", "pose", "home", "torque")} == {"body"}
    joints = Pepper.offer(settings).joints or {}
    assert joints["HeadPitch"].low == -40.5
    assert {"distance", "loudness", "presence", "gaze", "battery", "touch.x"} <= set(
        Pepper.offer(settings).sensors
    )


def test_every_setting_is_changed_by_a_verb_that_takes_it() -> None:
    settings = PepperSettings(robots=("simulated",))
    verbs = {verb.name: verb for verb in Pepper.offer(settings).verbs}
    told = RobotOutline.read(Pepper.offer(settings).outline)
    assert told is not None
    for line in told.settings:
        if line.verb:
            arguments = {one.name: one for one in verbs[line.verb].arguments}
            assert line.argument in arguments, line.name
            assert not set(line.choices) - set(arguments[line.argument].choices or line.choices)


def test_it_is_found_by_the_name_that_files_use() -> None:
    assert installed()["pepper"] is Pepper


# -- the line ------------------------------------------------------------------------------------


async def test_the_wizard_takes_another_robot_and_lets_it_go(tmp_path: Path) -> None:
    async with stand_in() as other, connected_robot(tmp_path) as rig:
        sent = await rig.do("connect", robot=other.address)
        assert sent["robot"] == other.address.removeprefix("tcp://")
        await rig.do("say", text="Here I am.")
        assert await other.trace("ALAnimatedSpeech.say")
        assert await rig.calls("ALAnimatedSpeech.say") == []
        assert await rig.do("disconnect") == {"robot": sent["robot"]}
        await rig.tells(lambda settings_shown: "volume" not in settings_shown.values)
        with pytest.raises(DeviceLostError, match="disconnected by the wizard"):
            await rig.do("say", text="Nobody hears this.")


@pytest.mark.usefixtures("unhurried_stop")
async def test_a_robot_is_not_left_driving_or_speaking(tmp_path: Path) -> None:
    async with connected_robot(tmp_path, pace=2) as rig:
        driving = rig.begin("drive", x=5.0)
        saying = rig.begin("say", text="A long story. " * 100)
        await rig.robot.called("ALMotion.moveTo")
        await rig.robot.called("ALAnimatedSpeech.say")
        await rig.do("disconnect")
        for job in (driving, saying):
            with contextlib.suppress(DriverError):
                await job
        assert not any(await rig.robot.get("velocity"))
        assert "speech" not in [kind for kind, *_ in await rig.robot.get("going")]


async def test_what_the_end_of_the_session_cuts_short_ends_on_the_robot(tmp_path: Path) -> None:
    async with connected_robot(tmp_path, pace=2) as rig:
        job = rig.begin("drive", x=5.0)
        await rig.robot.called("ALMotion.moveTo")
        await rig.cancel(job)
        await rig.driver.close()
        await rig.robot.called("ALMotion.stopMove")
        assert not any(await rig.robot.get("velocity"))


async def test_without_a_robot_verbs_say_so_at_once(tmp_path: Path) -> None:
    published = PublishedMessages(tmp_path)
    driver = Pepper("it", PepperSettings(robots=(), connect=False), published.context)
    await driver.open()
    for verb, args in (("say", {"text": "Hi"}), ("drive", {"x": 1.0}), ("eyes", {"color": "red"})):
        with pytest.raises(DeviceLostError) as raised:
            await driver.perform(BusJob(verb, args))
        assert "connect" in raised.value.remedy
    await driver.rest()
    await driver.close()
    with pytest.raises(DeviceLostError, match="closed"):
        await driver.perform(BusJob("connect"))


@pytest.mark.usefixtures("patient")
async def test_another_robot_gets_the_files_autonomy_too(tmp_path: Path) -> None:
    """To let a robot go stops it, but that is no stop that somebody would release."""
    async with stand_in() as first, stand_in() as second:
        file = PepperSettings(
            robots=(first.address,), senses=QUIET, autonomy=AutonomySettings(blinking=False)
        )
        rig = await connected_driver(first, tmp_path, file)
        await rig.shows(blinking=False)
        await rig.do("connect", robot=second.address)
        await rig.tells(
            lambda settings_shown: (
                settings_shown.values.get("robot") == second.address.removeprefix("tcp://")
                and settings_shown.values.get("blinking") is False
                and not settings_shown.wanted
            )
        )
        await rig.close()


@pytest.mark.usefixtures("patient")
async def test_a_robot_that_comes_back_gets_the_files_settings_again(
    tmp_path: Path, port: int
) -> None:
    settings = PepperSettings(
        robots=(), senses=QUIET, voice=VoiceSettings(volume=0.3), eyes="green"
    )
    async with stand_in(port=port) as robot:
        address = robot.address
        rig = await connected_driver(
            robot,
            tmp_path,
            PepperSettings(robots=(address,), senses=QUIET, voice=settings.voice, eyes="green"),
        )
        await rig.shows(volume=0.3, eyes="#00ff00", robot=address)
        # What the wizard has changed since counts more than the file.
        await rig.do("eyes", color="red")
        await rig.do("volume", level=0.4)
        await rig.do("autonomy", awareness=False)
        robot.kill()
        await rig.published.first(DriverLost)
        await rig.tells(lambda settings_shown: set(settings_shown.values) == {"robot"})
        async with stand_in(port=port):
            await rig.published.first(DriverConnected, after=1)
            asked = {"volume": 0.4, "eyes": "#ff0000", "awareness": False}
            await rig.tells(
                lambda settings_shown: (
                    asked.items() <= settings_shown.values.items() and not settings_shown.wanted
                )
            )
            await rig.close()


async def test_all_settings_are_read_from_a_simulated_robot_of_its_own(tmp_path: Path) -> None:
    published = PublishedMessages(tmp_path)
    settings = PepperSettings(robots=("simulated",), pace=20)
    driver = Pepper("it", settings, published.context)
    await driver.open()
    await published.until(
        lambda: any(set(PEPPER.settings) <= set(one.values) for one in published.all(SettingsShown))
    )
    await asyncio.wait_for(driver.perform(BusJob("say", {"text": "Hello"})), 20)
    await driver.rest()
    await driver.close()


@pytest.mark.parametrize(
    ("verb", "why"),
    [("disconnect", "disconnected by the wizard"), ("connect", "is being connected")],
)
async def test_a_call_that_never_returns_keeps_nobody_from_leaving_or_changing_the_robot(
    tmp_path: Path, verb: str, why: str
) -> None:
    async with stand_in_here() as robot:
        published = PublishedMessages(tmp_path)
        settings = PepperSettings(robots=(robot.address,), senses=QUIET)
        driver = Pepper("it", settings, published.context)
        hub = Hub(published.clock, lambda message, line: None)
        bus = Bus(hub, {"it": driver}, {"it": Pepper.offer(settings).verbs})

        def send(name: str, **args: Json) -> asyncio.Future[End]:
            end: asyncio.Future[End] = asyncio.get_running_loop().create_future()
            command = Command(command=name, verb=name, args=args, driver="it", source="key")
            bus.submit(command, end.set_result)
            return end

        await driver.open()
        await published.first(DriverConnected)
        await send("volume", level=0.5)  # now the settings have been applied
        await robot.fault("deaf")
        hanging = send("naoqi", call="ALTextToSpeech.getAvailableLanguages")
        await robot.called("ALTextToSpeech.getAvailableLanguages")
        changing = send(verb)
        end = await asyncio.wait_for(hanging, PATIENCE_S)
        assert isinstance(end, Failed)
        assert end.reason.endswith(why)
        await robot.clear()
        assert isinstance(await asyncio.wait_for(changing, PATIENCE_S), Done)
        await driver.close()


# -- any call ------------------------------------------------------------------------------------


async def test_any_call_of_any_service_with_its_result(tmp_path: Path) -> None:
    async with connected_robot(tmp_path) as rig:
        sent = await rig.do("naoqi", call="ALTextToSpeech.getAvailableLanguages")
        assert sent["result"] == ["English", "French", "German", "Japanese"]
        sent = await rig.do("naoqi", call="ALMotion.setStiffnesses", args='["Head", 0.5]')
        assert sent == {
            "call": "ALMotion.setStiffnesses",
            "args": ["Head", 0.5],
            "result": None,
        }
        assert await rig.calls("ALMotion.setStiffnesses") == [("Head", 0.5)]
        sent = await rig.do("naoqi", call="ALTextToSpeech.getVolume", args="[]")
        assert sent["result"] == pytest.approx(0.7)
        for args, says in (
            ({"call": "say"}, "no call"),
            ({"call": "A.b.c"}, "no call"),
            ({"call": "A.b", "args": "{}"}, "must be a list"),
            ({"call": "A.b", "args": "[1"}, "no JSON list"),
        ):
            with pytest.raises(RejectedError, match=says):
                await rig.do("naoqi", **args)
        with pytest.raises(DriverError):
            await rig.do("naoqi", call="ALTextToSpeech.noSuchMethod")
        with pytest.raises(DriverError):
            await rig.do("naoqi", call="ALNothing.say", args='["x"]')
