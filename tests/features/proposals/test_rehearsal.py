"""Likely actions in a training, some of them wrong on purpose."""

from __future__ import annotations

import asyncio
from collections import Counter
from dataclasses import replace
from pathlib import Path

import pytest

from tests.analysis.example_sessions import SECOND, ExampleSession, figures_of, in_time
from tests.host.rig import served_session
from tests.session.rig import SessionRig, experiment
from woz_tui.features.proposals.kinds import (
    ProposedItem,
    SuggestGone,
    SuggestOffered,
    SuggestRehearsed,
    SuggestTaken,
)
from woz_tui.features.proposals.rehearsal import rehearsed
from woz_tui.features.proposals.report import REPORT
from woz_tui.features.proposals.section import PROPOSALS, Proposals, SuggestKeysOfFile
from woz_tui.features.training import training_course
from woz_tui.features.training.cue_plan import PlannedCue
from woz_tui.features.training.in_session import TrainingSession
from woz_tui.features.training.kinds import CueAnswered, CueGiven
from woz_tui.features.training.section import TRAINING, Training, TrainingCue


def given(number: int, *expects: str) -> CueGiven:
    return CueGiven(cue=f"q{number:04}", sort="question", expects=[*expects], window_us=4 * SECOND)


def test_half_of_the_cues_have_a_list_and_some_are_wrong(tmp_path: Path) -> None:
    made = experiment(tmp_path)
    names = ("Hello", "Welcome", "Map", "Fall", "Go")
    cues = tuple(TrainingCue("question", (name,)) for name in names)
    made = replace(made, sections={**made.sections, TRAINING: Training(cues=cues)})
    found = [rehearsed(given(n, "Map"), made, 0.25, seed=5) for n in range(400)]
    assert found == [rehearsed(given(n, "Map"), made, 0.25, seed=5) for n in range(400)]
    kinds = Counter("right" if each.right else "wrong" if each.actions else "" for each in found)
    assert 160 < kinds[""] < 240
    assert 0.15 < kinds["wrong"] / (kinds["wrong"] + kinds["right"]) < 0.35
    for each in found:
        assert ("Map" in each.actions) == each.right
        assert {*each.actions} <= {*names}, "each is plausible"
        assert len({*each.actions}) == len(each.actions)
    assert not [n for n in range(50) if rehearsed(given(n, "Map"), made, 1.0, seed=5).right]


@pytest.mark.real_clock
async def test_a_list_stands_there_until_the_cue_is_answered(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(training_course, "WARNING_S", 0.01)
    monkeypatch.setattr("woz_tui.features.proposals.rehearsal.SHARE", 1.0)
    section = Proposals(SuggestKeysOfFile(logs=True, after=0.0, wrong=1.0))
    made = experiment(tmp_path)
    made = replace(made, sections={**made.sections, PROPOSALS: section})
    async with served_session(tmp_path, made=made) as host:
        cue = PlannedCue("question", "", ("Hello",), 30_000_000, 1_000)
        missed = replace(cue, window_us=1_000)
        host.session.features.of(TrainingSession).train([cue, missed])
        wizard = await host.connect()
        await wizard.hello("wizard")
        assert (await wizard.ask("training"))["ok"]
        await host.until(lambda: [each for each in host.of(SuggestOffered) if each.cue])
        planted = next(each for each in host.of(SuggestOffered) if each.cue)
        assert planted.cue == "training/q0001"
        names = [item.action for item in planted.items]
        assert names
        assert "Hello" not in names
        assert (await wizard.ask("action", action=names[0], source="key"))["ok"]
        await host.until(lambda: len(host.of(CueAnswered)) == 2)
        taken = [line.how for line in host.of(SuggestTaken) if line.set == planted.set]
        assert taken == ["own_key"]
        await host.session.close("test", rest=False)
        ends = [line.set for line in host.of(SuggestTaken)]
        ends += [line.set for line in host.of(SuggestGone)]
        assert sorted(ends) == [line.set for line in host.of(SuggestOffered)]
        assert [line.fits for line in host.of(SuggestRehearsed)] == [False, False]


def test_the_report_says_how_many_planted_ones_were_taken() -> None:
    session = ExampleSession(participant="TRAINING")
    story = (
        ("right", True, "right"),
        ("wrong", True, "wrong"),
        ("wrong", False, "right"),
        ("none", False, "right"),
    )
    for number, (kind, taken, judged) in enumerate(story):
        at, cue, name = number * 10.0, f"q{number}", f"s{number}"
        actions = [] if kind == "none" else ["Hello" if kind == "right" else "Map"]
        session.add(at, CueGiven(cue=cue, sort="question", expects=["Hello"], window_us=SECOND))
        session.add(at, SuggestRehearsed(cue=cue, items=actions, fits=kind == "right"))
        if actions:
            items = [ProposedItem("1", action=actions[0])]
            offered = SuggestOffered(set=name, source="logs", items=items, cue=f"training/{cue}")
            session.add(at + 1, offered)
        session.add(at + 2, CueAnswered(cue=cue, judged=judged, reaction_us=2 * SECOND))
        if actions:
            end = SuggestTaken(set=name, item="1", how="own_key")
            session.add(at + 2, end if taken else SuggestGone(set=name, how="other_act"))
    figures = figures_of(in_time(session.end(60))).features["proposals"]
    *_, table = REPORT.session_tables(figures)
    rows = {str(row[0]): [*map(str, row)][1:6] for row in table.rows}
    assert rows["right"] == ["1", "1", "1", "0", "1 (100.0 %)"]
    assert rows["wrong"] == ["2", "2", "1", "1", "1 (50.0 %)"]
    assert rows["none"][0] == "1"


def test_no_list_comes_where_the_file_wants_none_any_more(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("woz_tui.features.proposals.rehearsal.SHARE", 1.0)
    plain = experiment(tmp_path)
    section = Proposals(SuggestKeysOfFile(logs=True, after=2.0, wrong=1.0))
    made = replace(plain, sections={**plain.sections, PROPOSALS: section})

    async def scenario(rig: SessionRig) -> None:
        rig.session.hub.publish(given(1, "Hello"))
        rig.session.adopt(plain, [])
        await asyncio.sleep(5)

    rig = SessionRig(tmp_path, made=made).run(scenario)
    assert len(rig.of(SuggestRehearsed)) == 1
    assert [each.cue for each in rig.of(SuggestOffered) if each.cue] == []
