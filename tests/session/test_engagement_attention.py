"""The robot looks at a sound elsewhere, and back to whom it talks with."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import replace
from pathlib import Path

import pytest

from tests.session.engagement_rig import PLAIN, WIZARD, EngagementRig, guided, in_room
from woz_tui.config.engagement import AttentionSettings
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json

LOUD, QUIET = 0.5, 0.01
AHEAD: dict[str, Json] = {"yaw": 0.0, "pitch": 0.0}


def looking(
    tmp_path: Path, mode: str = "SemiEngaged", look: bool = True
) -> Callable[[], EngagementRig]:
    settings = replace(PLAIN, attention=AttentionSettings(mode=mode, look=look, seconds=2.0))
    experiment = guided(tmp_path, settings)

    async def scenario(rig: EngagementRig) -> None:
        await before(rig)
        await sound(rig, 50.0, 0.5)
        await asyncio.sleep(4)

    return lambda: in_room(tmp_path, scenario, experiment)


async def before(rig: EngagementRig) -> None:
    """A visitor ahead of the robot, who is silent."""
    rig.sense(loudness=QUIET, direction=0.0)
    rig.stands_there()
    await asyncio.sleep(0.5)


async def sound(rig: EngagementRig, direction: float, seconds: float) -> None:
    for _ in range(round(seconds / 0.1)):
        rig.sense(loudness=LOUD, direction=direction)
        await asyncio.sleep(0.1)
    rig.sense(loudness=QUIET)


def gazes(rig: EngagementRig) -> list[dict[str, Json]]:
    return [dict(args) for verb, args in rig.commands if verb == "gaze"]


def test_half_engaged_it_looks_and_always_looks_back(tmp_path: Path) -> None:
    """E8: SemiEngaged."""
    rig = looking(tmp_path)()
    assert gazes(rig) == [{"yaw": 50.0, "pitch": 0.0}, AHEAD]
    away, back = (line.t for line in rig.of(m.Command) if line.verb == "gaze")
    assert back - away == pytest.approx(2_000_000, abs=20_000)
    told = {shown.attention for shown in rig.of(m.EngagementShown)}
    assert "a sound 50 degrees to the left" in told
    assert rig.engagement_shown.attention == ""


def test_fully_engaged_it_does_not_look(tmp_path: Path) -> None:
    """E8: FullyEngaged."""
    assert gazes(looking(tmp_path, "FullyEngaged")()) == []


def test_without_the_setting_it_does_not_look(tmp_path: Path) -> None:
    assert gazes(looking(tmp_path, look=False)()) == []


@pytest.mark.parametrize(
    ("camera", "somebody", "back"),
    [("head", 1, []), ("head", 0, [AHEAD]), ("body", 1, [AHEAD])],
)
def test_unengaged_it_stays_with_somebody_whom_it_finds(
    tmp_path: Path, camera: str, somebody: int, back: list[dict[str, Json]]
) -> None:
    """E8: Unengaged. Later it looks back to who was found."""
    attention = AttentionSettings(mode="Unengaged", look=True, seconds=2.0, camera=camera)
    settings = replace(PLAIN, attention=attention)

    async def scenario(rig: EngagementRig) -> None:
        await before(rig)
        await sound(rig, 50.0, 0.5)
        for _ in range(6):
            rig.sense(presence=somebody)
            await asyncio.sleep(0.3)
        await asyncio.sleep(2)
        rig.sense(presence=0)
        await sound(rig, -50.0, 0.5)
        await asyncio.sleep(4)

    rig = in_room(tmp_path, scenario, guided(tmp_path, settings))
    there: dict[str, Json] = {"yaw": 50.0, "pitch": 0.0}
    visitor = AHEAD if back else there
    assert gazes(rig) == [there, *back, {"yaw": -50.0, "pitch": 0.0}, visitor]


def test_the_mode_changes_while_running(tmp_path: Path) -> None:
    """E8: set by the wizard."""
    settings = replace(PLAIN, attention=AttentionSettings(look=True))

    async def scenario(rig: EngagementRig) -> None:
        await before(rig)
        rig.tell("attend", mode="FullyEngaged")
        await asyncio.sleep(0.1)
        await sound(rig, 50.0, 0.5)
        rig.tell("attend", mode="Unengaged")
        await asyncio.sleep(4)
        await sound(rig, -40.0, 0.5)

    rig = in_room(tmp_path, scenario, guided(tmp_path, settings))
    assert gazes(rig)[0] == {"yaw": -40.0, "pitch": 0.0}


@pytest.mark.parametrize("stopping", [True, False])
def test_whoever_moves_the_head_meanwhile_has_it(tmp_path: Path, stopping: bool) -> None:
    """It is not turned back against the wizard, nor after a stop."""
    settings = replace(PLAIN, attention=AttentionSettings(look=True))

    async def scenario(rig: EngagementRig) -> None:
        await before(rig)
        await sound(rig, 50.0, 0.5)
        await meddle(rig)
        await asyncio.sleep(4)

    async def turn(rig: EngagementRig) -> None:
        rig.tell("gaze", yaw=20.0, pitch=-10.0)

    async def stop(rig: EngagementRig) -> None:
        rig.session.stop("key")
        await asyncio.sleep(0.5)
        rig.session.release("key")

    meddle: Callable[[EngagementRig], Awaitable[None]] = stop if stopping else turn
    rig = in_room(tmp_path, scenario, guided(tmp_path, settings))
    assert gazes(rig) == [{"yaw": 50.0, "pitch": 0.0}]


def test_it_looks_back_to_where_the_wizard_had_it(tmp_path: Path) -> None:
    settings = replace(PLAIN, attention=AttentionSettings(look=True))

    async def scenario(rig: EngagementRig) -> None:
        await before(rig)
        rig.tell("gaze", yaw=15.0, pitch=5.0)
        await asyncio.sleep(0.2)
        await sound(rig, 150.0, 0.5)
        await asyncio.sleep(4)

    rig = in_room(tmp_path, scenario, guided(tmp_path, settings))
    # The head turns as far as it can: 60 degrees.
    assert gazes(rig) == [{"yaw": 60.0, "pitch": 0.0}, {"yaw": 15.0, "pitch": 5.0}]


def test_its_own_voice_is_no_stimulus(tmp_path: Path) -> None:
    settings = replace(PLAIN, attention=AttentionSettings(look=True))

    async def scenario(rig: EngagementRig) -> None:
        await before(rig)
        rig.tell("say", text="A long sentence")
        await asyncio.sleep(0.1)
        await sound(rig, 50.0, 0.5)

    rig = in_room(tmp_path, scenario, guided(tmp_path, settings))
    assert gazes(rig) == []


def test_a_sound_while_stopped_moves_nothing_after_the_release(tmp_path: Path) -> None:
    """It did not look there, so it does not look back either."""
    settings = replace(PLAIN, attention=AttentionSettings(look=True))

    async def scenario(rig: EngagementRig) -> None:
        await before(rig)
        rig.session.stop("key")
        await sound(rig, 50.0, 0.5)
        rig.session.release("key")
        await asyncio.sleep(4)

    rig = in_room(tmp_path, scenario, guided(tmp_path, settings))
    assert gazes(rig) == []


def test_the_head_of_another_robot_is_its_own(tmp_path: Path) -> None:
    """Whoever turns that one has not taken this one."""
    settings = replace(PLAIN, attention=AttentionSettings(look=True))
    one = guided(tmp_path, settings)
    (spec,) = one.drivers
    names = ("left.robot", "right.robot")
    two = replace(one, drivers=tuple(replace(spec, name=name) for name in names))

    async def scenario(rig: EngagementRig) -> None:
        rig.stands_there()
        hear = rig.session.hub.publish
        hear(m.reading("loudness", QUIET))
        hear(m.reading("left.direction", 0.0))
        await asyncio.sleep(0.5)
        rig.session.send("gaze", {"yaw": 30.0}, "right", WIZARD)
        hear(m.reading("loudness", LOUD))
        hear(m.reading("left.direction", 50.0))
        await asyncio.sleep(0.5)
        rig.session.send("gaze", {"yaw": -30.0}, "right", WIZARD)
        await asyncio.sleep(4)

    rig = in_room(tmp_path, scenario, two)
    assert gazes(rig) == [{"yaw": 50.0, "pitch": 0.0}, AHEAD]
    assert {line.driver for line in rig.of(m.Command) if line.source == "engagement"} == {
        "left.robot"
    }
