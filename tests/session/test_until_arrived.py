"""Steps that wait until a motion has arrived, not only until the robot has taken it."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from tests.session.rig import (
    ScriptedDriver,
    SessionRig,
    action,
    call,
    experiment,
    together,
    with_script,
)
from woz_tui.config.experiment import Panel
from woz_tui.drivers.contract import Argument, Job, Offer, Verb
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json

KEY = RequestOrigin("key", "x", "con1")


class SlowGazeDriver(ScriptedDriver):
    """Takes a gaze at once and is there after two seconds; beyond 90 never, below 0 it fails."""

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        yaw = (Argument("yaw", "number"),)
        return replace(
            super().offer(settings),
            verbs=(
                Verb("gaze", "", yaw, lane="head", stream=True, arrives=True),
                Verb("say", "", (Argument("text", "text"),), lane="voice", evidence="reported"),
            ),
        )

    async def perform(self, job: Job) -> Mapping[str, Json]:
        self.calls.append((job.verb, dict(job.args)))
        if job.verb == "gaze":
            job.evidence("reported")
            tell: Callable[[str], None] = job.goes_on()
            why = "the neck is stuck" if job.args["yaw"] < 0 else ""
            if job.args["yaw"] <= 90:
                loop = asyncio.get_running_loop()
                loop.call_later(1.9, job.evidence, "measured")
                loop.call_later(2.0, tell, why)
        return dict(job.args)


def look(yaw: float) -> Any:
    return replace(call("gaze", yaw=yaw), until="arrived")


ACTIONS = (
    action("Look", together(look(30.0)), together(call("say", text="There"))),
    action("Stuck", together(look(-30.0)), together(call("say", text="There"))),
    action("Speak", together(call("say", text="Hm"))),
    action("Watch", together(look(30.0)), together(call("mark", "session", text="There"))),
    action("Glance", together(call("gaze", yaw=30.0)), together(call("say", text="There"))),
)


def play_steps(tmp_path: Path, *steps: str) -> SessionRig:
    """Plays actions one after the other, a second apart; `stop` is the stop."""

    async def scenario(rig: SessionRig) -> None:
        for step in steps:
            if step == "stop":
                rig.session.stop("key")
            else:
                rig.session.play(step, KEY)
            await asyncio.sleep(1.0)

    made = experiment(tmp_path)
    spec = replace(made.drivers[0], offer=SlowGazeDriver.offer(None))
    made = replace(made, drivers=(spec,), panels=(Panel("P", ACTIONS, made.panels[0].place),))
    made = with_script(made)
    return SessionRig(tmp_path, catalogue={"puppet": SlowGazeDriver}, made=made).run(scenario, 10)


def moments(rig: SessionRig, kind: type[m.Message]) -> list[float]:
    return [round(line.t / 1e6, 2) for line in rig.of(kind)]


def ends(rig: SessionRig) -> list[tuple[str, str]]:
    return [(line.action, type(line).__name__) for line in rig.of(m.ActionEnd)]


def said_verbs(rig: SessionRig) -> list[str]:
    return [verb for verb, _ in rig.driver().calls if verb == "say"]


def test_the_next_step_begins_when_the_motion_has_arrived(tmp_path: Path) -> None:
    rig = play_steps(tmp_path, "Look")
    arrived = moments(rig, m.MotionArrived)
    requested = moments(rig, m.Command)
    assert arrived == [2.0]
    assert requested == [0.0, 2.0]
    assert ends(rig) == [("Look", "ActionDone")]


def test_without_until_it_begins_when_the_motion_was_taken(tmp_path: Path) -> None:
    assert moments(play_steps(tmp_path, "Glance"), m.Command) == [0.0, 0.0]


def test_a_motion_that_does_not_arrive_fails_its_action(tmp_path: Path) -> None:
    rig = play_steps(tmp_path, "Stuck")
    assert ends(rig) == [("Stuck", "ActionFailed")]
    assert not said_verbs(rig)
    (failed,) = rig.of(m.ActionFailed)
    assert failed.reason == "robot: the neck is stuck"


def test_a_motion_that_does_not_arrive_fails_also_where_a_newer_act_came(tmp_path: Path) -> None:
    assert ("Stuck", "ActionFailed") in ends(play_steps(tmp_path, "Stuck", "Speak"))
    assert ("Look", "ActionSuperseded") in ends(play_steps(tmp_path / "well", "Look", "Speak"))


def test_a_newer_gaze_replaces_the_action_that_waits_for_the_older(tmp_path: Path) -> None:
    rig = play_steps(tmp_path, "Look", "Glance")
    assert ends(rig)[0] == ("Look", "ActionSuperseded")
    assert ("Glance", "ActionDone") in ends(rig)
    assert len(said_verbs(rig)) == 1


def test_a_stop_ends_an_action_that_waits_for_its_motion(tmp_path: Path) -> None:
    rig = play_steps(tmp_path, "Look", "stop")
    assert ends(rig) == [("Look", "ActionStopped")]
    assert not said_verbs(rig)


def test_an_action_is_as_sure_as_the_weakest_of_its_steps(tmp_path: Path) -> None:
    def known(*steps: str) -> list[str]:
        rig = play_steps(tmp_path / steps[0], *steps)
        return [line.evidence for line in rig.of(m.ActionDone)]

    assert known("Look") == ["reported"]  # the gaze was measured, the voice says so
    assert known("Watch") == ["measured"]  # a marker reaches no hardware
