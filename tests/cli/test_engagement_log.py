"""A session's log through the model once more: the same path, or what would have been."""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import json
import random
from dataclasses import replace
from pathlib import Path

import pytest

from tests.session.rig import SessionRig
from tools import EXPERIMENTS
from tools.demo_session import catalogue
from woz_tui import cli
from woz_tui.analysis.engagement_comparison import MOVED, ONLY_COMPUTED, ONLY_RECORDED, SAME, paired
from woz_tui.analysis.engagement_rerun import rerun
from woz_tui.config.engagement import EngagementSettings
from woz_tui.config.engagement_words import PAPER, VISITOR
from woz_tui.config.experiment import Experiment
from woz_tui.config.loading import load
from woz_tui.drivers.plugins import installed
from woz_tui.gate.questions import RequestOrigin
from woz_tui.log.log_reader import Damage
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError
from woz_tui.sensing.engagement_model import Transition
from woz_tui.session.participant_identity import SessionIdentity
from woz_tui.session.session import Session

GUIDE = EXPERIMENTS / "guide.yaml"
SECONDS = 240.0
#: Of a log that is only to be found, opened and told of.
SHORT_SECONDS = 60.0
WIZARD = RequestOrigin("key", "k", "con1")

Path_ = list[tuple[str, str, str, str, str, str, bool]]


def path_of(changes: list[Transition]) -> Path_:
    """All that a transition says but its time."""
    return [
        (
            *(change.was, change.now, change.outcome, change.why),
            *(json.dumps(change.verdicts), change.visitor, change.forced),
        )
        for change in changes
    ]


def _editions() -> list[Experiment]:
    """The guide's file as somebody edits it while a session runs."""
    guide = load(GUIDE, catalogue())
    assert guide.engagement is not None
    other = replace(guide.engagement.settings, samples=3, threshold=0.7, social_distance=2.0)
    return [
        *(guide, replace(guide, engagement=replace(guide.engagement, settings=other))),
        replace(guide, engagement=None),
    ]


async def _meddle(session: Session, seed: int) -> None:
    """A wizard who presses what there is, the stop included."""
    chance = random.Random(seed)
    names = [action.name for panel in session.experiment.panels for action in panel.actions]
    while True:
        await asyncio.sleep(chance.uniform(0.2, 4.0))
        press = chance.random()
        try:
            if press < 0.06:
                session.stop("key")
                await asyncio.sleep(chance.uniform(0.1, 3.0))
                session.release("key")
            elif press < 0.1:
                session.set(participant=f"G{chance.randrange(10, 13)}")
            elif press < 0.18:
                session.adopt(chance.choice(_editions()), ["engagement"])
            else:
                session.play(chance.choice(names), WIZARD)
        except RequestError:
            continue


def record_guide(
    folder: Path, seed: int | None = None, turns: str = VISITOR, seconds: float = SECONDS
) -> Path:
    """The log of the guide alone with its visitors, or with a wizard who meddles."""

    async def scenario(rig: SessionRig) -> None:
        if seed is None:
            await asyncio.sleep(seconds)
        else:
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(_meddle(rig.session, seed), seconds)

    drivers, stem = catalogue(), "2026-03-01T10-00-00_G01_S01"
    who = SessionIdentity(participant="G01", condition="alone", wizard="W1", seed=1)
    guide = load(GUIDE, drivers)
    assert guide.engagement is not None
    settings = replace(guide.engagement.settings, turns=turns)
    guide = replace(guide, engagement=replace(guide.engagement, settings=settings))
    rig = SessionRig(folder, (), who, drivers, guide, stem=stem)
    return rig.run(scenario).recorder.path


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The guide alone with its visitors for four minutes; the experiment lies beside the logs."""
    return record_guide(tmp_path_factory.mktemp("museum"))


@pytest.fixture(scope="module")
def short_log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same for a minute."""
    return record_guide(tmp_path_factory.mktemp("museum"), seconds=SHORT_SECONDS)


@pytest.fixture(scope="module")
def old_log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same by a version that had the paper's turns alone, and told no settings."""
    folder = tmp_path_factory.mktemp("old")
    log = record_guide(folder / "new", turns=PAPER, seconds=SHORT_SECONDS)
    return of_an_earlier_version(log, folder)


def settings() -> EngagementSettings:
    engagement = load(GUIDE, installed()).engagement
    assert engagement is not None
    return engagement.settings


def test_with_the_same_settings_the_path_is_the_same(log: Path) -> None:
    """E5: what the session has logged comes out again, every reason and verdict included."""
    log_rerun = rerun(log, settings(), Damage())
    assert len(log_rerun.recorded) > 20
    assert path_of(log_rerun.computed) == path_of(log_rerun.recorded)
    assert all(pair.sign == SAME for pair in paired(log_rerun.recorded, log_rerun.computed))


@pytest.mark.parametrize("seed", [1, 2])
def test_whatever_the_wizard_does_the_path_is_the_same(tmp_path: Path, seed: int) -> None:
    """E7: overrides, forced states, the stop, filters set while running, the file edited, too."""
    path = record_guide(tmp_path, seed)
    log_rerun = rerun(path, None, Damage())
    assert log_rerun.again is not None
    assert len(log_rerun.again.settings_at) > 2
    assert len(log_rerun.recorded) > 20
    assert any(change.forced for change in log_rerun.recorded)
    assert path_of(log_rerun.computed) == path_of(log_rerun.recorded)


def test_lines_have_the_fields_of_rows(short_log: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["engagement", str(short_log), "--experiment", str(GUIDE)]) == 0
    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert lines[0]["state"] == "PersonDetected"
    assert list(lines[0])[:8] == [
        *("t", "presence", "gaze", "id", "distance", "state", "outcome", "why"),
    ]


def test_another_filter_compared(log: Path, capsys: pytest.CaptureFixture[str]) -> None:
    options = ["--experiment", str(GUIDE), "--samples", "1", "--compare"]
    assert cli.main(["engagement", str(log), *options]) == 0
    out = capsys.readouterr().out
    assert max(map(len, out.splitlines())) <= 80
    assert "first difference: at" in out
    assert ONLY_COMPUTED in out
    assert "computed" in out
    assert cli.main(["engagement", str(log), *options, "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    figures = told["summary"]
    assert figures["computed"] > figures["recorded"]
    assert 0 < figures["engaged_recorded"] < 1
    signs = [row["sign"] for row in told["rows"]]
    assert set(signs) <= {SAME, MOVED, ONLY_COMPUTED, ONLY_RECORDED}
    only = sum(sign == ONLY_RECORDED for sign in signs)
    assert figures["alike"] + figures["moved"] + only == figures["recorded"]


def of_an_earlier_version(log: Path, folder: Path) -> Path:
    """The same log, without its settings."""
    recordings = folder / "recordings"
    recordings.mkdir()
    samples = log.with_name(log.name.replace(".jsonl", ".samples.jsonl"))
    (recordings / samples.name).write_bytes(samples.read_bytes())
    lines = log.read_bytes().splitlines(keepends=True)
    told = [line for line in lines if b'"kind":"engagement.settings"' not in line]
    assert len(told) == len(lines) - 1
    (recordings / log.name).write_bytes(b"".join(told))
    return recordings / log.name


@pytest.mark.parametrize("folder", [EXPERIMENTS, EXPERIMENTS.parent], ids=["it", "above it"])
def test_without_a_word_the_settings_are_those_of_the_session(
    old_log: Path,
    folder: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The file that the session names is taken if it is found and is still the same."""
    monkeypatch.chdir(folder)
    assert cli.main(["engagement", str(old_log), "--compare"]) == 0
    captured = capsys.readouterr()
    assert "no difference" in captured.out
    assert "defaults" not in captured.err


def test_an_experiment_that_is_not_there_or_another_is_told(
    short_log: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    monkeypatch.chdir(tmp_path)
    log = of_an_earlier_version(short_log, tmp_path)
    assert cli.main(["engagement", str(log)]) == 0
    assert "guide.yaml is not beside the log; the defaults are used" in capsys.readouterr().err
    (tmp_path / "guide.yaml").write_text("title: [")
    assert cli.main(["engagement", str(log)]) == 0
    assert "cannot be read now" in capsys.readouterr().err


def test_an_experiment_that_was_edited_afterwards_changes_nothing(
    short_log: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    """E5: the log has the settings itself; options stand above them."""
    monkeypatch.chdir(tmp_path)
    edited = GUIDE.read_text(encoding="utf-8").replace(
        "engagement:", "engagement:\n  samples: 1", 1
    )
    (tmp_path / "guide.yaml").write_text(edited, encoding="utf-8")
    assert cli.main(["engagement", str(short_log), "--compare"]) == 0
    captured = capsys.readouterr()
    assert "no difference" in captured.out
    assert captured.err == ""
    assert cli.main(["engagement", str(short_log), "--compare", "--samples", "1"]) == 0
    assert "first difference" in capsys.readouterr().out


def test_a_torn_log_is_read_as_far_as_it_goes(log: Path, tmp_path: Path) -> None:
    torn = tmp_path / log.name
    whole = log.read_bytes()
    torn.write_bytes(whole[: len(whole) // 2] + b"\x00\xff{")
    samples = log.with_name(log.name.replace(".jsonl", ".samples.jsonl"))
    (tmp_path / samples.name).write_bytes(samples.read_bytes())
    damage = Damage()
    log_rerun = rerun(torn, settings(), damage)
    assert damage.sentences()
    assert path_of(log_rerun.computed)[:5] == path_of(log_rerun.recorded)[:5]


def change(t: float, was: str, now: str) -> Transition:
    return Transition(round(t * 1e6), was, now, "x", "", {}, "", False)


def test_pairs_stand_in_the_order_of_time() -> None:
    recorded = [change(1, "Wait", "A"), change(2, "A", "B"), change(9, "B", "A")]
    computed = [change(1.05, "Wait", "A"), change(3, "A", "B"), change(4, "B", "C")]
    assert paired([], []) == []
    signs = [pair.sign for pair in paired(recorded, computed)]
    assert signs == [SAME, MOVED, ONLY_COMPUTED, ONLY_RECORDED]


def test_what_moved_over_something_else_is_two_lines() -> None:
    recorded = [change(2, "Wait", "A")]
    computed = [change(1, "Wait", "A"), change(1.5, "A", "B")]
    pairs = paired(recorded, computed)
    assert [pair.sign for pair in pairs] == [ONLY_COMPUTED, ONLY_COMPUTED, ONLY_RECORDED]
    assert [pair.t for pair in pairs] == sorted(pair.t for pair in pairs)


def test_the_samples_of_a_log_are_the_log_too(
    short_log: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    samples = short_log.with_name(short_log.name.replace(".jsonl", ".samples.jsonl"))
    assert cli.main(["engagement", str(samples), "--experiment", str(GUIDE)]) == 0
    assert capsys.readouterr().out
    assert m.FORMAT == "woz-session"


@pytest.mark.parametrize("start", [b"", b"\n", b'{"kind":"session.st\n', b"\x00\xff\n[]\n"])
def test_a_log_is_one_whatever_has_become_of_its_first_line(
    short_log: Path, tmp_path: Path, start: bytes, capsys: pytest.CaptureFixture[str]
) -> None:
    first, rest = short_log.read_bytes().split(b"\n", 1)
    (tmp_path / short_log.name).write_bytes(start + rest)
    samples = short_log.with_name(short_log.name.replace(".jsonl", ".samples.jsonl"))
    (tmp_path / samples.name).write_bytes(samples.read_bytes())
    words = ["engagement", str(tmp_path / short_log.name), "--experiment", str(GUIDE), "--compare"]
    assert cli.main(words) == 0
    assert "no difference" in capsys.readouterr().out
    assert b"session.start" in first


def test_samples_whose_sensor_is_no_name_are_passed_over(log: Path, tmp_path: Path) -> None:
    """A log that another program has written into."""
    name = log.name.replace(".jsonl", ".samples.jsonl")
    lines = log.with_name(name).read_bytes().splitlines()
    pairs = itertools.product([["gaze"], {"a": 1}, None, 7, True], [1.0, True])
    for place, (sensor, value) in enumerate(pairs, 1):
        odd = {**json.loads(lines[place]), "kind": "sample", "sensor": sensor, "value": value}
        lines[place] = json.dumps(odd).encode()
    (tmp_path / name).write_bytes(b"\n".join(lines) + b"\n")
    (tmp_path / log.name).write_bytes(log.read_bytes())
    log_rerun = rerun(tmp_path / log.name, None, Damage())
    assert len(log_rerun.computed) > 20
    assert log_rerun.sensors <= {"presence", "gaze", "distance", "identity", "loudness"}
