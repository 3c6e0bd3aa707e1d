"""The museum guide alone with its visitors: the whole model, without a hand on the keyboard."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from pathlib import Path

import pytest

from tools import guide_session
from woz_tui.config.loading import load
from woz_tui.drivers.plugins import installed
from woz_tui.protocol import messages as m
from woz_tui.sensing.engagement_stream import EngagementFollower
from woz_tui.sensing.state_machine import EDGES
from woz_tui.session.session import Session

SIX_MINUTES = 360.0


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    return [tmp_path_factory.mktemp("guide") for _ in range(2)]


@pytest.fixture(scope="module")
def twice(folders: list[Path]) -> list[list[m.Message]]:
    """Two sessions of six minutes, each with visitors of its own."""
    return [guide_session.played(folder, SIX_MINUTES) for folder in folders]


def changes(messages: list[m.Message]) -> Iterator[m.EngagementChanged]:
    return (each for each in messages if isinstance(each, m.EngagementChanged))


def test_six_minutes_are_the_same_twice(twice: list[list[m.Message]]) -> None:
    """The same visitors bring the same states, at the same times, for the same reasons."""
    first, second = (list(changes(messages)) for messages in twice)
    assert [(each.t, each.now, each.why) for each in first] == [
        (each.t, each.now, each.why) for each in second
    ]
    assert guide_session.path(twice[0]) == guide_session.path(twice[1])
    assert len(first) > 20


@pytest.mark.usefixtures("twice")
def test_its_log_stays_where_it_began(folders: list[Path]) -> None:
    """Minutes pass at once, which is not the disk's fault."""
    logs = {path.relative_to(folders[0]) for path in folders[0].rglob("*.jsonl")}
    assert logs == {Path("recordings/made.jsonl"), Path("recordings/made.samples.jsonl")}


def test_every_state_is_entered_by_edges_of_the_table(twice: list[list[m.Message]]) -> None:
    """E5: every step of the path is an edge, and the whole conversation happens."""
    edges = {(edge.source.value, edge.target.value, edge.outcome) for edge in EDGES}
    taken = {(each.was, each.now, each.outcome) for each in changes(twice[0])}
    assert taken <= edges
    assert {now for _, now, _ in taken} == {
        *("Wait", "PersonDetected", "EngagedWithUnknown", "Handshake", "EngagedWithKnown"),
        *("UserSpeaks", "RobotThinks", "RobotReplies", "RobotSpeaks"),
    }


def test_nothing_fails_and_nobody_presses_a_key(twice: list[list[m.Message]]) -> None:
    bad = (m.Failed, m.TimedOut, m.ActionFailed, m.ActionRefused)
    assert not [each for each in twice[0] if isinstance(each, bad)]
    assert not [each for each in twice[0] if isinstance(each, m.Notice) and each.level != "info"]
    sources = {each.source for each in twice[0] if isinstance(each, m.Command)}
    assert sources == {"engagement"}


def test_every_signal_comes_within_a_third_of_a_second(twice: list[list[m.Message]]) -> None:
    """E6: eyes and picture of each state follow at once, and a beep ends each utterance."""
    sent = {(each.verb, each.t): each.args for each in twice[0] if isinstance(each, m.Command)}
    for change in changes(twice[0]):
        if change.t >= SIX_MINUTES * 1_000_000:
            continue  # the session ends with it
        for verb in ("eyes", "screen"):
            assert (verb, change.t) in sent or any(
                name == verb and change.t <= t <= change.t + 333_000 for name, t in sent
            )
    beeps = [t for (verb, t) in sent if verb == "sound"]
    assert beeps == [each.t for each in changes(twice[0]) if each.now == "RobotThinks"]


def test_strangers_are_introduced_and_known_when_they_come_again(
    twice: list[list[m.Message]],
) -> None:
    known = [each for each in twice[0] if isinstance(each, m.VisitorChanged)]
    learnt = [each.visitor for each in known if each.what == "learnt"]
    assert learnt
    assert len(set(learnt)) == len(learnt)
    first = next(each for each in known if each.what == "learnt")
    assert any(
        each.visitor == first.visitor and each.what == "met" and each.t > first.t for each in known
    )


def test_whoever_reads_the_log_comes_to_the_same(twice: list[list[m.Message]]) -> None:
    experiment = load(guide_session.GUIDE, installed())
    assert experiment.engagement is not None
    follower = EngagementFollower(experiment.engagement.settings)
    found = [change for message in twice[0] for change in follower.apply(message)]
    assert [(each.t, each.was, each.now, each.outcome, each.why) for each in found] == [
        (each.t, each.was, each.now, each.outcome, each.why) for each in changes(twice[0])
    ]


def test_it_goes_on_by_itself_after_a_stop_in_the_middle_of_thinking(tmp_path: Path) -> None:
    def pressing(session: Session, message: m.Message) -> None:
        thinks = isinstance(message, m.EngagementChanged) and message.now == "RobotThinks"
        if thinks and not session.bus.latched:
            loop = asyncio.get_running_loop()
            loop.call_later(1, session.stop, "wizard")
            loop.call_later(3, session.release, "wizard")

    seen = list(changes(guide_session.played(tmp_path, 200.0, pressing)))
    ways = [(each.was, each.outcome) for each in seen]
    assert ("RobotThinks", "done") not in ways
    given_up = [outcome for was, outcome in ways if was == "RobotThinks"]
    assert len(given_up) > 1
    assert "error" in given_up
