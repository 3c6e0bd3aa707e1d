"""`trials: half`: in half of the trials, drawn by chance, nothing is offered."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from tests.analysis.example_sessions import ExampleSession, figures_of, in_time
from tests.session.rig import SessionRig
from tests.session.study_rig import on_stage, trial_control
from woz_tui.features.proposals.figures import FIGURES
from woz_tui.features.proposals.gathered import GatheredProposals
from woz_tui.features.proposals.halves import HALF, is_offered
from woz_tui.features.proposals.in_session import ProposalsInSession
from woz_tui.features.proposals.kinds import (
    AskPropose,
    ProposedItem,
    SuggestGone,
    SuggestOffered,
    SuggestTrial,
)
from woz_tui.features.proposals.section import PROPOSALS, Proposals, SuggestKeysOfFile
from woz_tui.features.study.design import Design
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError
from woz_tui.session.participant_identity import SessionIdentity
from woz_tui.session.session_features import Client


def test_of_each_two_trials_one_is_drawn() -> None:
    for seed in range(50):
        drawn = [is_offered(trial, "P07", seed) for trial in range(1, 9)]
        assert [sum(drawn[i : i + 2]) for i in range(0, 8, 2)] == [1, 1, 1, 1]
    firsts = [is_offered(1, "P07", seed) for seed in range(400)]
    assert 150 < sum(firsts) < 250
    by_participant = {is_offered(1, f"P{n:02}", 0) for n in range(10)}
    assert by_participant == {True, False}, "also where each has one trial and the same seed"


def test_where_it_was_not_drawn_nothing_is_offered(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        proposals = rig.session.features.of(ProposalsInSession)
        program = Client("con1", "program", "greeter")
        trial_control(rig.session).assign("P01", ["warm", "cold"])
        for trial in range(1, 5):
            trial_control(rig.session).trial("begin", "")
            asked = AskPropose(texts=["Hello"])
            if is_offered(trial, "P01", 3):
                proposals.carry_out(asked, program)
            else:
                with pytest.raises(RequestError, match="in this trial nothing is proposed"):
                    proposals.carry_out(asked, program)
            trial_control(rig.session).trial("done", "")

    section = Proposals(SuggestKeysOfFile(trials=HALF))
    rig = on_stage(
        tmp_path,
        scenario,
        identity=SessionIdentity(participant="P01", seed=3),
        sections={PROPOSALS: section},
        design=Design(trials=2),
    )
    drawn = [(line.trial, line.offered) for line in rig.of(SuggestTrial)]
    assert drawn == [(trial, is_offered(trial, "P01", 3)) for trial in range(1, 5)]
    assert len(rig.of(SuggestOffered)) == len(rig.of(SuggestGone)) == 2


def test_a_quiet_trial_ends_also_where_the_file_wants_no_proposals_meanwhile(
    tmp_path: Path,
) -> None:
    quiet = next(trial for trial in (1, 2) if not is_offered(trial, "P01", 3))

    async def scenario(rig: SessionRig) -> None:
        proposals = rig.session.features.of(ProposalsInSession)
        program, asked = Client("con1", "program", "greeter"), AskPropose(texts=["Hello"])
        trial_control(rig.session).assign("P01", ["warm", "cold"])
        for _ in range(1, quiet):
            trial_control(rig.session).trial("begin", "")
            trial_control(rig.session).trial("done", "")
        trial_control(rig.session).trial("begin", "")
        made = rig.session.experiment
        rig.session.adopt(replace(made, sections={**made.sections, PROPOSALS: None}), [])
        trial_control(rig.session).trial("done", "")
        rig.session.adopt(made, [])
        proposals.carry_out(asked, program)

    rig = on_stage(
        tmp_path,
        scenario,
        identity=SessionIdentity(participant="P01", seed=3),
        sections={PROPOSALS: Proposals(SuggestKeysOfFile(trials=HALF))},
        design=Design(trials=2),
    )
    assert len(rig.of(SuggestOffered)) == 1


def session(participant: str, offered_s: float, without_s: float) -> ExampleSession:
    """Two trials with a cue each, and the reaction times in them."""
    told = ExampleSession(participant=participant)
    for trial, (offered, reaction) in enumerate(((True, offered_s), (False, without_s)), 1):
        at = 20.0 * trial
        told.add(at, m.TrialStarted(trial=trial, condition="warm"))
        told.add(at, SuggestTrial(trial=trial, offered=offered))
        if offered:
            item = ProposedItem("1", action="Hello")
            told.add(at + 1, SuggestOffered(set="s1", source="logs", items=[item]))
            told.add(at + 1, SuggestGone(set="s1", how="expired"))
        told.speech(at + 2, at + 4, trial)
        told.act(at + 4 + reaction, "Hello")
        told.add(at + 15, m.TrialEnded(trial=trial, outcome="done"))
    return told


def test_time_saved_is_the_difference_between_trials_that_were_drawn() -> None:
    gathered, found = GatheredProposals(), []
    for who, offered, without in (("P01", 1.0, 2.0), ("P02", 2.0, 2.5), ("P03", 1.5, 3.0)):
        figures = figures_of(in_time(session(who, offered, without).end(70)))
        found.append(figures.features["proposals"])
        gathered.add("study", figures)
    _, table = gathered.tables("study", ())
    assert [[*map(str, row)][1:4] for row in table.rows] == [
        ["3", "3", "3"],
        ["3", "3", "3"],
        ["", "3", ""],
    ]
    assert table.rows[-1][-1].startswith("-1.00 s [-2.24, 0.24]")
    assert "in 3 of 6 trials, drawn by chance," in next(iter(FIGURES.methods(found)))
