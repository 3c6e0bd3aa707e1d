from __future__ import annotations

import argparse
import io
import sys
from pathlib import Path

import msgspec
import pytest

from tests.replay.logs import SECOND, START, story
from tests.replay.test_opened_log import write_log
from woz_tui.cli import main, replay
from woz_tui.config.loading import load
from woz_tui.drivers.plugins import installed
from woz_tui.protocol import messages as m
from woz_tui.protocol.requests import Welcome
from woz_tui.replay.opened_log import open_log
from woz_tui.replay.replay_feed import ReplayFeed
from woz_tui.replay.seek import ReplayError
from woz_tui.session.session_start import experiment_files

GUIDE = """\
title: Guide
robot: simulated
panels:
  - title: Speech
    actions:
      - {key: h, label: Hello, say: Hello}
      - {key: b, label: Bye, say: Bye}
"""


def arguments(*words: str) -> argparse.Namespace:
    parser = argparse.ArgumentParser()
    replay.add(parser)
    return parser.parse_args(words)


def log(folder: Path, *, whole: bool = True) -> Path:
    """A log beside its experiment; unless `whole` it has lost the lines that hold it."""
    (folder / "tale.yaml").write_text(GUIDE, encoding="utf-8")
    read = load(folder / "tale.yaml", installed())
    start = msgspec.structs.replace(
        START, experiment="tale.yaml", experiment_sha256=read.sha256, seq=0, t=0
    )
    rest = [each for each in story()[1:] if whole or not isinstance(each, m.SessionPlan)]
    kept = msgspec.structs.replace(experiment_files(read), seq=900, t=1)
    return write_log(folder, [start, *rest, *([kept] if whole else [])])


def opened_feed(path: Path, *words: str) -> ReplayFeed | None:
    given = arguments(str(path), *words)
    with open_log(path) as index:
        return replay.replay_feed(index, path, given)


def title(feed: ReplayFeed | None) -> tuple[str, list[str]]:
    assert feed is not None
    first = feed._player.begin(0)[0]
    assert isinstance(first, Welcome)
    return first.title, [action.label for panel in first.panels for action in panel.actions]


def test_without_a_terminal_it_refuses(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO())
    assert main(["replay", str(log(tmp_path))]) == 2
    assert capsys.readouterr().err.startswith("woz: ")


def test_a_log_beside_its_experiment_is_shown(tmp_path: Path) -> None:
    assert title(opened_feed(log(tmp_path))) == ("Museum guide", ["Hello", "Go"])


def test_a_log_that_has_lost_its_experiment_shows_it_as_it_still_is(tmp_path: Path) -> None:
    assert title(opened_feed(log(tmp_path, whole=False))) == ("Guide", ["Hello", "Bye"])


def test_a_log_that_has_lost_an_experiment_that_is_gone_has_no_panels(tmp_path: Path) -> None:
    path = log(tmp_path, whole=False)
    (tmp_path / "tale.yaml").unlink()
    assert title(opened_feed(path)) == ("tale", [])


def test_an_experiment_that_is_gone_stands_against_nothing(tmp_path: Path) -> None:
    path = log(tmp_path)
    (tmp_path / "tale.yaml").unlink()
    assert title(opened_feed(path)) == ("Museum guide", ["Hello", "Go"])


def test_a_changed_experiment_is_refused_with_what_has_changed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = log(tmp_path)
    file = tmp_path / "tale.yaml"
    file.write_text(GUIDE.replace("say: Bye", "say: Goodbye"), encoding="utf-8")
    assert opened_feed(path) is None
    said = capsys.readouterr().err
    assert "tale.yaml has changed since the session was played" in said
    assert "-      - {key: b, label: Bye, say: Bye}" in said
    assert "+      - {key: b, label: Bye, say: Goodbye}" in said
    assert "--changed" in said
    assert title(opened_feed(path, "--changed")) == ("Museum guide", ["Hello", "Go"])


def test_of_a_log_that_has_lost_its_experiment_only_the_hashes_can_be_compared(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = log(tmp_path, whole=False)
    (tmp_path / "tale.yaml").write_text(GUIDE + "# edited\n", encoding="utf-8")
    assert opened_feed(path) is None
    assert "its hash was" in capsys.readouterr().err
    assert title(opened_feed(path, "--changed")) == ("tale", [])


def test_an_experiment_with_errors_is_not_the_one_of_then(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = log(tmp_path)
    (tmp_path / "tale.yaml").write_text("title: [\n", encoding="utf-8")
    assert opened_feed(path) is None
    said = capsys.readouterr().err
    assert "tale.yaml:" in said
    assert "has errors now" in said
    assert opened_feed(path, "--changed") is not None


def test_the_demo_that_comes_with_woz_counts_only_where_it_is_the_same(tmp_path: Path) -> None:
    path = log(tmp_path)
    (tmp_path / "tale.yaml").unlink()
    data = path.read_bytes()
    path.write_bytes(data.replace(b'"experiment":"tale.yaml"', b'"experiment":"bundled.yaml"'))
    with pytest.MonkeyPatch.context() as patch:
        bundled = tmp_path / "installed" / "bundled.yaml"
        bundled.parent.mkdir()
        bundled.write_text("title: Another one\n", encoding="utf-8")
        patch.setattr("woz_tui.cli.replay.bundled_file", lambda name: bundled)
        assert opened_feed(path) is not None


def test_the_experiment_may_be_said_to_be_elsewhere(tmp_path: Path) -> None:
    path = log(tmp_path)
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    (tmp_path / "tale.yaml").rename(elsewhere / "other.yaml")
    assert opened_feed(path, "--experiment", str(elsewhere / "other.yaml")) is not None


def test_a_log_without_its_beginning_is_refused_unless_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write_log(tmp_path, story()[3:])
    assert opened_feed(path) is None
    said = capsys.readouterr().err
    assert "has no beginning" in said
    assert "segment" in said
    feed = opened_feed(path, "--changed")
    assert feed is not None
    assert any("beginning is missing" in note for note in feed._player.notes)


def test_how_it_begins_can_be_said(tmp_path: Path) -> None:
    feed = opened_feed(
        log(tmp_path), "--at", "0:20", "--speed", "4x", "--paused", "--max-idle", "4"
    )
    assert feed is not None
    player = feed._player
    assert (player.t, player.rate, player.paused) == (20 * SECOND, 4.0, True)
    by_name = opened_feed(log(tmp_path), "--at", "smile")
    assert by_name is not None
    assert by_name._player.t == 6 * SECOND


def test_a_beginning_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(ReplayError, match="01:00 long"):
        opened_feed(log(tmp_path), "--at", "9:00")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--speed", "40"], "0.25 to 16"),
        (["--speed", "fast"], "not a number"),
        (["--max-idle", "0"], "above 0"),
    ],
)
def test_options_that_make_no_sense(
    words: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        arguments("x.jsonl", *words)
    assert said in capsys.readouterr().err
