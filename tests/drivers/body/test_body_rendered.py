"""What was performed in a session is rendered again from its log."""

from __future__ import annotations

import asyncio
import json
from pathlib import Path
from typing import Any

import pytest

from tests.drivers.body.test_body_session import KEY, BodySession, on_stage
from tools import EXPERIMENTS
from woz_tui.cli import main
from woz_tui.protocol import messages as m

#: Degrees beside what was rendered within so many ticks: the body's ticks and the log's lines
#: do not fall together.
BESIDE, TICKS = 0.5, 2


def around(lines: list[dict[str, Any]], t: float) -> list[dict[str, Any]]:
    """What was rendered about the time `t`, 50 lines a second."""
    at = round(t * 50)
    return lines[max(0, at - TICKS) : at + TICKS + 1]


def near(value: float, rendered: list[float]) -> bool:
    """Whether a setpoint lies among those that were rendered."""
    return min(rendered) - BESIDE <= value <= max(rendered) + BESIDE


@pytest.mark.toolkit("U1")
def test_a_performance_is_rendered_again_from_its_log(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    async def scenario(rig: BodySession) -> None:
        for name, seconds in (("Joy dances", 10.0), ("Teasing", 6.0), ("Together", 10.0)):
            rig.session.play(name, KEY)
            await asyncio.sleep(seconds)

    rig = on_stage(tmp_path, scenario, "show")
    log = rig.session.recorder.path
    for robot in ("joy", "grim"):
        performed = [
            (line.t / 1e6, line.sensor.rpartition(".")[2], line.value)
            for line in rig.of(m.Reading)
            if line.sensor.startswith(f"{robot}.setpoint.")
            and line.value is not None
            and line.t < 26_000_000  # then the session ends, and the robot rests by itself
        ]
        show = str(EXPERIMENTS / "show.yaml")
        seconds = str(int(performed[-1][0]) + 1)
        words = ["idle", "--body", robot, "--inputs", str(log), "--seconds", seconds]
        assert main(["render", show, *words]) == 0
        lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
        assert len(performed) > 100
        far = [
            (t, joint, value)
            for t, joint, value in performed
            if not near(value, [line["joints"][joint] for line in around(lines, t)])
        ]
        assert far == []
        pitches = [line["joints"]["pitch"] for line in lines]
        assert max(pitches) - min(pitches) > 15
