"""A console that comes late knows as much of the study as one that was always there."""

from __future__ import annotations

import asyncio
import contextlib
from pathlib import Path

from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from tests.features.questionnaires.rig import history, on_stage, questionnaires
from tests.session.rig import SessionRig
from tests.session.study_rig import trial_control
from woz_tui.features.questionnaires.history import QuestionnaireHistory
from woz_tui.features.questionnaires.kinds import (
    AskAnswer,
    QuestionnaireEnded,
    QuestionnaireStarted,
)
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError
from woz_tui.session.session_plan import study_snapshot
from woz_tui.timeline.session_state import SessionState

WHATS = ("begin", "done", "done", "begin", "aborted", "excluded", "break", "resume")
NAMES = ("each", "ux", "last", "whenever")
STEPS = st.one_of(
    st.tuples(st.just("trial"), st.sampled_from(WHATS)),
    st.tuples(st.just("ask"), st.sampled_from(NAMES)),
    st.tuples(st.just("end"), st.sampled_from(["done", "declined", "left"])),
    st.tuples(st.just("answer"), st.sampled_from(["pleasant", "else"])),
    st.tuples(st.just("assign"), st.sampled_from(["P01", "P02"])),
    st.tuples(st.just("tick"), st.sampled_from(["the door is shut", "the camera sees the table"])),
)


def take(rig: SessionRig, step: str, what: str) -> None:
    """One step, or nothing if it is refused."""
    study = trial_control(rig.session)
    asking = history(rig).questionnaire
    with contextlib.suppress(RequestError):
        match step:
            case "trial":
                study.trial(what, "")
            case "ask":
                questionnaires(rig).begin_or_end(what, "begin", "wizard")
            case "end" if asking is not None:
                questionnaires(rig).begin_or_end(asking.name, what, "wizard")
            case "answer":
                text = "well" if what == "else" else ""
                value = None if text else 3.0
                questionnaires(rig).answer(
                    AskAnswer(questionnaire="ux", item=what, value=value, text=text)
                )
            case "assign":
                study.assign(what, ["cold", "warm"])
            case "tick":
                rig.session.tick(what, True, "", "wizard")


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(STEPS, max_size=30))
@example([("trial", "break"), ("trial", "resume"), ("trial", "break"), ("trial", "begin")])
@example(
    [("trial", "begin"), ("trial", "done"), ("ask", "ux"), ("answer", "else"), ("end", "left")]
)
def test_the_state_for_newcomers_tells_all(tmp_path: Path, steps: list[tuple[str, str]]) -> None:
    async def scenario(rig: SessionRig) -> None:
        take(rig, "assign", "P01")
        for step, what in steps:
            take(rig, step, what)
            live, late = rig.session.state, SessionState()
            for message in live.messages():
                late.apply(message)
            study_settings = late.study.settings = rig.session.state.study.settings
            assert study_snapshot(study_settings, late) == study_snapshot(study_settings, live)
            asked, known = (each.history(QuestionnaireHistory) for each in (live, late))
            assert known.had == asked.had
            assert known.questionnaire == asked.questionnaire

    on_stage(tmp_path, scenario)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(STEPS, max_size=30))
def test_every_beginning_has_one_end_in_any_course(
    tmp_path: Path, steps: list[tuple[str, str]]
) -> None:
    async def scenario(rig: SessionRig) -> None:
        for step, what in steps:
            take(rig, step, what)
        await asyncio.sleep(0)

    rig = on_stage(tmp_path, scenario)
    for begins, ends in (
        (m.TrialStarted, m.TrialEnded),
        (m.BreakStarted, m.BreakEnded),
        (QuestionnaireStarted, QuestionnaireEnded),
    ):
        course = [isinstance(line, begins) for line in rig.of(begins, ends)]
        assert course == [True, False] * (len(course) // 2)
    over = [line.trial for line in rig.of(m.TrialEnded)]
    started = [line.trial for line in rig.of(m.TrialStarted)]
    assert over == started
