"""The examples on the pages of the packages that are of use without woz-tui run as they stand."""

from __future__ import annotations

import asyncio
import re
import sys
from pathlib import Path

import pytest

from tests.fakes.naoqi import stand_in

DRIVERS = Path(__file__).parents[2] / "drivers"


@pytest.mark.parametrize(
    ("package", "prints"), [("qimessaging", "[0.0]\n"), ("naoqi_simulator", "")]
)
async def test_the_example_runs(package: str, prints: str) -> None:
    page = (DRIVERS / package / "README.md").read_text("utf-8")
    [example] = re.findall(r"^```python\n(.*?)^```", page, re.DOTALL | re.MULTILINE)
    async with stand_in("own") as robot:
        process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-c", example.replace("9559", str(robot.port))),
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.STDOUT,
        )
        output, _ = await process.communicate()
    assert (process.returncode, output.decode()) == (0, prints)
