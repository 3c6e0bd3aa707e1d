"""Orders, trials, breaks and the preflight list in a session."""

from __future__ import annotations

import asyncio
import re
from dataclasses import replace
from pathlib import Path

import pytest

from tests.log.disks import FaultyDisk
from tests.session.rig import Stage
from tests.session.studied import STUDY, had, log, on_stage, renamed, said, studied
from woz_tui.config.study import PerceptionLimits, Study
from woz_tui.protocol import messages as m
from woz_tui.protocol.welcome import PreflightCheck
from woz_tui.session.action_runner import RequestOrigin
from woz_tui.session.participant_identity import RequestError, SessionIdentity
from woz_tui.session.preflight import preflight
from woz_tui.session.session_plan import study_snapshot

KEY = RequestOrigin("key", "h", "con1")
TRIALS = (m.ConditionsAssigned, m.TrialStarted, m.TrialEnded, m.BreakStarted, m.BreakEnded)


def refused(stage: Stage, *asks: str) -> str:
    """Why a trial's ask is refused."""
    with pytest.raises(RequestError) as caught:
        for what in asks:
            stage.session.study.trial(what, "")
    return f"{caught.value.reason}; {caught.value.hint}".rstrip("; ")


def assigned(stage: Stage, participant: str = "P01") -> None:
    order = [*stage.session.study.propose(participant).order]
    stage.session.study.assign(participant, order)


def test_a_whole_participant(tmp_path: Path) -> None:
    async def scenario(stage: Stage) -> None:
        study = stage.session.study
        assigned(stage)
        assert study.state.planned == 4
        for what in ("begin", "done", "begin", "aborted", "begin", "excluded", "break", "resume"):
            study.trial(what, "")
        for _ in range(2):
            study.trial("begin", "")
            study.trial("done", "")
        assert refused(stage, "begin") == (
            "all 4 trials of P01 are done; choose the next participant,"
            " or set a trial number to repeat a trial"
        )
        stage.session.set(trial=2)
        study.trial("begin", "")
        study.trial("done", "")
        assert "all 4 trials of P01 are done" in refused(stage, "begin")

    stage = on_stage(tmp_path, scenario)
    assert said(stage, *TRIALS) == [
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
    (order,) = (line for line in stage.lines if isinstance(line, m.ConditionsAssigned))
    assert (order.method, order.row, order.order) == ("latin-square", 0, ["warm", "cold"])
    assert {line.planned for line in stage.lines if isinstance(line, m.TrialStarted)} == {4}


def test_the_condition_of_a_trial_is_set_before_it_begins(tmp_path: Path) -> None:
    async def scenario(stage: Stage) -> None:
        assigned(stage)
        for what in ("begin", "done", "begin", "done"):
            stage.session.study.trial(what, "")
        stage.session.set(condition="warm")
        stage.session.play("Greet", KEY)
        stage.session.study.trial("begin", "")
        await asyncio.sleep(2)
        stage.session.play("Greet", KEY)

    stage = on_stage(tmp_path, scenario)
    texts = [args["text"] for verb, args in stage.puppet().calls if verb == "say"]
    assert texts == ["Hello P01! I am in the museum.", "Hello. I am in the museum."]
    changed = [line for line in stage.lines if isinstance(line, m.SessionChanged | m.TrialStarted)]
    last = changed[-2:]
    assert isinstance(last[0], m.SessionChanged)
    assert (last[0].condition, last[0].trial) == ("cold", 3)


@pytest.mark.parametrize(("order", "over"), [(["warm", "cold"], 1), (["cold", "warm"], 2)])
def test_a_condition_that_is_not_in_the_file_any_more_begins_no_trial_and_is_not_named(
    tmp_path: Path, order: list[str], over: int
) -> None:
    """The one that holds already, and one that comes next."""

    async def scenario(stage: Stage) -> None:
        stage.session.study.assign("P01", order)
        for _ in range(over):
            stage.session.study.trial("begin", "")
            stage.session.study.trial("done", "")
        stage.session.adopt(renamed(tmp_path), [])
        with pytest.raises(RequestError) as caught:
            stage.session.study.trial("begin", "")
        assert caught.value.command == "start"
        said = f"{caught.value.reason}; {caught.value.hint}"
        assert "P01" in said
        assert not {"warm", "friendly"} & {*re.findall(r"\w+", said)}

    assert len(said(on_stage(tmp_path, scenario), m.TrialStarted)) == over


def test_behind_a_trial_out_of_turn_comes_the_first_that_is_not_over(tmp_path: Path) -> None:
    """One that was run too early, and one that is run again after the break of a day."""
    log(
        tmp_path / "recordings",
        "2026-03-01T10-00-00_P01_S01",
        [*had("P01", ["warm", "cold"], "d", row=0)],
        title="Made by hand",
    )

    async def scenario(stage: Stage) -> None:
        study = stage.session.study
        assigned(stage)
        assert study.state.next_trial == 2
        for number, following in ((4, 2), (2, 3), (1, 3), (3, 5)):
            stage.session.set(trial=number)
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
    design = replace(STUDY.design, trials=trials) if STUDY.design and trials else None

    async def scenario(stage: Stage) -> None:
        study = stage.session.study
        study.assign("P01", ["warm", "cold"])
        for _ in range(3):
            study.trial("begin", "")
            study.trial("done", "")
        stage.session.adopt(studied(tmp_path, replace(STUDY, design=design)), [])
        study.trial("begin", "")
        study.trial("done", "")
        assert [each.questionnaire for each in study.state.due] == ["each", "ux", "last"]
        assert "all 4 trials of P01 are done" in refused(stage, "begin")

    stage = on_stage(tmp_path, scenario)
    begun = [line for line in stage.lines if isinstance(line, m.TrialStarted)]
    assert [(line.condition, line.planned) for line in begun] == [
        ("warm", 4), ("warm", 4), ("cold", 4), ("cold", 4),
    ]  # fmt: skip


def test_refusals(tmp_path: Path) -> None:
    async def scenario(stage: Stage) -> None:
        study = stage.session.study
        assert refused(stage, "begin") == "no participant is set; choose one first"
        stage.session.set("P05")
        assert (
            refused(stage, "begin") == "no condition is set; choose the participant's order first"
        )
        assert refused(stage, "done") == "no trial is running; start one"
        assert refused(stage, "resume") == "no break is running"
        assert refused(stage, "break", "break") == "a break is already running"
        stage.session.set(condition="cold")
        study.trial("begin", "")
        assert refused(stage, "begin") == "trial 1 is running; end it first"
        with pytest.raises(RequestError, match="trial 1 is running"):
            stage.session.set("P06")
        with pytest.raises(RequestError, match="trial 1 is running"):
            study.assign("P06", ["warm", "cold"])
        stage.session.set("P05")

    stage = on_stage(tmp_path, scenario)
    assert said(stage, *TRIALS) == [
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
    async def scenario(stage: Stage) -> None:
        with pytest.raises(RequestError) as caught:
            stage.session.study.assign(participant, order)
        assert caught.value.reason == reason

    stage = on_stage(tmp_path, scenario)
    assert not said(stage, m.ConditionsAssigned, m.SessionChanged)


def test_an_order_other_than_the_proposed_one_was_chosen_by_hand(tmp_path: Path) -> None:
    async def scenario(stage: Stage) -> None:
        stage.session.study.propose("P01")
        stage.session.study.assign("P01", ["cold", "warm"])
        stage.session.study.trial("begin", "")

    stage = on_stage(tmp_path, scenario)
    (line,) = (line for line in stage.lines if isinstance(line, m.ConditionsAssigned))
    assert (line.method, line.row, line.why) == ("hand", -1, "chosen by the wizard")
    assert said(stage, m.TrialStarted) == ["trial.started 1 cold"]


def test_a_proposal_says_which_logs_could_not_be_read(tmp_path: Path) -> None:
    (tmp_path / "recordings" / "2026-02-01T10-00-00_S01.jsonl").mkdir(parents=True)

    async def scenario(stage: Stage) -> None:
        assert stage.session.study.propose("P01").why == (
            "row 1 of 2: least used so far (0 participants);"
            " not counted because they cannot be read: 2026-02-01T10-00-00_S01.jsonl"
        )

    on_stage(tmp_path, scenario)


def test_without_a_design_there_is_nothing_to_propose_but_trials_count(tmp_path: Path) -> None:
    async def scenario(stage: Stage) -> None:
        with pytest.raises(RequestError, match="the file has no design"):
            stage.session.study.propose("P01")
        with pytest.raises(RequestError, match="the file has no design"):
            stage.session.study.assign("P01", [])
        for what in ("begin", "done", "begin", "aborted", "begin"):
            stage.session.study.trial(what, "")

    who = SessionIdentity(participant="P07", condition="warm")
    stage = on_stage(tmp_path, scenario, Study(), who)
    assert said(stage, m.TrialStarted) == [
        "trial.started 1 warm",
        "trial.started 2 warm",
        "trial.started 2 warm",
    ]
    assert all(line.planned == 0 for line in stage.lines if isinstance(line, m.TrialStarted))


def test_who_comes_again_goes_on_in_the_next_session(tmp_path: Path) -> None:
    log(
        tmp_path / "recordings",
        "2026-02-01T10-00-00_S01",
        had("P02", ["cold", "warm"], "ddd", row=1),
    )

    async def scenario(stage: Stage) -> None:
        proposal = stage.session.study.propose("P02")
        assert (proposal.condition, proposal.trial, proposal.row) == ("warm", 4, 1)
        assert stage.session.study.propose("P01").row == 0
        stage.session.study.assign("P02", ["cold", "warm"])
        stage.session.study.trial("begin", "")
        stage.session.study.trial("done", "")
        assert stage.session.study.propose("P02").trial == 5

    stage = on_stage(tmp_path, scenario)
    assert said(stage, m.TrialStarted) == ["trial.started 4 warm"]
    (line,) = (line for line in stage.lines if isinstance(line, m.ConditionsAssigned))
    assert (line.method, line.row) == ("latin-square", 1)
    assert line.why == "P02 continues with their own order: 3 of 4 trials done"


@pytest.mark.parametrize("answered", [False, True])
def test_a_questionnaire_that_an_earlier_session_owes_is_told(
    tmp_path: Path, answered: bool
) -> None:
    lines = had("P01", ["warm", "cold"], "dd", row=0)
    for name in ("each", "ux") if answered else ("each",):
        lines.append(m.QuestionnaireEnded(questionnaire=name, reason="done", answered=1))
    name = "2026-03-01T10-00-00_P01_S01"
    log(tmp_path / "recordings", name, lines, title="Made by hand")

    async def scenario(stage: Stage) -> None:
        assigned(stage)

    stage = on_stage(tmp_path, scenario)
    notices = [line.text for line in stage.lines if isinstance(line, m.Notice)]
    owed = [text for text in notices if "has not answered" in text]
    assert owed == ([] if answered else ["P01 has not answered: How was it?"])


def test_what_is_owed_is_told_after_a_crash_when_the_session_begins_with_the_participant(
    tmp_path: Path,
) -> None:
    name = "2026-03-01T10-00-00_P01_S01"
    log(
        tmp_path / "recordings",
        name,
        had("P01", ["warm", "cold"], "d", row=0),
        title="Made by hand",
    )

    async def scenario(stage: Stage) -> None:
        assigned(stage)

    stage = on_stage(tmp_path, scenario, identity=SessionIdentity(participant="P01"))
    notices = [line.text for line in stage.lines if isinstance(line, m.Notice)]
    assert [text for text in notices if "has not answered" in text]


def test_no_number_is_set_while_a_trial_runs(tmp_path: Path) -> None:
    async def scenario(stage: Stage) -> None:
        assigned(stage)
        stage.session.study.trial("begin", "")
        with pytest.raises(RequestError, match="trial 1 is running"):
            stage.session.set(trial=3)
        stage.session.set(trial=1)
        stage.session.study.trial("done", "")
        stage.session.set(trial=3)

    assert said(on_stage(tmp_path, scenario), m.TrialStarted) == ["trial.started 1 warm"]


def test_participants_of_this_very_session_count(tmp_path: Path) -> None:
    async def scenario(stage: Stage) -> None:
        rows = []
        for number in range(1, 5):
            assigned(stage, f"P0{number}")
            rows.append(stage.session.study.state.assigned)
        assert [row.row for row in rows if row is not None] == [0, 1, 0, 1]

    on_stage(tmp_path, scenario)


def test_earlier_participants_count_where_the_log_begins_in_another_folder(tmp_path: Path) -> None:
    recordings, disk = tmp_path / "recordings", FaultyDisk()
    log(recordings, "2026-02-01T10-00-00_S01", had("P01", ["warm", "cold"], "d", row=0))
    disk.faults[recordings] = "readonly"

    async def scenario(stage: Stage) -> None:
        assert stage.recorder.path.parent == tmp_path / "more"
        study = stage.session.study
        assert study.propose("P01").trial == 2
        assigned(stage, "P02")
        assert [study.propose(who).row for who in ("P02", "P03")] == [1, 0]

    on_stage(tmp_path, scenario, disk=disk)


def test_a_break_inside_a_trial_ends_with_it_and_one_before_it_when_it_begins(
    tmp_path: Path,
) -> None:
    async def scenario(stage: Stage) -> None:
        assigned(stage)
        for what in ("begin", "break", "done", "break", "begin", "break"):
            stage.session.study.trial(what, "")

    stage = on_stage(tmp_path, scenario)
    ending = ["break.ended", "trial.ended 1 done", "break.started", "break.ended"]
    assert said(stage, *TRIALS)[1:] == [
        "trial.started 1 warm",
        "break.started",
        *ending,
        "trial.started 2 warm",
        "break.started",
        "break.ended",
        "trial.ended 2 aborted",
    ]


def test_what_is_under_way_ends_before_the_session_does(tmp_path: Path) -> None:
    async def scenario(stage: Stage) -> None:
        assigned(stage)
        stage.session.study.trial("begin", "")

    stage = on_stage(tmp_path, scenario)
    (ended,) = (line for line in stage.lines if isinstance(line, m.TrialEnded))
    assert (ended.outcome, ended.text) == ("aborted", "the session ended")
    assert isinstance(stage.lines[-1], m.SessionEnd)


def test_what_shapes_the_answers_is_said_at_the_beginning_and_when_it_changes(
    tmp_path: Path,
) -> None:
    async def scenario(stage: Stage) -> None:
        same = studied(tmp_path)
        stage.session.adopt(same, [])
        stage.session.adopt(
            replace(same, study=replace(STUDY, shaping=None, perception=PerceptionLimits())), []
        )

    stage = on_stage(tmp_path, scenario)
    told = [
        line for line in stage.lines if isinstance(line, m.ShapingChanged | m.PerceptionChanged)
    ]
    assert [(type(line).__name__, *_fields(line)) for line in told] == [
        ("PerceptionChanged", ["distance"], ["transcript"]),
        ("ShapingChanged", 800_000, 400_000, ["speech"]),
        ("PerceptionChanged", [], []),
        ("ShapingChanged", 0, 0, []),
    ]


def _fields(line: m.ShapingChanged | m.PerceptionChanged) -> tuple[object, ...]:
    if isinstance(line, m.ShapingChanged):
        return line.floor_us, line.jitter_us, line.cues
    return line.hidden, line.blurred


def test_without_these_sections_nothing_is_said(tmp_path: Path) -> None:
    async def scenario(stage: Stage) -> None:
        await asyncio.sleep(1)

    stage = on_stage(tmp_path, scenario, Study())
    assert not said(stage, m.ShapingChanged, m.PerceptionChanged)


def test_a_variable_that_depends_on_the_condition_waits_for_one(tmp_path: Path) -> None:
    async def scenario(stage: Stage) -> None:
        with pytest.raises(RequestError) as caught:
            stage.session.play("Greet", KEY)
        assert caught.value.reason == (
            "{greeting} has no value yet: it depends on the condition, and no condition is set"
        )
        stage.session.set(condition="warm")
        with pytest.raises(RequestError) as caught:
            stage.session.play("Greet", KEY)
        assert caught.value.reason == (
            "{greeting} has no value yet: {participant} has no value yet"
        )
        only_warm = replace(stage.session.experiment, by_condition={"greeting": {"warm": "Hi"}})
        stage.session.adopt(only_warm, [])
        stage.session.set(condition="cold")
        with pytest.raises(RequestError, match="no text for the present condition"):
            stage.session.play("Greet", KEY)

    stage = on_stage(tmp_path, scenario)
    assert stage.kinds(m.ActionEnd) == ["ActionRefused"] * 3


def test_a_blind_wizard_is_shown_labels_and_no_text_that_tells(tmp_path: Path) -> None:
    async def scenario(stage: Stage) -> None:
        session = stage.session
        session.set("P01", "cold")
        assert session.values()["greeting"] == "Hello."
        findings = {finding.subject: finding.text for finding in await preflight(session)}
        assert findings["session"] == "P01 B"
        assert STUDY.design is not None
        design = replace(STUDY.design, blind={"warm": "A", "mild": "B"})
        study = replace(STUDY, design=design)
        renamed = replace(session.experiment, conditions=("warm", "mild"), study=study)
        session.adopt(renamed, ["a condition"])
        findings = {finding.subject: finding.text for finding in await preflight(session)}
        assert findings["session"] == "P01 ?", "not what it is really called"

    on_stage(tmp_path, scenario)


def test_the_preflight_list_is_ticked_by_hand_and_filled_by_the_robot(tmp_path: Path) -> None:
    async def scenario(stage: Stage) -> None:
        study = stage.session.study
        study.check("the door is shut", True, "", "wizard")
        study.check("the camera sees the table", True, "", "wizard")
        study.check("the camera sees the table", False, "moved", "wizard")
        with pytest.raises(RequestError) as caught:
            study.check("the door", True, "", "wizard")
        assert "there are the door is shut, the camera" in caught.value.hint
        found = await preflight(stage.session)
        assert {finding.subject for finding in found} < {*study.state.checks}
        assert study_snapshot(study.settings, study.state).preflight == [
            PreflightCheck("the door is shut", ok=True),
            PreflightCheck("the camera sees the table", ok=False),
        ]

    stage = on_stage(tmp_path, scenario)
    lines = [line for line in stage.lines if isinstance(line, m.PreflightChecked)]
    assert [(line.level, line.source) for line in lines[:3]] == [
        ("ok", "wizard"),
        ("ok", "wizard"),
        ("warning", "wizard"),
    ]
    assert {line.source for line in lines[3:]} == {"robot"}
    assert {line.level for line in lines} <= {"ok", "warning", "error"}


def test_the_script_begins_anew_with_trial_and_participant(tmp_path: Path) -> None:
    positions: list[int] = []

    async def scenario(stage: Stage) -> None:
        session = stage.session

        async def play() -> None:
            session.script_next(KEY)
            positions.append(session.scripts.now.position)
            await asyncio.sleep(2)

        session.set(participant="P01", condition="warm")
        await play()
        session.study.trial("begin", "")
        await play()
        await play()
        session.study.trial("done", "")
        session.study.trial("begin", "")
        await play()
        session.study.trial("done", "")
        session.set(participant="P02")
        await play()
        session.set(condition="cold")
        await play()
        session.set(trial=3)
        await play()

    on_stage(tmp_path, scenario)
    assert positions == [1, 1, 2, 1, 1, 2, 1]


def test_a_step_that_sets_the_trial_leaves_the_script_where_it_is(tmp_path: Path) -> None:
    async def scenario(stage: Stage) -> None:
        stage.session.set(participant="P01", condition="warm")
        stage.session.script_next(KEY)
        stage.session.send("set", {"trial": 2}, "", KEY)
        await asyncio.sleep(0.1)
        assert (stage.session.identity.trial, stage.session.scripts.now.position) == (2, 1)

    on_stage(tmp_path, scenario)
