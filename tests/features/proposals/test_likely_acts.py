"""Likely actions in a session: learnt from logs, offered by their own keys."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import pytest

from tests.session.rig import SessionRig, experiment
from woz_tui.config.experiment import Experiment
from woz_tui.features.proposals.earlier_acts import earlier_acts
from woz_tui.features.proposals.kinds import (
    SuggestGone,
    SuggestOffered,
    SuggestRanked,
    SuggestTaken,
)
from woz_tui.features.proposals.section import PROPOSALS, Proposals, SuggestKeysOfFile
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError
from woz_tui.session.participant_identity import SessionIdentity
from woz_tui.withdrawal.removal import planned, withdraw
from woz_tui.withdrawal.stored_files import stored_files

KEY = RequestOrigin("key", "h", "con1")


@pytest.fixture(autouse=True)
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache" / "woz-tui" / "logs" / "acts"


def learning(folder: Path) -> Experiment:
    made = experiment(folder)
    section = Proposals(SuggestKeysOfFile(logs=True, after=1.0))
    return replace(made, sections={**made.sections, PROPOSALS: section})


def say(rig: SessionRig, text: str) -> None:
    rig.session.hub.publish(m.SpeechText(driver="ear", segment=1, text=text))


def earlier(tmp_path: Path, *actions: str, words: str = "") -> None:
    async def scenario(rig: SessionRig) -> None:
        for name in actions:
            if words and name == actions[-1]:
                say(rig, words)
            rig.session.play(name, KEY)
            await asyncio.sleep(3)

    number = len([*(tmp_path / "recordings").glob("*.samples.jsonl")]) + 1
    SessionRig(
        tmp_path,
        made=experiment(tmp_path),
        stem=f"2026-01-01T10-00-00_P07_S{number:02}",
        identity=SessionIdentity(f"S{number:02}", "P07", "warm"),
    ).run(scenario, 3)


def session(tmp_path: Path, scenario: Callable[[SessionRig], object]) -> SessionRig:
    async def whole(rig: SessionRig) -> None:
        # A thread reads: where a time limit waited for it, virtual time would fly past.
        while not rig.of(SuggestOffered):  # noqa: ASYNC110
            await asyncio.sleep(0)
        result = scenario(rig)
        if asyncio.iscoroutine(result):
            await result

    rig = SessionRig(tmp_path, made=learning(tmp_path), stem="2026-03-01T10-00-00_P07_S09")
    return rig.run(whole, 3)


def lists(rig: SessionRig) -> list[list[str]]:
    return [[item.action for item in line.items] for line in rig.of(SuggestOffered)]


def test_the_script_is_offered_where_nothing_was_learnt(tmp_path: Path) -> None:
    rig = session(tmp_path, lambda rig: None)
    assert lists(rig)[0][0] == "Hello"
    assert [line.how for line in rig.of(SuggestGone)] == ["end"]


def test_what_followed_in_earlier_sessions_is_offered_and_taken_by_its_own_key(
    tmp_path: Path,
) -> None:
    for _ in range(3):
        earlier(tmp_path, "Hello", "Map", "Welcome", "Go")

    async def scenario(rig: SessionRig) -> None:
        rig.session.play("Hello", KEY)
        await asyncio.sleep(3)
        rig.session.play("Map", KEY)
        await asyncio.sleep(3)

    rig = session(tmp_path, scenario)
    assert "Map" in lists(rig)[1]
    taken = rig.of(SuggestTaken)
    assert (taken[0].how, taken[0].set) == ("own_key", "s00001")
    runs = {line.run for line in rig.of(m.ActionRequested)}
    assert {line.run for line in taken} <= runs
    ranked = {line.set: line for line in rig.of(SuggestRanked)}
    for offer in rig.of(SuggestOffered):
        assert len(ranked[offer.set].scores) == len(offer.items)
    ends = [line.set for line in rig.of(SuggestTaken)] + [line.set for line in rig.of(SuggestGone)]
    assert sorted(ends) == [line.set for line in rig.of(SuggestOffered)]


def test_a_refused_key_is_no_act(tmp_path: Path) -> None:
    """Nothing was played: what is offered stays, and the next list does not count it."""

    async def scenario(rig: SessionRig) -> None:
        rig.session.set_lock("Speech", locked=True, source="test")
        with pytest.raises(RequestError):
            rig.session.play("Hello", KEY)
        await asyncio.sleep(1)
        assert lists(rig) == [lists(rig)[0]]
        rig.session.set_lock("Speech", locked=False, source="test")
        rig.session.play("Hello", KEY)
        await asyncio.sleep(3)

    rig = session(tmp_path, scenario)
    (taken,) = rig.of(SuggestTaken)
    assert (taken.how, taken.run) == ("own_key", rig.of(m.ActionRequested)[1].run)


def test_what_was_read_for_a_file_that_is_read_again_is_thrown_away(tmp_path: Path) -> None:
    async def scenario() -> SessionRig:
        loop, read = asyncio.get_running_loop(), threading.Event()
        with ThreadPoolExecutor(1) as threads:
            loop.set_default_executor(threads)
            busy = loop.run_in_executor(None, read.wait)
            async with SessionRig(tmp_path, made=learning(tmp_path)) as rig:
                off = Proposals(SuggestKeysOfFile(logs=False))
                sections = {**rig.experiment.sections, PROPOSALS: off}
                rig.session.adopt(replace(rig.experiment, sections=sections), ["suggest"])
                read.set()
                await busy
                await loop.run_in_executor(None, lambda: None)  # behind what reads logs
                rig.session.play("Hello", KEY)
                await rig.until(lambda: rig.of(m.ActionDone))
        return rig

    assert asyncio.run(scenario()).of(SuggestOffered) == []


def test_words_are_answered_after_a_while(tmp_path: Path) -> None:
    for _ in range(2):
        earlier(tmp_path, "Hello", "Map", words="where are the toilets please")

    async def scenario(rig: SessionRig) -> None:
        rig.session.play("Hello", KEY)
        await asyncio.sleep(2)
        before = len(rig.of(SuggestOffered))
        say(rig, "The toilets, where?")
        await asyncio.sleep(0.9)
        assert len(rig.of(SuggestOffered)) == before, "the wizard thinks first"
        await asyncio.sleep(0.2)
        assert len(rig.of(SuggestOffered)) == before + 1

    rig = session(tmp_path, scenario)
    last = rig.of(SuggestOffered)[-1]
    assert (last.items[0].action, last.cue) == ("Map", "ear/1")


@pytest.mark.parametrize(
    "section", [None, Proposals(SuggestKeysOfFile(logs=False))], ids=["gone", "without logs"]
)
def test_a_file_that_wants_no_likely_actions_any_more_is_offered_none(
    tmp_path: Path, section: Proposals | None
) -> None:
    for _ in range(2):
        earlier(tmp_path, "Hello", "Map", words="where are the toilets please")
    ends: list[int] = []

    async def scenario(rig: SessionRig) -> None:
        say(rig, "The toilets, where?")
        await asyncio.sleep(0.5)  # nothing is proposed yet
        made = learning(tmp_path)
        rig.session.adopt(replace(made, sections={**made.sections, PROPOSALS: section}), [])
        ends.append(len(rig.of(SuggestOffered)))
        rig.session.play("Hello", KEY)
        await asyncio.sleep(5)

    rig = session(tmp_path, scenario)
    assert [len(rig.of(SuggestOffered))] == ends
    assert rig.of(m.Done)


@pytest.mark.parametrize(
    "before", [SuggestKeysOfFile(within=9.0), SuggestKeysOfFile(logs=True)], ids=["other", "logs"]
)
def test_what_was_played_before_the_file_was_read_again_counts(
    tmp_path: Path, before: SuggestKeysOfFile
) -> None:
    """Whether the file wanted likely actions then or not, and while earlier sessions are read."""
    for _ in range(3):
        earlier(tmp_path, "Hello", "Map", "Welcome", "Go")

    async def scenario(rig: SessionRig) -> None:
        for name in ("Hello", "Map"):
            rig.session.play(name, KEY)
            await asyncio.sleep(3)
        count = len(rig.of(SuggestOffered))
        rig.session.adopt(learning(tmp_path), ["suggest"])
        rig.session.play("Welcome", KEY)
        while len(rig.of(SuggestOffered)) == count:  # noqa: ASYNC110 - a thread reads
            await asyncio.sleep(0)

    made = experiment(tmp_path)
    made = replace(made, sections={**made.sections, PROPOSALS: Proposals(before)})
    rig = SessionRig(tmp_path, made=made, stem="2026-03-01T10-00-00_P07_S09").run(scenario, 3)
    assert lists(rig)[-1][0] == "Go"


def test_the_robots_own_words_and_mistakes_do_not_count(tmp_path: Path) -> None:
    earlier(tmp_path, "Hello", "Map")

    async def scenario(rig: SessionRig) -> None:
        before = len(rig.of(SuggestOffered))
        rig.session.hub.publish(m.SpeechText(driver="ear", segment=1, text="toilets", own=True))
        await asyncio.sleep(2)
        assert len(rig.of(SuggestOffered)) == before

    session(tmp_path, scenario)


def test_a_log_is_read_once_and_forgotten_when_it_has_gone(tmp_path: Path, own_cache: Path) -> None:
    earlier(tmp_path, "Hello", "Map", words="an unusual word")
    logs = tmp_path / "recordings"
    first = earlier_acts([logs], "Made by hand", "made.yaml")
    assert [act.action for act in first.sessions[0]] == ["Hello", "Map"]
    (kept,) = own_cache.iterdir()
    assert "unusual" not in kept.read_text(), "no words of anybody"
    assert kept.stat().st_mode & 0o077 == 0
    kept.write_text(kept.read_text().replace("Map", "Cached"))
    assert earlier_acts([logs], "Made by hand", "made.yaml").sessions[0][1].action == "Cached"
    assert earlier_acts([logs], "Another title", "other.yaml").sessions == ()
    for path in logs.iterdir():
        path.unlink()
    assert earlier_acts([logs], "Made by hand", "made.yaml").sessions == ()
    assert [*own_cache.iterdir()] == []


def test_what_was_kept_goes_with_its_log_beyond_the_newest(
    tmp_path: Path, own_cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("Hello", "Map", "Welcome"):
        earlier(tmp_path, name)
    logs = tmp_path / "recordings"
    earlier_acts([logs], "Made by hand", "made.yaml")
    monkeypatch.setattr("woz_tui.features.proposals.earlier_acts.MOST", 1)
    earlier_acts([logs], "Made by hand", "made.yaml")
    assert len([*own_cache.iterdir()]) == 3, "of a log that is there it stays"
    for path in logs.glob("*_S01.*"):
        path.unlink()
    earlier_acts([logs], "Made by hand", "made.yaml")
    assert len([*own_cache.iterdir()]) == 2


def test_a_withdrawal_removes_all_that_was_kept(tmp_path: Path, own_cache: Path) -> None:
    earlier(tmp_path, "Hello")
    logs = tmp_path / "recordings"
    earlier_acts([logs], "Made by hand", "made.yaml")
    assert [*own_cache.iterdir()]
    withdraw(planned(stored_files([logs], ["P07"]), "P07"), logs, "2026-12-01")
    assert [*own_cache.iterdir()] == []


def test_nothing_is_read_where_the_file_does_not_say_so(tmp_path: Path, own_cache: Path) -> None:
    earlier(tmp_path, "Hello")
    assert not own_cache.exists()
