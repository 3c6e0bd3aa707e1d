"""Bodies of two to six joints do what EyePi does: their number is in their file alone."""

from __future__ import annotations

import asyncio
import math
import random
from pathlib import Path

import pytest
from woz_drivers.body import Body, BodySettings

from tests.drivers.body.rig import BodyRig, robot, within
from tests.fakes.virtual_time import run_virtual
from woz_tui.drivers.contract import RejectedError, Scope
from woz_tui.motion.body_feeds import SEEN, Sighting
from woz_tui.motion.body_shape import AXES, ROLES, FaceShape, JointShape, Personality
from woz_tui.motion.modes import Mode
from woz_tui.protocol.messages import Json, Notice

#: Values that no sender should send.
HOSTILE: tuple[Json, ...] = (
    *(math.nan, math.inf, -math.inf, 1e300, -1.0, 0, "left", None, True, [], {}, 10**400),
)


def any_body(seed: int) -> BodySettings:
    """A body of two to six joints that fits together, and no better than that."""
    dice = random.Random(seed)
    names = [f"j{number}" for number in range(dice.randint(2, 6))]
    joints = {}
    for name in names:
        low = dice.uniform(-120, 40)
        high = low + dice.uniform(10, 150)
        joints[name] = JointShape(
            axis=dice.choice(list(AXES)),
            min=low,
            max=high,
            speed=dice.uniform(40, 400),
            acceleration=dice.choice([None, dice.uniform(300, 3000)]),
            offset=(0.0, 0.0, dice.uniform(0.02, 0.2)),
            zero=dice.uniform(-10, 10),
            home=dice.uniform(low, high),
        )
    shares = {
        role: {name: dice.uniform(-1, 1) for name in dice.sample(names, dice.randint(1, 2))}
        for role in dice.sample(ROLES, dice.randint(0, 4))
    }
    return BodySettings(
        joints,
        roles=shares,
        breathing={names[0]: 0.5, names[-1]: -0.5},
        zoom={names[-1]: 1.0},
        face=dice.choice([None, FaceShape(), FaceShape(width=32, height=20)]),
        easing=dice.choice(["linear", "smooth", "minimum-jerk"]),
        personalities={"slow": Personality(tempo=0.5, smoothing=1.0, compression=0.5)},
        camera="eye",
    )


def bodies(tmp_path: Path) -> list[BodySettings]:
    files = [robot(name, tmp_path, camera="eye") for name in ("eyepi", "five-joints")]
    return [*files, *map(any_body, range(3))]


def see(rig: BodyRig, frame: int) -> None:
    now = round(asyncio.get_running_loop().time() * 1e6)
    sighting = Sighting(now, frame, 0.8 * math.sin(frame / 9), 0.5 * math.cos(frame / 7), 0.1)
    rig.published.context.feed(SEEN, of="eye").put(sighting)


@pytest.mark.toolkit("R6", "M4", "M5", "G3")
@pytest.mark.parametrize("which", range(5))
def test_all_moves_and_modes_run_on_any_body(tmp_path: Path, which: int) -> None:
    settings = bodies(tmp_path)[which]
    assert settings.problems() == []

    async def story() -> None:
        rig = await BodyRig.of(settings, tmp_path)
        path = [rig.setpoints]
        for name in settings.playable:
            if name != "demo":
                running = rig.begin("play", move=name, speed=1.0, amplitude=1.0)
                path += await rig.path(30)
                running.cancel()
        for mode in (*Mode, *reversed(Mode)):
            await rig.do("mode", mode="normal")
            await rig.do("mode", mode=mode.value)
            for frame in range(1, 20):
                see(rig, frame)
                path += await rig.path(2)
            assert rig.state.mode == mode.value
        await rig.do("mode", mode="normal")
        path += await rig.path(100)
        assert within(settings, path)
        await rig.do("home", seconds=0.5)
        await rig.body.stop(Scope.ALL)
        await rig.body.close()
        assert not [one for one in rig.published.all(Notice) if one.level != "info"]

    run_virtual(story())


@pytest.mark.toolkit("R4", "R6", "M4")
@pytest.mark.parametrize("which", range(5))
def test_no_input_makes_any_body_unsafe(tmp_path: Path, which: int) -> None:
    settings = bodies(tmp_path)[which]
    dice = random.Random(which)
    verbs = Body.offer(settings).verbs

    def value(kind: str, choices: tuple[str, ...]) -> Json:
        roll = dice.random()
        if roll < 0.3:
            return dice.choice(HOSTILE)
        if kind == "choice":
            return dice.choice(choices)
        if kind == "flag":
            return dice.random() < 0.5
        if kind == "joints":
            return {dice.choice([*settings.joints, "nose"]): value("number", ()) for _ in range(3)}
        if kind == "poses":
            return [{"joints": value("joints", ()), "seconds": value("number", ())}]
        return dice.uniform(-200, 200) if roll > 0.7 else dice.uniform(-1, 1)

    async def story() -> None:
        rig = await BodyRig.of(settings, tmp_path)
        path = [rig.setpoints]
        taken = 0
        running: list[asyncio.Task[object]] = []
        for round_ in range(200):
            verb = dice.choice(verbs)
            args = {
                argument.name: value(argument.kind, argument.choices)
                for argument in verb.arguments
                if argument.required or dice.random() < 0.5
            }
            task: asyncio.Task[object] = asyncio.ensure_future(rig.do(verb.name, **args))
            running.append(task)
            if round_ % 40 == 20:
                await rig.body.stop(Scope.ALL)
                path += await rig.path(2)
                await rig.body.resume()
            if round_ % 7 == 0:
                see(rig, round_)
            path += await rig.path(dice.choice((1, 1, 1, 5)))
            if task.done() and task.exception() is None:
                taken += 1
        assert within(settings, path)
        assert all(math.isfinite(angle) for pose in path for angle in pose.values())
        assert taken > 10
        await rig.body.close()
        for task in running:
            try:
                await task
            except RejectedError as refused:
                assert refused.what
            except Exception as error:  # noqa: BLE001 - what is left was closed
                assert type(error).__name__ == "DeviceLostError"

    run_virtual(story())
