"""What is due behind which trial, and what a next trial, participant or file makes of it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from tests.features.questionnaires.rig import due, history, on_stage, questionnaires
from tests.session.rig import SessionRig
from tests.session.study_rig import short_messages, trial_control
from woz_tui.features.questionnaires.history import DueQuestionnaire
from woz_tui.features.study.design import Design
from woz_tui.features.study.section import DESIGN
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError


def assign_participant(rig: SessionRig, participant: str = "P01") -> None:
    order = [*trial_control(rig.session).propose(participant).order]
    trial_control(rig.session).assign(participant, order)


def trials(rig: SessionRig, *outcomes: str) -> None:
    for outcome in outcomes:
        trial_control(rig.session).trial("begin", "")
        trial_control(rig.session).trial(outcome, "")


@pytest.mark.parametrize(
    ("outcomes", "expected"),
    [
        (["done"], [DueQuestionnaire("each", 1)]),
        (["done", "aborted"], []),
        (["excluded"], []),
        (["done", "excluded"], [DueQuestionnaire("ux", 2)]),
        (["done", "done"], [DueQuestionnaire("each", 2), DueQuestionnaire("ux", 2)]),
        (["done", "done", "done"], [DueQuestionnaire("each", 3)]),
        (
            ["done"] * 4,
            [DueQuestionnaire("each", 4), DueQuestionnaire("ux", 4), DueQuestionnaire("last", -1)],
        ),
        (["done"] * 3 + ["excluded"], [DueQuestionnaire("ux", 4), DueQuestionnaire("last", -1)]),
    ],
)
def test_what_is_due_behind_the_trials(
    tmp_path: Path, outcomes: list[str], expected: list[DueQuestionnaire]
) -> None:
    async def scenario(rig: SessionRig) -> None:
        assign_participant(rig)
        trials(rig, *outcomes)
        assert due(rig) == expected

    on_stage(tmp_path, scenario)


def test_what_was_due_is_so_no_more_once_the_next_trial_has_begun(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        assign_participant(rig)
        trials(rig, "done")
        assert due(rig) == [DueQuestionnaire("each", 1)]
        trial_control(rig.session).trial("begin", "")
        assert due(rig) == []

    on_stage(tmp_path, scenario)


def test_a_trial_for_practice_is_the_last_of_no_condition(tmp_path: Path) -> None:
    """Trial 0 has no place in the order."""

    async def scenario(rig: SessionRig) -> None:
        assign_participant(rig)
        rig.session.set(trial=0)
        trials(rig, "done")
        assert due(rig) == [DueQuestionnaire("each", 0)]

    rig = on_stage(tmp_path, scenario)
    assert short_messages(rig, m.TrialStarted) == ["trial.started 0 warm"]


def test_the_next_participant_has_had_nothing_yet(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        assign_participant(rig)
        questionnaires(rig).begin_or_end("whenever", "begin", "wizard")
        questionnaires(rig).begin_or_end("whenever", "declined", "wizard")
        assert {*history(rig).had} == {"whenever"}
        rig.session.set("P02")
        assert {*history(rig).had} == set()

    on_stage(tmp_path, scenario)


def test_the_number_of_the_trial_can_be_said(tmp_path: Path) -> None:
    """It is a variable of utterances, also where the condition stays the same."""

    async def scenario(rig: SessionRig) -> None:
        assign_participant(rig)
        trials(rig, "done")
        trial_control(rig.session).trial("begin", "")
        assert rig.session.values()["trial"] == "2"

    on_stage(tmp_path, scenario)


def test_whoever_is_through_keeps_the_last_condition(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        study = trial_control(rig.session)
        assign_participant(rig)
        trials(rig, *["done"] * 4)
        assign_participant(rig)
        assert (study.state.condition, study.state.next_trial) == ("cold", 5)

    on_stage(tmp_path, scenario)


def test_a_proposal_of_the_file_as_it_was_is_no_proposal(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        study = trial_control(rig.session)
        order = [*study.propose("P01").order]
        design = Design(order="fixed", trials=3)
        rig.session.adopt(
            replace(
                rig.session.experiment,
                sections={**rig.session.experiment.sections, DESIGN: design},
            ),
            ["design"],
        )
        study.assign("P01", order)

    rig = on_stage(tmp_path, scenario)
    (line,) = (line for line in rig.of(m.ConditionsAssigned))
    assert (line.method, line.row) == ("hand", -1)


def test_nobody_gets_another_order_while_a_trial_is_under_way(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        assign_participant(rig)
        trial_control(rig.session).trial("begin", "")
        with pytest.raises(RequestError, match="trial 1 is running"):
            trial_control(rig.session).assign("P01", ["cold", "warm"])

    assert short_messages(on_stage(tmp_path, scenario), m.ConditionsAssigned) == [
        "condition.assigned"
    ]


def test_where_everybody_gets_one_condition_one_is_assigned(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        with pytest.raises(RequestError, match="each participant gets one condition"):
            trial_control(rig.session).assign("P01", ["warm", "cold"])
        trial_control(rig.session).assign("P01", ["cold"])
        trials(rig, "done", "done")
        assert [each.questionnaire for each in due(rig)] == [*("each", "ux", "last")]

    design = Design(order="blocks", within=False, trials=2)
    rig = on_stage(tmp_path, scenario, design=design)
    assert short_messages(rig, m.TrialStarted) == ["trial.started 1 cold", "trial.started 2 cold"]
