"""A body moves what its servos can move, and is done when they show that it has moved."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from pathlib import Path

import pytest
from woz_drivers.body import Body

from tests.drivers.body.rig import BodyRig, played_body, small
from tests.drivers.body.test_body_messages import present
from tests.drivers.published_messages import BusJob
from woz_tui.drivers.contract import DeviceLostError, DriverError, RejectedError
from woz_tui.protocol.messages import Json, VerbsUnable

#: Those that are over, or arrive, when the joints are there.
AWAITED = ("pose", "poses", "home", "play", "gaze")
MOVING: list[tuple[str, dict[str, Json]]] = [
    ("pose", {"joints": {"pan": 20.0}, "seconds": 0.2}),
    ("poses", {"poses": [{"joints": {"pan": 20.0}, "seconds": 0.2}]}),
    ("home", {"seconds": 0.2}),
    ("play", {"move": "shake", "speed": 1.0, "amplitude": 1.0}),
    ("gaze", {"yaw": 20.0}),
    ("nudge", {"yaw": 5.0, "pitch": 0.0}),
    ("joints", {"joints": {"pan": 20.0}}),
]


@pytest.mark.parametrize(("verb", "args"), MOVING)
def test_what_its_servos_cannot_do_is_refused_with_their_reason(
    tmp_path: Path, verb: str, args: dict[str, Json]
) -> None:
    overload = ("has an alarm: overload", "`reboot` it")
    gone = ("no servo answers on /dev/tty", "check their power")

    async def story(rig: BodyRig) -> None:
        begun = rig.setpoints
        for held, unable, joints, kind, why in (
            ((), {}, {"pan": 0.0, "tilt": 10.0}, RejectedError, "the torque of"),
            ((), dict.fromkeys(("pan", "tilt"), overload), {}, DriverError, "overload"),
            ((), dict.fromkeys(("pan", "tilt"), gone), {}, DeviceLostError, "no servo answers"),
        ):
            present(rig, frozenset(held), unable=unable, joints=joints)
            with pytest.raises(kind, match=why) as raised:
                await rig.do(verb, **args)
            assert raised.value.remedy
            assert rig.setpoints == pytest.approx(begun, abs=0.1)

    played_body(tmp_path, story, servos="head")


def test_a_body_whose_servos_say_nothing_has_not_moved(tmp_path: Path) -> None:
    async def story(rig: BodyRig) -> None:
        with pytest.raises(DeviceLostError, match="is not told of"):
            await rig.do("pose", joints={"pan": 20.0}, seconds=0.2)
        assert (rig.published.all(VerbsUnable)[-1].unable)[:2] == ["play", "pose"]
        present(rig, frozenset({"pan", "tilt"}), pan=0.0, tilt=10.0)
        await asyncio.sleep(0.3)
        assert rig.published.all(VerbsUnable)[-1].unable == []

    played_body(tmp_path, story, servos="head")


async def followed(
    rig: BodyRig, job: BusJob, share: float = 1.0, held: frozenset[str] = frozenset({"pan", "tilt"})
) -> Mapping[str, Json]:
    """Carries a command out with servos that go this share of the way, if they are `held`."""
    start = rig.setpoints
    present(rig, held, joints=start)
    running = asyncio.create_task(rig.body.perform(job))
    while not running.done() or (job.verb == "gaze" and not job.arrivals):
        await rig.ticks(1)
        there = {
            name: start[name] + share * (at - start[name]) for name, at in rig.setpoints.items()
        }
        present(rig, held, joints={n: at if n in held else start[n] for n, at in there.items()})
    return running.result()


@pytest.mark.parametrize(("verb", "args"), [each for each in MOVING if each[0] in AWAITED])
def test_a_motion_is_done_when_its_servos_show_it(
    tmp_path: Path, verb: str, args: dict[str, Json]
) -> None:
    async def story(rig: BodyRig) -> None:
        await rig.ticks(2)
        await followed(rig, BusJob("pose", {"joints": {"pan": -40.0}, "seconds": 0.3}))
        job = BusJob(verb, args)
        await followed(rig, job)
        assert (job.evidences, job.arrivals) == (["measured"], [""] if verb == "gaze" else [])
        await followed(rig, BusJob("pose", {"joints": {"pan": -40.0}, "seconds": 0.3}))
        job = BusJob(verb, args)
        if verb == "gaze":
            await followed(rig, job, 0.0)
            assert job.arrivals[0].startswith("pan stands at -40 degrees and not at 20")
        else:
            with pytest.raises(DriverError, match=r"pan (stands at|moved by 0 of)"):
                await followed(rig, job, 0.0)

    played_body(tmp_path, story, servos="head")


def test_a_pose_of_which_one_joint_is_limp_has_not_arrived(tmp_path: Path) -> None:
    async def story(rig: BodyRig) -> None:
        job = BusJob("pose", {"joints": {"pan": 20.0, "tilt": 30.0}, "seconds": 0.3})
        sent = await followed(rig, job, held=frozenset({"pan"}))
        assert sent["left_out"] == {"tilt": "torque is off"}
        assert job.arrivals == ["tilt torque is off"]

    played_body(tmp_path, story, servos="head")


def test_a_body_without_servos_knows_of_no_joint(tmp_path: Path) -> None:
    job = BusJob("pose", {"joints": {"pan": 20.0}, "seconds": 0.1})

    async def story(rig: BodyRig) -> None:
        await rig.body.perform(job)

    played_body(tmp_path, story)
    assert job.evidences == []
    alone, moved = (
        {verb.name: verb.evidence for verb in Body.offer(small(**servos)).verbs}
        for servos in ({}, {"servos": "head"})
    )
    assert (alone["pose"], moved["pose"], moved["gaze"], alone["mode"]) == (
        *("timed", "measured", "timed", ""),
    )
