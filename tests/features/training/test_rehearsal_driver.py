"""A rehearsed driver offers what the real one does, takes its time, and touches nothing."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tests.fakes.ports import free_port
from tests.network.installed_worker import installed_worker
from tests.network.test_session_with_places import TEXT as BESIDE_ANOTHER
from tests.session.rig import NoSettings, ScriptedDriver, SessionRig
from tests.session.test_driver_processes import TEXT as IN_A_PROCESS
from woz_tui.config.loading import load
from woz_tui.drivers.contract import Argument, Driver, PassiveDriver, Verb
from woz_tui.drivers.plugins import installed
from woz_tui.features.training.rehearsal_driver import rehearsal_of, rehearsed, seconds_of
from woz_tui.network.driver_process import ProcessDriver
from woz_tui.protocol import messages as m
from woz_tui.testing import PlainJob, RecordingContext

SAY = Verb("say", "", (Argument("text", "text", required=True),), limit_s=20.0)


def test_it_offers_what_the_class_offers() -> None:
    made = rehearsal_of(ScriptedDriver)
    told: Any = made
    assert made.offer(NoSettings()).verbs == ScriptedDriver.offer(NoSettings()).verbs
    assert told.offer(NoSettings()).joints == ScriptedDriver.offer(NoSettings()).joints
    assert made.offer(NoSettings()).sensors == ()
    assert made.Settings is ScriptedDriver.Settings


def test_every_bundled_driver_can_be_rehearsed() -> None:
    catalogue = installed()
    found = rehearsed(catalogue)
    assert set(found) == set(catalogue)
    assert found.pop("hands") is catalogue["hands"], "what the wizard learns lies in her hands"
    for made in found.values():
        driver: type[Driver] = made
        assert "rehearsed" in driver.summary


def test_a_stop_is_confirmed_as_it_will_be() -> None:
    found = rehearsed(installed())
    assert {each for each, made in found.items() if issubclass(made, PassiveDriver)} == {
        each for each, real in installed().items() if issubclass(real, PassiveDriver)
    }
    assert not issubclass(found["simulated"], PassiveDriver)


async def test_nothing_moves_in_a_rehearsal_so_nobody_can_know(tmp_path: Path) -> None:
    kind = rehearsed(installed())["simulated"]
    settings = kind.Settings()
    assert {verb.name: verb.evidence for verb in kind.offer(settings).verbs}["pose"] == "measured"
    job = PlainJob("volume", {"level": 0.5})
    await kind("robot", settings, RecordingContext(tmp_path)).perform(job)
    assert job.evidences == ["timed"]


@pytest.mark.parametrize(
    ("verb", "args", "seconds"),
    [
        (SAY, {"text": "one two three four five"}, 2.3),
        (SAY, {"text": "word " * 1000}, 18.0),
        (Verb("pose", ""), {"joints": {}, "seconds": 1.5}, 1.5),
        (Verb("pose", ""), {"seconds": -3}, 0.0),
        (Verb("nod", ""), {}, 0.8),
        (Verb("gaze", "", stream=True), {"yaw": 3}, 0.0),
        (Verb("volume", "", brief=True), {}, 0.0),
        (None, {}, 0.0),
    ],
)
def test_how_long_it_takes(verb: Verb | None, args: dict[str, Any], seconds: float) -> None:
    assert seconds_of(verb, args) == pytest.approx(seconds)


async def test_a_training_needs_no_other_computer(tmp_path: Path) -> None:
    path = tmp_path / "e.yaml"
    path.write_text(BESIDE_ANOTHER.format(port=free_port(), text="Hi"))
    catalogue = rehearsed(installed())
    rig = SessionRig(tmp_path, catalogue=catalogue, made=load(path, catalogue))
    async with rig:
        assert rig.kinds(m.DriverConnected) == ["DriverConnected"]


async def test_in_a_training_drivers_stay_with_a_body_that_does_not_move(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    catalogue = installed_worker(tmp_path, monkeypatch)
    path = tmp_path / "e.yaml"
    path.write_text(IN_A_PROCESS.replace("{type: worker}", "{type: worker, beside: body}"))
    experiment = load(path, catalogue)
    rig = SessionRig(tmp_path, catalogue=rehearsed(catalogue), made=experiment)
    assert not any(isinstance(driver, ProcessDriver) for driver in rig.session.drivers.values())
    async with rig:
        pass
