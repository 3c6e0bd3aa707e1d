"""Questionnaires in a session: when they are due, what is an answer, how a round ends."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.features.questionnaires.rig import due, history, on_stage, questionnaires
from tests.session.rig import SessionRig
from tests.session.study_rig import short_messages, trial_control
from woz_tui.features.questionnaires.history import DueQuestionnaire
from woz_tui.features.questionnaires.items import LONGEST
from woz_tui.features.questionnaires.kinds import (
    AskAnswer,
    QuestionnaireAnswered,
    QuestionnaireEnded,
    QuestionnaireStarted,
)
from woz_tui.protocol.refusal import RequestError

ROUND = (QuestionnaireStarted, QuestionnaireAnswered, QuestionnaireEnded)


def trials(rig: SessionRig, *outcomes: str) -> None:
    for outcome in outcomes:
        trial_control(rig.session).trial("begin", "")
        trial_control(rig.session).trial(outcome, "")


def begin_questionnaire(rig: SessionRig) -> None:
    order = [*trial_control(rig.session).propose("P01").order]
    trial_control(rig.session).assign("P01", order)


def ask(rig: SessionRig, name: str, what: str = "begin", source: str = "wizard") -> None:
    questionnaires(rig).begin_or_end(name, what, source)


def answer(rig: SessionRig, item: str, value: float | None = None, **rest: object) -> None:
    request = AskAnswer(questionnaire="ux", item=item, value=value, **rest)  # type: ignore[arg-type]
    questionnaires(rig).answer(request)


def test_what_is_due_after_which_trial(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        begin_questionnaire(rig)
        seen = []
        for outcome in ("aborted", "done", "excluded", "done", "done"):
            trial_control(rig.session).trial("begin", "")
            assert due(rig) == []
            trial_control(rig.session).trial(outcome, "")
            seen.append([*due(rig)])
        assert seen == [
            [],
            [DueQuestionnaire("each", 1)],
            [DueQuestionnaire("ux", 2)],
            [DueQuestionnaire("each", 3)],
            [DueQuestionnaire("each", 4), DueQuestionnaire("ux", 4), DueQuestionnaire("last")],
        ]

    on_stage(tmp_path, scenario)


def test_a_round_from_its_beginning_to_its_end(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        begin_questionnaire(rig)
        trials(rig, "done", "done")
        ask(rig, "ux", source="participant")
        answer(rig, "pleasant", 3, answered_us=2_000_000)
        answer(rig, "pleasant", 5.0)
        answer(rig, "else", skipped=True)
        ask(rig, "ux", "done")
        assert due(rig) == [DueQuestionnaire("each", 2)]

    rig = on_stage(tmp_path, scenario)
    assert short_messages(rig, *ROUND) == [
        "questionnaire.started 2 ux",
        "questionnaire.answered ux pleasant",
        "questionnaire.answered ux pleasant",
        "questionnaire.answered ux else",
        "questionnaire.ended ux done",
    ]
    started, first, second, third, ended = (line for line in rig.lines if isinstance(line, ROUND))
    assert isinstance(started, QuestionnaireStarted)
    assert (started.title, started.source) == ("How was it?", "participant")
    assert started.items == [
        {
            "name": "pleasant",
            "question": "How pleasant was it?",
            "low": 1,
            "high": 5,
            "ends": ["not at all", "very"],
        },
        {"name": "else", "question": "Anything else?", "text": True, "optional": True},
    ]
    assert isinstance(first, QuestionnaireAnswered) and isinstance(second, QuestionnaireAnswered)
    assert (first.value, first.answered_us, second.value) == (3.0, 2_000_000, 5.0)
    assert isinstance(third, QuestionnaireAnswered) and third.skipped
    assert isinstance(ended, QuestionnaireEnded)
    assert ended.answered == 1


@pytest.mark.parametrize(
    ("item", "value", "rest", "reason"),
    [
        ("plesant", 3, {}, "there is no item 'plesant'"),
        ("pleasant", 0, {}, "expected a whole number from 1 to 5, not 0"),
        ("pleasant", 6, {}, "expected a whole number from 1 to 5, not 6"),
        ("pleasant", 2.5, {}, "expected a whole number from 1 to 5, not 2.5"),
        ("pleasant", None, {}, "expected a whole number from 1 to 5, not None"),
        ("pleasant", 3, {"text": "three"}, "'pleasant' needs a number as its answer"),
        ("pleasant", None, {"skipped": True}, "'pleasant' needs an answer"),
        ("else", 3, {}, "'else' needs a text as its answer"),
        ("else", None, {"text": " \n"}, "the answer is empty"),
        (
            "else",
            None,
            {"text": "x" * (LONGEST + 1)},
            "an answer can have at most 10000 characters",
        ),
        ("else", None, {"text": "x", "skipped": True}, "a skipped item cannot have an answer"),
    ],
)
def test_what_is_no_answer(
    tmp_path: Path, item: str, value: float | None, rest: dict[str, object], reason: str
) -> None:
    async def scenario(rig: SessionRig) -> None:
        ask(rig, "ux")
        with pytest.raises(RequestError) as caught:
            answer(rig, item, value, **rest)
        assert caught.value.reason == reason

    rig = on_stage(tmp_path, scenario)
    assert short_messages(rig, *ROUND) == [
        "questionnaire.started -1 ux",
        "questionnaire.ended ux left",
    ]


def test_what_cannot_be_asked(tmp_path: Path) -> None:
    def why(rig: SessionRig, name: str, what: str, source: str = "wizard") -> str:
        with pytest.raises(RequestError) as caught:
            ask(rig, name, what, source)
        return f"{caught.value.reason}; {caught.value.hint}"

    async def scenario(rig: SessionRig) -> None:
        with pytest.raises(RequestError, match="the questionnaire 'ux' is not open"):
            answer(rig, "pleasant", 3)
        assert why(rig, "xu", "begin") == (
            "there is no questionnaire 'xu'; there are each, ux, last, whenever"
        )
        assert why(rig, "ux", "done") == "the questionnaire 'ux' is not open; none is"
        assert why(rig, "ux", "begin", "participant") == (
            "the questionnaire 'ux' is not due yet; the wizard can start it"
        )
        ask(rig, "ux")
        assert why(rig, "last", "begin") == "the questionnaire 'ux' is open; end it first"
        assert why(rig, "last", "done") == ("the questionnaire 'last' is not open; 'ux' is")
        assert why(rig, "ux", "done") == "1 item has no answer yet: pleasant; "
        with pytest.raises(RequestError, match="the questionnaire 'ux' is open"):
            trial_control(rig.session).assign("P01", ["warm", "cold"])
        ask(rig, "ux", "declined")
        assert "ux" in history(rig).had

    rig = on_stage(tmp_path, scenario)
    assert short_messages(rig, *ROUND) == [
        "questionnaire.started -1 ux",
        "questionnaire.ended ux declined",
    ]


def test_a_round_that_was_left_stays_due_and_begins_anew(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        begin_questionnaire(rig)
        trials(rig, "done", "done")
        ask(rig, "ux")
        answer(rig, "pleasant", 2)
        ask(rig, "ux", "left")
        assert DueQuestionnaire("ux", 2) in due(rig)
        ask(rig, "ux")
        current = history(rig).questionnaire
        assert current is not None
        assert current.answers == {}
        answer(rig, "pleasant", 4)
        ask(rig, "ux", "done")
        ask(rig, "whenever")

    rig = on_stage(tmp_path, scenario)
    ends = rig.of(QuestionnaireEnded)
    assert [(line.questionnaire, line.reason, line.answered) for line in ends] == [
        ("ux", "left", 1),
        ("ux", "done", 1),
        ("whenever", "left", 0),
    ]


def test_a_questionnaire_by_hand_inside_a_trial_belongs_to_it(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        begin_questionnaire(rig)
        trial_control(rig.session).trial("begin", "")
        ask(rig, "whenever")
        trial_control(rig.session).trial("done", "")
        with pytest.raises(RequestError, match="the questionnaire 'whenever' is open"):
            trial_control(rig.session).trial("begin", "")

    rig = on_stage(tmp_path, scenario)
    assert short_messages(rig, QuestionnaireStarted) == ["questionnaire.started 1 whenever"]


def test_the_next_participant_begins_with_nothing_due(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        begin_questionnaire(rig)
        trials(rig, "done", "done")
        ask(rig, "ux", "begin")
        ask(rig, "ux", "declined")
        rig.session.set("P02")
        assert (due(rig), {*history(rig).had}) == ([], set())
        assert rig.session.state.study.next_trial == 1

    on_stage(tmp_path, scenario)
