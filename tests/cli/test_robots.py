"""`woz robots`: what there is and what each offers."""

from __future__ import annotations

import argparse
import json
import re
from collections.abc import Mapping
from pathlib import Path

import pytest

from tests.config.catalogue import CATALOGUE, Bare, NoSettings, VoiceSettings
from tools.driver_settings import bundled
from woz_tui.cli import robots
from woz_tui.drivers.contract import Driver, DriverFacts, Job, Offer, PassiveDriver, Scope, Verb
from woz_tui.protocol.messages import Json

ROOT = Path(__file__).parents[2]


class Whole(Bare):
    Settings = NoSettings
    summary = "a robot of glass"
    facts = DriverFacts(
        robot=True,
        needs="a quiet room",
        stop="its bell",
        simulated="always",
        shown=("stop", "loss"),
    )


class Mover(Driver):
    """It does not say what confirms its stop."""

    Settings = NoSettings
    summary = "moves"

    async def perform(self, job: Job) -> Mapping[str, Json]:
        return {}

    async def stop(self, scope: Scope) -> None:
        return


class Senses(PassiveDriver):
    """Nothing of it moves."""

    Settings = NoSettings
    summary = "a sensor"


class Unkind(Bare):
    """It fails with any settings."""

    Settings = NoSettings

    @classmethod
    def offer(cls, settings: object) -> Offer:
        raise RuntimeError("a bug in the driver")


def run_robots(*words: str, catalogue: dict[str, type[Driver]] | None = None) -> int:
    parser = argparse.ArgumentParser()
    robots.add(parser)
    return robots.robots(parser.parse_args([*words]), catalogue or {**CATALOGUE, "glass": Whole})


def test_whole_robots_come_first_with_what_a_lab_must_know(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    assert run_robots() == 0
    out = capsys.readouterr().out
    assert max(map(len, out.splitlines())) <= 80
    first, _, parts = out.partition("Parts of robots")
    assert first.startswith("glass  a robot of glass")
    for fact in ("a quiet room", "its bell", "always"):
        assert fact in first
    assert "voice" in parts


def test_one_is_shown_with_settings_and_arguments(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_robots("head") == 0
    out = capsys.readouterr().out
    assert "where it is [required]" in out
    assert "1 to 200 Hz" in out
    assert "speed: number, 0.1 to 4" in out


def test_only_what_cannot_move_has_nothing_to_stop(capsys: pytest.CaptureFixture[str]) -> None:
    for driver, stop in ((Mover, "not said"), (Senses, "nothing to stop"), (Whole, "its bell")):
        assert run_robots("it", catalogue={"it": driver}) == 0
        assert re.search(rf"^stop +{stop}", capsys.readouterr().out, re.MULTILINE)


def test_it_says_what_tests_have_shown_and_what_not(capsys: pytest.CaptureFixture[str]) -> None:
    catalogue: dict[str, type[Driver]] = {"glass": Whole, "ear": Senses, "arm": Mover}
    assert run_robots("glass", catalogue=catalogue) == 0
    out = capsys.readouterr().out
    assert re.search("^tested +stop, loss *$", out, re.MULTILINE)
    assert "stop    it stands still" in out
    assert "units   not shown: " in out
    assert run_robots(catalogue=catalogue) == 0
    assert "a sensor; tested with no device" in capsys.readouterr().out
    assert run_robots("--json", catalogue=catalogue) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["glass"]["shown"] == ["stop", "loss"]
    assert (told["arm"]["passive"], told["ear"]["passive"]) == (False, True)


class Declared(Bare):
    """It does what its robot file declares."""

    Settings = VoiceSettings
    summary = "whatever a file says"
    facts = DriverFacts(robot=True)

    @classmethod
    def offer(cls, settings: VoiceSettings) -> Offer:
        return Offer(verbs=tuple(Verb(word, "declared") for word in settings.words))


def test_a_robot_that_its_file_declares_is_there_by_the_files_name(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "robots").mkdir()
    (tmp_path / "robots" / "mine.yaml").write_text(
        "drivers: {it: {type: declared, words: [greet]}}"
    )
    monkeypatch.chdir(tmp_path)
    assert run_robots("--json", catalogue={"declared": Declared}) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["declared"]["verbs"] == []
    assert told["mine"]["verbs"] == ["greet"]


def test_one_that_is_not_there_is_answered_with_its_neighbour(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert run_robots("glas") == 1
    assert "did you mean 'glass'?" in capsys.readouterr().err


def test_a_driver_with_a_bug_is_named_and_hides_no_other(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert run_robots("--json", catalogue={"glass": Whole, "odd": Unkind}) == 0
    printed = capsys.readouterr()
    assert [*json.loads(printed.out)] == ["glass"]
    assert "'odd'" in printed.err


@pytest.mark.parametrize("name", sorted(bundled()))
def test_our_drivers_say_what_they_need_and_where_their_page_is(name: str) -> None:
    driver = bundled()[name]
    assert driver.facts.needs
    assert (ROOT / driver.facts.page).is_file()
    if driver.facts.robot:
        assert driver.facts.stop and driver.facts.simulated
