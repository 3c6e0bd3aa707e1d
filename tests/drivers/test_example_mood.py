"""The example of drivers that work together does what drivers/README.md says."""

from __future__ import annotations

import asyncio
import importlib.util
from pathlib import Path
from types import ModuleType, SimpleNamespace

from tests.fakes.virtual_time import run_virtual
from woz_tui.drivers.contract import Scope
from woz_tui.testing import RecordingContext

MOOD = Path(__file__).parents[2] / "drivers/example/woz_driver_lamp/mood.py"


def module() -> ModuleType:
    """The example's file, imported from where it stands."""
    spec = importlib.util.spec_from_file_location("example_mood", MOOD)
    assert spec is not None
    assert spec.loader is not None
    made = importlib.util.module_from_spec(spec)
    __import__("sys").modules[spec.name] = made
    spec.loader.exec_module(made)
    return made


def test_the_lamp_follows_the_face_and_is_left_alone_while_stopped() -> None:
    mood = module()
    context = RecordingContext()
    context.outcome = (False, "no driver 'lamp' offers 'glow'")
    state = context.feeds.feed("body", "state")

    async def scenario() -> None:
        driver = mood.Mood("mood", mood.MoodSettings(follows="body", lamp="lamp"), context)
        await driver.open()
        for emotion in ("happy", "happy", "sad"):
            state.put(SimpleNamespace(emotion=emotion))
            await asyncio.sleep(1)
        await driver.stop(Scope.ALL)
        state.put(SimpleNamespace(emotion="angry"))
        await asyncio.sleep(1)
        assert len(context.asks) == 2
        await driver.resume()
        await asyncio.sleep(1)
        await driver.close()

    run_virtual(scenario())
    assert [ask.args["color"] for ask in context.asks] == ["#ffd000", "#0040ff", "#ff0000"]
    assert {(ask.what, ask.name, ask.on) for ask in context.asks} == {("verb", "glow", "lamp")}
    assert "no driver 'lamp' offers 'glow'" in context.notices[0][1]
