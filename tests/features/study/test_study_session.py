"""Orders, trials, breaks and the preflight list in a session."""

from __future__ import annotations

import asyncio
import re
from dataclasses import replace
from pathlib import Path

import pytest

from tests.log.failing_disks import FaultyDisk
from tests.session.rig import SessionRig
from tests.session.study_rig import (
    PLANNED,
    STUDY,
    had,
    log,
    on_stage,
    renamed,
    short_messages,
    study_experiment,
    trial_control,
)
from woz_tui.config.study import PerceptionLimits, Study
from woz_tui.features.study.section import DESIGN
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError
from woz_tui.protocol.welcome import PreflightCheck
from woz_tui.session.participant_identity import SessionIdentity
from woz_tui.session.preflight import preflight
from woz_tui.session.session_plan import study_snapshot
from woz_tui.timeline.study_history import StudyState

KEY = RequestOrigin("key", "h", "con1")
TRIALS = (m.ConditionsAssigned, m.TrialStarted, m.TrialEnded, m.BreakStarted, m.BreakEnded)


def test_a_line_that_plans_any_number_of_trials_costs_nothing() -> None:
    study = StudyState()
    order = ["warm", "cold"]
    study.assign(
        m.ConditionsAssigned(
            participant="P01", order=order, method="hand", trials=1 << 40, over=[1, 2, 4]
        )
    )
    assert study.next_trial == 3
    assert study.trials_left == 2 * (1 << 40) - 3


def refusal_reason(rig: SessionRig, *asks: str) -> str:
    """Why a trial's ask is refused."""
    with pytest.raises(RequestError) as caught:
        for what in asks:
            trial_control(rig.session).trial(what, "")
    return f"{caught.value.reason}; {caught.value.hint}".rstrip("; ")


def assign_participant(rig: SessionRig, participant: str = "P01") -> None:
    order = [*trial_control(rig.session).propose(participant).order]
    trial_control(rig.session).assign(participant, order)


def test_a_whole_participant(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        study = trial_control(rig.session)
        assign_participant(rig)
        assert study.state.planned == 4
        for what in ("begin", "done", "begin", "aborted", "begin", "excluded", "break", "resume"):
            study.trial(what, "")
        for _ in range(2):
            study.trial("begin", "")
            study.trial("done", "")
        assert refusal_reason(rig, "begin") == (
            "all 4 trials of P01 are done; choose the next participant,"
            " or set a trial number to repeat a trial"
        )
        rig.session.set(trial=2)
        study.trial("begin", "")
        study.trial("done", "")
        assert "all 4 trials of P01 are done" in refusal_reason(rig, "begin")

    rig = on_stage(tmp_path, scenario)
    assert short_messages(rig, *TRIALS) == [
        "condition.assigned",
        "trial.started 1 warm",
        "trial.ended 1 done",
        "trial.started 2 warm",
        "trial.ended 2 aborted",
        "trial.started 2 warm",
        "trial.ended 2 excluded",
        "break.started",
        "break.ended",
        "trial.started 3 cold",
        "trial.ended 3 done",
        "trial.started 4 cold",
        "trial.ended 4 done",
        "trial.started 2 warm",
        "trial.ended 2 done",
    ]
    (order,) = (line for line in rig.of(m.ConditionsAssigned))
    assert (order.method, order.row, order.order) == ("latin-square", 0, ["warm", "cold"])
    assert {line.planned for line in rig.of(m.TrialStarted)} == {4}


def test_the_condition_of_a_trial_is_set_before_it_begins(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        assign_participant(rig)
        for what in ("begin", "done", "begin", "done"):
            trial_control(rig.session).trial(what, "")
        rig.session.set(condition="warm")
        rig.session.play("Greet", KEY)
        trial_control(rig.session).trial("begin", "")
        await asyncio.sleep(2)
        rig.session.play("Greet", KEY)

    rig = on_stage(tmp_path, scenario)
    texts = [args["text"] for verb, args in rig.driver().calls if verb == "say"]
    assert texts == ["Hello P01! I am in the museum.", "Hello. I am in the museum."]
    changed = rig.of(m.SessionChanged, m.TrialStarted)
    last = changed[-2:]
    assert isinstance(last[0], m.SessionChanged)
    assert (last[0].condition, last[0].trial) == ("cold", 3)


@pytest.mark.parametrize(("order", "over"), [(["warm", "cold"], 1), (["cold", "warm"], 2)])
def test_a_condition_that_is_not_in_the_file_any_more_begins_no_trial_and_is_not_named(
    tmp_path: Path, order: list[str], over: int
) -> None:
    """The one that holds already, and one that comes next."""

    async def scenario(rig: SessionRig) -> None:
        trial_control(rig.session).assign("P01", order)
        for _ in range(over):
            trial_control(rig.session).trial("begin", "")
            trial_control(rig.session).trial("done", "")
        rig.session.adopt(renamed(tmp_path), [])
        with pytest.raises(RequestError) as caught:
            trial_control(rig.session).trial("begin", "")
        assert caught.value.command == "start"
        said = f"{caught.value.reason}; {caught.value.hint}"
        assert "P01" in said
        assert not {"warm", "friendly"} & {*re.findall(r"\w+", said)}

    assert len(short_messages(on_stage(tmp_path, scenario), m.TrialStarted)) == over


def test_behind_a_trial_out_of_turn_comes_the_first_that_is_not_over(tmp_path: Path) -> None:
    """One that was run too early, and one that is run again after the break of a day."""
    log(
        tmp_path / "recordings",
        "2026-03-01T10-00-00_P01_S01",
        [*had("P01", ["warm", "cold"], "d", row=0)],
        title="Made by hand",
    )

    async def scenario(rig: SessionRig) -> None:
        study = trial_control(rig.session)
        assign_participant(rig)
        assert study.state.next_trial == 2
        for number, following in ((4, 2), (2, 3), (1, 3), (3, 5)):
            rig.session.set(trial=number)
            study.trial("begin", "")
            study.trial("done", "")
            assert study.state.next_trial == following
        assert study.state.trials_left == 0

    on_stage(tmp_path, scenario)


@pytest.mark.parametrize("trials", [1, 3, 0])
def test_a_reload_leaves_the_trials_of_the_participant_who_is_there(
    tmp_path: Path, trials: int
) -> None:
    """The file has more of them in each condition, fewer, or no design any more."""
    design = replace(PLANNED, trials=trials) if trials else None

    async def scenario(rig: SessionRig) -> None:
        study = trial_control(rig.session)
        study.assign("P01", ["warm", "cold"])
        for _ in range(3):
            study.trial("begin", "")
            study.trial("done", "")
        rig.session.adopt(study_experiment(tmp_path, design=design), [])
        study.trial("begin", "")
        study.trial("done", "")
        assert "all 4 trials of P01 are done" in refusal_reason(rig, "begin")

    rig = on_stage(tmp_path, scenario)
    begun = rig.of(m.TrialStarted)
    assert [(line.condition, line.planned) for line in begun] == [
        ("warm", 4), ("warm", 4), ("cold", 4), ("cold", 4),
    ]  # fmt: skip


def test_refusals(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        study = trial_control(rig.session)
        assert refusal_reason(rig, "begin") == "no participant is set; choose one first"
        rig.session.set("P05")
        assert (
            refusal_reason(rig, "begin")
            == "no condition is set; choose the participant's order first"
        )
        assert refusal_reason(rig, "done") == "no trial is running; start one"
        assert refusal_reason(rig, "resume") == "no break is running"
        assert refusal_reason(rig, "break", "break") == "a break is already running"
        rig.session.set(condition="cold")
        study.trial("begin", "")
        assert refusal_reason(rig, "begin") == "trial 1 is running; end it first"
        with pytest.raises(RequestError, match="trial 1 is running"):
            rig.session.set("P06")
        with pytest.raises(RequestError, match="trial 1 is running"):
            study.assign("P06", ["warm", "cold"])
        rig.session.set("P05")

    rig = on_stage(tmp_path, scenario)
    assert short_messages(rig, *TRIALS) == [
        "break.started",
        "break.ended",
        "trial.started 1 cold",
        "trial.ended 1 aborted",
    ]


@pytest.mark.parametrize(
    ("participant", "order", "reason"),
    [
        ("Anna", ["warm", "cold"], "'Anna' is not a code of this study"),
        ("Anna B.", ["warm", "cold"], "'Anna B.' is not a valid participant code"),
        ("P01", ["warm", "hot"], "there is no condition 'hot'"),
        ("P01", ["warm", "warm"], "the order has a condition twice"),
        ("P01", ["warm"], "each participant gets all conditions; the order lacks some"),
    ],
)
def test_orders_that_cannot_be_assigned(
    tmp_path: Path, participant: str, order: list[str], reason: str
) -> None:
    async def scenario(rig: SessionRig) -> None:
        with pytest.raises(RequestError) as caught:
            trial_control(rig.session).assign(participant, order)
        assert caught.value.reason == reason

    rig = on_stage(tmp_path, scenario)
    assert not short_messages(rig, m.ConditionsAssigned, m.SessionChanged)


def test_an_order_other_than_the_proposed_one_was_chosen_by_hand(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        trial_control(rig.session).propose("P01")
        trial_control(rig.session).assign("P01", ["cold", "warm"])
        trial_control(rig.session).trial("begin", "")

    rig = on_stage(tmp_path, scenario)
    (line,) = (line for line in rig.of(m.ConditionsAssigned))
    assert (line.method, line.row, line.why) == ("hand", -1, "chosen by the wizard")
    assert short_messages(rig, m.TrialStarted) == ["trial.started 1 cold"]


def test_a_proposal_says_which_logs_could_not_be_read(tmp_path: Path) -> None:
    (tmp_path / "recordings" / "2026-02-01T10-00-00_S01.jsonl").mkdir(parents=True)

    async def scenario(rig: SessionRig) -> None:
        assert trial_control(rig.session).propose("P01").why == (
            "row 1 of 2: least used so far (0 participants);"
            " not counted because they cannot be read: 2026-02-01T10-00-00_S01.jsonl"
        )

    on_stage(tmp_path, scenario)


def test_without_a_design_there_is_nothing_to_propose_but_trials_count(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        with pytest.raises(RequestError, match="the file has no design"):
            trial_control(rig.session).propose("P01")
        with pytest.raises(RequestError, match="the file has no design"):
            trial_control(rig.session).assign("P01", [])
        for what in ("begin", "done", "begin", "aborted", "begin"):
            trial_control(rig.session).trial(what, "")

    who = SessionIdentity(participant="P07", condition="warm")
    rig = on_stage(tmp_path, scenario, Study(), who, design=None)
    assert short_messages(rig, m.TrialStarted) == [
        "trial.started 1 warm",
        "trial.started 2 warm",
        "trial.started 2 warm",
    ]
    assert all(line.planned == 0 for line in rig.of(m.TrialStarted))


def test_who_comes_again_goes_on_in_the_next_session(tmp_path: Path) -> None:
    log(
        tmp_path / "recordings",
        "2026-02-01T10-00-00_S01",
        had("P02", ["cold", "warm"], "ddd", row=1),
    )

    async def scenario(rig: SessionRig) -> None:
        proposal = trial_control(rig.session).propose("P02")
        assert (proposal.condition, proposal.trial, proposal.row) == ("warm", 4, 1)
        assert trial_control(rig.session).propose("P01").row == 0
        trial_control(rig.session).assign("P02", ["cold", "warm"])
        trial_control(rig.session).trial("begin", "")
        trial_control(rig.session).trial("done", "")
        assert trial_control(rig.session).propose("P02").trial == 5

    rig = on_stage(tmp_path, scenario)
    assert short_messages(rig, m.TrialStarted) == ["trial.started 4 warm"]
    (line,) = (line for line in rig.of(m.ConditionsAssigned))
    assert (line.method, line.row) == ("latin-square", 1)
    assert line.why == "P02 continues with their own order: 3 of 4 trials done"


def test_no_number_is_set_while_a_trial_runs(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        assign_participant(rig)
        trial_control(rig.session).trial("begin", "")
        with pytest.raises(RequestError, match="trial 1 is running"):
            rig.session.set(trial=3)
        rig.session.set(trial=1)
        trial_control(rig.session).trial("done", "")
        rig.session.set(trial=3)

    assert short_messages(on_stage(tmp_path, scenario), m.TrialStarted) == ["trial.started 1 warm"]


def test_participants_of_this_very_session_count(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rows = []
        for number in range(1, 5):
            assign_participant(rig, f"P0{number}")
            rows.append(rig.session.state.study.assigned)
        assert [row.row for row in rows if row is not None] == [0, 1, 0, 1]

    on_stage(tmp_path, scenario)


def test_earlier_participants_count_where_the_log_begins_in_another_folder(tmp_path: Path) -> None:
    recordings, disk = tmp_path / "recordings", FaultyDisk()
    log(recordings, "2026-02-01T10-00-00_S01", had("P01", ["warm", "cold"], "d", row=0))
    disk.faults[recordings] = "readonly"

    async def scenario(rig: SessionRig) -> None:
        assert rig.recorder.path.parent == tmp_path / "more"
        study = trial_control(rig.session)
        assert study.propose("P01").trial == 2
        assign_participant(rig, "P02")
        assert [study.propose(who).row for who in ("P02", "P03")] == [1, 0]

    on_stage(tmp_path, scenario, disk=disk)


def test_a_break_inside_a_trial_ends_with_it_and_one_before_it_when_it_begins(
    tmp_path: Path,
) -> None:
    async def scenario(rig: SessionRig) -> None:
        assign_participant(rig)
        for what in ("begin", "break", "done", "break", "begin", "break"):
            trial_control(rig.session).trial(what, "")

    rig = on_stage(tmp_path, scenario)
    ending = ["break.ended", "trial.ended 1 done", "break.started", "break.ended"]
    assert short_messages(rig, *TRIALS)[1:] == [
        "trial.started 1 warm",
        "break.started",
        *ending,
        "trial.started 2 warm",
        "break.started",
        "break.ended",
        "trial.ended 2 aborted",
    ]


def test_what_is_under_way_ends_before_the_session_does(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        assign_participant(rig)
        trial_control(rig.session).trial("begin", "")

    rig = on_stage(tmp_path, scenario)
    (trial_ended,) = (line for line in rig.of(m.TrialEnded))
    assert (trial_ended.outcome, trial_ended.text) == ("aborted", "the session ended")
    assert isinstance(rig.lines[-1], m.SessionEnd)


def test_what_is_kept_from_the_wizard_is_said_at_the_beginning_and_when_it_changes(
    tmp_path: Path,
) -> None:
    async def scenario(rig: SessionRig) -> None:
        same = study_experiment(tmp_path)
        rig.session.adopt(same, [])
        rig.session.adopt(replace(same, study=replace(STUDY, perception=PerceptionLimits())), [])

    told = on_stage(tmp_path, scenario).of(m.PerceptionChanged)
    assert [(line.hidden, line.blurred) for line in told] == [
        (["distance"], ["transcript"]),
        ([], []),
    ]


def test_without_this_section_nothing_is_said(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        await asyncio.sleep(1)

    rig = on_stage(tmp_path, scenario, Study())
    assert not short_messages(rig, m.PerceptionChanged)


def test_a_variable_that_depends_on_the_condition_waits_for_one(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        with pytest.raises(RequestError) as caught:
            rig.session.play("Greet", KEY)
        assert caught.value.reason == (
            "{greeting} has no value yet: it depends on the condition, and no condition is set"
        )
        rig.session.set(condition="warm")
        with pytest.raises(RequestError) as caught:
            rig.session.play("Greet", KEY)
        assert caught.value.reason == (
            "{greeting} has no value yet: {participant} has no value yet"
        )
        only_warm = replace(rig.session.experiment, by_condition={"greeting": {"warm": "Hi"}})
        rig.session.adopt(only_warm, [])
        rig.session.set(condition="cold")
        with pytest.raises(RequestError, match="no text for the present condition"):
            rig.session.play("Greet", KEY)

    rig = on_stage(tmp_path, scenario)
    assert rig.kinds(m.ActionEnd) == ["ActionRefused"] * 3


def test_a_blind_wizard_is_shown_labels_and_no_text_that_tells(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        session = rig.session
        session.set("P01", "cold")
        assert session.values()["greeting"] == "Hello."
        findings = {finding.subject: finding.text for finding in await preflight(session)}
        assert findings["session"] == "P01 B"
        design = replace(PLANNED, blind={"warm": "A", "mild": "B"})
        renamed = replace(
            session.experiment, conditions=("warm", "mild"), sections={DESIGN: design}
        )
        session.adopt(renamed, ["a condition"])
        findings = {finding.subject: finding.text for finding in await preflight(session)}
        assert findings["session"] == "P01 ?", "not what it is really called"

    on_stage(tmp_path, scenario)


def test_the_preflight_list_is_ticked_by_hand_and_filled_by_the_robot(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        study = trial_control(rig.session)
        rig.session.tick("the door is shut", True, "", "wizard")
        rig.session.tick("the camera sees the table", True, "", "wizard")
        rig.session.tick("the camera sees the table", False, "moved", "wizard")
        with pytest.raises(RequestError) as caught:
            rig.session.tick("the door", True, "", "wizard")
        assert "there are the door is shut, the camera" in caught.value.hint
        found = await preflight(rig.session)
        assert {finding.subject for finding in found} < {*study.state.checks}
        assert study_snapshot(study.state.settings, rig.session.state).preflight == [
            PreflightCheck("the door is shut", ok=True),
            PreflightCheck("the camera sees the table", ok=False),
        ]

    rig = on_stage(tmp_path, scenario)
    lines = rig.of(m.PreflightChecked)
    assert [(line.level, line.source) for line in lines[:3]] == [
        ("ok", "wizard"),
        ("ok", "wizard"),
        ("warning", "wizard"),
    ]
    assert {line.source for line in lines[3:]} == {"robot"}
    assert {line.level for line in lines} <= {"ok", "warning", "error"}
