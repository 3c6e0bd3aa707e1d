"""The lights of the eyes over the wire."""

from __future__ import annotations

import asyncio
import functools
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import cast

import pytest
from naoqi_simulator.leds import Leds
from naoqi_simulator.service_table import offers
from woz_drivers.naoqi_robot import eyes as eyes_module

from tests.drivers.pepper.robot_rig import RobotRig, connected_driver, connected_robot, settings_for
from tests.fakes.naoqi import StandIn, stand_in_here
from woz_tui.drivers.argument_values import COLORS
from woz_tui.drivers.contract import DriverError, RejectedError
from woz_tui.testing import until

FADE = "ALLeds.fadeRGB"


pytestmark = pytest.mark.asyncio(loop_scope="module")
#: What is in here is so of both.
KINDS = ("pepper", "nao")


async def eye_colour(rig: RobotRig) -> str:
    """The light of the robot as #rrggbb."""
    return "#" + "".join(f"{round(part * 255):02x}" for part in await rig.robot.get("eyes"))


async def sees(rig: RobotRig, color: str) -> None:
    async def there() -> bool:
        return await eye_colour(rig) == color

    await rig.robot.until(there)


@pytest.mark.naoqi("ALLeds.fadeRGB")
@pytest.mark.woz4u("colors")
async def test_colours_by_every_common_name_and_by_number(robot_rig: RobotRig) -> None:
    for name, number in {**COLORS, "#12aBef": "#12abef", "#f80": "#ff8800"}.items():
        sent = await robot_rig.do("eyes", color=name)
        assert sent == {"color": number, "animation": "steady"}
        assert await eye_colour(robot_rig) == number
    with pytest.raises(RejectedError, match="unknown colour"):
        await robot_rig.do("eyes", color="greeen")


async def test_a_fade_takes_its_time_and_says_so(robot_rig: RobotRig) -> None:
    await robot_rig.do("eyes", color="blue", seconds=3)
    assert robot_rig.jobs[-1].announced == [3]
    assert (await robot_rig.calls(FADE))[-1] == ("FaceLeds", 0, 0, 1, 3)


@pytest.mark.naoqi("ALLeds.getIntensity")
async def test_the_colour_is_read_back_with_its_parts_in_order(robot_rig: RobotRig) -> None:
    await robot_rig.do("naoqi", call=FADE, args='["FaceLeds", 1.0, 0.5, 0.0, 0.0]')
    await robot_rig.shows(eyes="#ff8000")
    await robot_rig.do("eyes", color="#0040c0")
    await robot_rig.shows(eyes="#0040c0")


@pytest.mark.naoqi("ALLeds.setIntensity")
async def test_dimming_keeps_the_colour_and_later_colours_are_dim_too(robot_rig: RobotRig) -> None:
    await robot_rig.do("eyes", color="#ff8000")
    await robot_rig.do("eyes_brightness", level=0.5)
    assert await eye_colour(robot_rig) == "#804000"
    await robot_rig.shows(eyes_brightness=0.5, eyes="#ff8000")
    await robot_rig.do("eyes", color="blue")
    assert await eye_colour(robot_rig) == "#000080"
    # The robot's own call makes everything white: it is used for white alone.
    assert await robot_rig.calls("ALLeds.setIntensity") == []
    await robot_rig.do("eyes", color="white")
    await robot_rig.do("eyes_brightness", level=0.25)
    assert await robot_rig.calls("ALLeds.setIntensity") == [("FaceLeds", 0.25)]
    assert await eye_colour(robot_rig) == "#404040"
    await robot_rig.do("eyes_brightness", level=1)
    assert await eye_colour(robot_rig) == "#ffffff"


@pytest.mark.parametrize("animation", ["blink", "intermittent"])
async def test_a_light_that_moves_goes_on_until_the_next_colour(
    robot_rig: RobotRig, animation: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(eyes_module, "OPEN_S", 0.05)
    await robot_rig.do("eyes", color="green", animation=animation)
    await robot_rig.robot.called(FADE, 6)
    colors = {call[1:4] for call in await robot_rig.calls(FADE)}
    assert colors == {(0, 0, 0), (0, 1, 0)}
    await robot_rig.shows(eyes="#00ff00")
    await robot_rig.do("eyes", color="red")
    await robot_rig.robot.clear()
    await robot_rig.do("naoqi", call="ALLeds.getIntensity", args='["RightFaceLed1"]')
    await asyncio.sleep(0.2)  # longer than a blink: nothing may come any more
    assert await robot_rig.calls(FADE) == []
    assert await eye_colour(robot_rig) == "#ff0000"


@pytest.mark.usefixtures("unhurried_stop")
@pytest.mark.parametrize("by", ["colour", "stop"])
async def test_a_fade_of_a_light_that_moves_is_not_the_last_one(
    by: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """NAOqi may carry out the call that was sent before behind the one that ends it."""
    late: list[Callable[[], Awaitable[None]]] = []
    real = Leds.fade_rgb

    @offers("fadeRGB(sffff)v")
    async def overtaken(leds: Leds, name: str, *color_and_seconds: float) -> None:
        carried_out = functools.partial(real, leds, name, *color_and_seconds)
        if color_and_seconds[:3] == (0, 0, 0):
            late.append(carried_out)
            await asyncio.Event().wait()
        await carried_out()
        while late:
            await late.pop()()

    monkeypatch.setattr(Leds, "fade_rgb", overtaken)
    async with stand_in_here() as robot:
        settings = settings_for("nao", robot.address)
        rig = await connected_driver(cast("StandIn", robot), tmp_path, settings)
        try:
            await rig.do("eyes", color="green", animation="intermittent")
            await until(lambda: bool(late))
            if by == "stop":
                await rig.stop()
            else:
                await rig.do("eyes", color="red")
            assert await eye_colour(rig) == ("#00ff00" if by == "stop" else "#ff0000")
        finally:
            await rig.close()


@pytest.mark.naoqi("ALLeds.rasta", "ALLeds.randomEyes", "ALLeds.rotateEyes")
@pytest.mark.woz4u("rasta_anim", "random_anim", "rotate_anim")
async def test_animations_last_as_long_as_asked_and_the_colour_comes_back(
    robot_rig: RobotRig,
) -> None:
    await robot_rig.do("eyes", color="#102030")
    for kind, method in (("rasta", "rasta"), ("random", "randomEyes"), ("rotate", "rotateEyes")):
        await robot_rig.do("eyes_animation", kind=kind, seconds=2.5, color="#ff8000")
        asked = await robot_rig.calls(f"ALLeds.{method}")
        assert sum(call[-1] for call in asked) == 2.5
        assert robot_rig.jobs[-1].announced == [2.5]
        back = (await robot_rig.calls(FADE))[-1]
        assert back == ("FaceLeds", *(pytest.approx(n / 255) for n in (16, 32, 48)), back[-1])
        assert back[-1] == 0.5
        assert await eye_colour(robot_rig) == "#102030"
    assert asked[0][:2] == (0xFF8000, 1)


async def test_a_cancelled_animation_gives_the_colour_back(robot_rig: RobotRig) -> None:
    await robot_rig.do("eyes", color="#102030")
    job = robot_rig.begin("eyes_animation", kind="rasta", seconds=600)
    await robot_rig.robot.called("ALLeds.rasta")
    await robot_rig.robot.clear()
    await robot_rig.cancel(job)
    # Once over the second that still plays, and once more behind it.
    await robot_rig.robot.called(FADE, 2)
    await sees(robot_rig, "#102030")
    await robot_rig.do("eyes", color="red")
    asked = len(await robot_rig.calls("ALLeds.rasta"))
    await robot_rig.do("eyes", color="green", seconds=3)
    assert await eye_colour(robot_rig) == "#00ff00"
    assert len(await robot_rig.calls("ALLeds.rasta")) == asked


async def test_an_animation_that_is_refused_leaves_nothing_to_stop(robot_rig: RobotRig) -> None:
    await robot_rig.do("eyes", color="#102030")
    await robot_rig.robot.fault("refuse:ALLeds.rasta")
    with pytest.raises(DriverError, match="not now"):
        await robot_rig.do("eyes_animation", kind="rasta", seconds=1)
    await robot_rig.robot.clear()
    assert "eyes" not in (await robot_rig.stop()).confirmed
    assert await robot_rig.calls(FADE) == []


@pytest.mark.naoqi("ALLeds.fadeRGB")
async def test_the_files_colour_is_shown_on_connect(tmp_path: Path) -> None:
    async with connected_robot(tmp_path, eyes="green") as rig:
        assert await eye_colour(rig) == "#00ff00"
        assert [call[-1] for call in await rig.calls(FADE)] == [0.5]
        await rig.shows(eyes="#00ff00")
