"""Gazes and poses of a body: when they have arrived, and how long they would take."""

from __future__ import annotations

import asyncio
from pathlib import Path

import pytest

from tests.drivers.body.rig import BodyRig, played_body
from woz_tui.drivers.contract import RejectedError, Scope
from woz_tui.testing import PlainJob

#: Taken at 50 Hz, a motion may be a tick or two late, in seconds.
SLACK_S = 0.05


def test_a_timed_gaze_is_done_at_once_and_arrives_in_its_time(tmp_path: Path) -> None:
    async def story(rig: BodyRig) -> None:
        loop = asyncio.get_running_loop()
        began = loop.time()
        job = PlainJob("gaze", {"yaw": 30.0, "seconds": 2.0})
        sent = await rig.body.perform(job)
        assert sent["seconds"] == 2.0
        assert loop.time() == pytest.approx(began, abs=SLACK_S)
        await asyncio.sleep(1.9)
        assert job.arrivals == []
        await asyncio.sleep(0.1 + SLACK_S)
        assert job.arrivals == [""]
        assert rig.setpoints["pan"] == pytest.approx(30.0, abs=0.5)

    played_body(tmp_path, story)


def test_a_gaze_that_something_else_ends_says_what(tmp_path: Path) -> None:
    async def story(rig: BodyRig) -> None:
        job = PlainJob("gaze", {"yaw": 30.0, "seconds": 2.0})
        await rig.body.perform(job)
        await asyncio.sleep(0.5)
        pose = PlainJob("pose", {"joints": {"pan": -20.0}, "seconds": 0.5})
        await rig.body.perform(pose)
        assert len(job.arrivals) == 1
        assert "pose" in job.arrivals[0]
        assert pose.arrivals == [], "it has arrived with its end"

    played_body(tmp_path, story)


def test_a_pose_that_is_ended_early_has_not_arrived(tmp_path: Path) -> None:
    async def story(rig: BodyRig) -> None:
        pose = PlainJob("pose", {"joints": {"pan": 30.0}, "seconds": 2.0})
        posing = asyncio.create_task(rig.body.perform(pose))
        await asyncio.sleep(0.5)
        await rig.body.perform(PlainJob("mode", {"mode": "normal"}))
        sent = await posing
        assert pose.arrivals == [sent["ended"]] != [""]

    played_body(tmp_path, story)


def test_how_long_it_takes_is_known_before_and_nothing_moves(tmp_path: Path) -> None:
    async def story(rig: BodyRig) -> None:
        before = rig.setpoints
        for verb, args in (
            ("gaze", {"yaw": 30.0, "seconds": 2.0}),
            ("gaze", {"yaw": 30.0}),
            ("pose", {"joints": {"pan": 80.0, "tilt": -20.0}}),
            ("home", {"seconds": 1.0}),
        ):
            known = await rig.body.predict(verb, args)
            await rig.ticks(5)
            assert rig.setpoints == before
            sent = await rig.body.perform(job := PlainJob(verb, args))
            assert known.seconds == pytest.approx(sent["seconds"], abs=1e-3), job
            await asyncio.sleep(3.0)
            await rig.do("home", seconds=0.0)
            await asyncio.sleep(3.0)
            before = rig.setpoints
        assert (await rig.body.predict("blinking", {"on": True})).seconds is None
        await rig.body.stop(Scope.ALL)
        with pytest.raises(RejectedError):
            await rig.body.predict("gaze", {"yaw": 10.0})

    played_body(tmp_path, story)


def test_a_moves_stroke_comes_where_it_was_foretold(tmp_path: Path) -> None:
    async def story(rig: BodyRig) -> None:
        loop = asyncio.get_running_loop()
        for move, speed in (("nod", 1.0), ("shake", 2.0), ("point-left", 1.0)):
            job = PlainJob("play", {"move": move, "speed": speed, "amplitude": 1.0})
            known = await rig.body.predict(job.verb, job.args)
            assert known.seconds is not None and known.marks is not None
            [(at, sort, _)] = known.marks
            assert sort == "stroke" and 0 < at < known.seconds
            began = loop.time()
            playing = asyncio.create_task(rig.body.perform(job))
            await asyncio.sleep(at - SLACK_S)
            assert job.marks == []
            await asyncio.sleep(2 * SLACK_S)
            assert job.marks == [("stroke", "")]
            await playing
            assert loop.time() - began == pytest.approx(known.seconds, abs=2 * SLACK_S)
            assert len(job.marks) == 1
        assert (await rig.body.predict("gaze", {"yaw": 3.0})).marks == ()

    played_body(tmp_path, story)
