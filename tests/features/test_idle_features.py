"""Features are passed by while the file gives them nothing to do, and only then."""

from __future__ import annotations

import asyncio
import sys
from collections.abc import Callable
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from types import FrameType
from typing import Any

import pytest

import woz_tui
from tests.session.rig import SessionRig, experiment, with_script
from woz_tui.config.experiment import Experiment
from woz_tui.feature import features
from woz_tui.gate.questions import RequestOrigin

KEY = RequestOrigin("key", "h", "con1")
FEATURES = Path(woz_tui.__file__).parent / "features"


def bare(folder: Path) -> Experiment:
    """No feature has anything to do."""
    return with_script(experiment(folder))


def uses(feature: str) -> Callable[[Experiment], Experiment] | None:
    """What of a file gives the feature something to do, as its examples have it."""
    module = f"tests.features.{feature}.examples"
    if find_spec(f"tests.features.{feature}") is None or find_spec(module) is None:
        return None
    found: Callable[[Experiment], Experiment] | None
    found = getattr(import_module(module), "used", None)
    return found


USED = {name: used for name in features() if (used := uses(name)) is not None}


async def passed(rig: SessionRig) -> set[str]:
    """The features of which functions are called from a press until its command has ended; not for
    what is kept of every log.
    """
    found: set[str] = set()

    def note(frame: FrameType, event: str, argument: Any) -> None:
        file = Path(frame.f_code.co_filename)
        if event == "call" and file.is_relative_to(FEATURES) and file.stem != "history":
            found.add(file.relative_to(FEATURES).parts[0])

    await asyncio.sleep(2)  # what reading the file has brought about is over
    sys.setprofile(note)
    try:
        rig.session.play("Hello", KEY)
        await asyncio.sleep(2)
    finally:
        sys.setprofile(None)
    return found


@pytest.mark.parametrize("feature", USED)
def test_it_is_asked_from_the_reading_of_a_file_that_uses_it_to_that_of_one_that_does_not(
    tmp_path: Path, feature: str
) -> None:
    plain = bare(tmp_path)
    found: list[set[str]] = []

    async def scenario(rig: SessionRig) -> None:
        for made in (plain, USED[feature](plain), plain):
            rig.session.adopt(made, [])
            found.append(await passed(rig))

    SessionRig(tmp_path, made=plain).run(scenario)
    assert [feature in each for each in found] == [False, True, False]
    assert found[0] == found[2] == set()


@pytest.mark.parametrize("feature", USED)
def test_a_session_that_begins_with_it_asks_it(tmp_path: Path, feature: str) -> None:
    found: list[set[str]] = []

    async def scenario(rig: SessionRig) -> None:
        found.append(await passed(rig))

    SessionRig(tmp_path, made=USED[feature](bare(tmp_path))).run(scenario)
    assert feature in found[0]
