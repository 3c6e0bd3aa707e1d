"""Items of every kind in a session: their order, what is an answer, what is due at the start."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

import pytest

from tests.config.catalogue import CATALOGUE
from tests.features.questionnaires.rig import due, questionnaires
from tests.session import study_rig
from tests.session.rig import SessionRig
from tests.session.study_rig import trial_control
from woz_tui.config.loading import load
from woz_tui.features.questionnaires.history import DueQuestionnaire
from woz_tui.features.questionnaires.kinds import (
    AskAnswer,
    QuestionnaireAnswered,
    QuestionnaireStarted,
)
from woz_tui.features.questionnaires.section import QUESTIONNAIRES, Asked
from woz_tui.protocol.refusal import RequestError

FILE = Path(__file__).parents[2] / "config" / "good" / "questionnaire-items.yaml"


def on_stage(tmp_path: Path, scenario: Callable[[SessionRig], Awaitable[None]]) -> SessionRig:
    asked = QUESTIONNAIRES.of(load(FILE, CATALOGUE)).questionnaires
    return study_rig.on_stage(tmp_path, scenario, sections={QUESTIONNAIRES: Asked(asked)})


def assign(rig: SessionRig, participant: str = "P01") -> None:
    control = trial_control(rig.session)
    control.assign(participant, [*control.propose(participant).order])


def begin(rig: SessionRig, language: str = "", given: str = "") -> None:
    questionnaires(rig).begin_or_end("robot-ux", "begin", "wizard", language, given)


def end(rig: SessionRig, what: str) -> None:
    questionnaires(rig).begin_or_end("robot-ux", what, "wizard")


def answer(rig: SessionRig, item: str, value: float | None = None, **rest: Any) -> None:
    questionnaires(rig).answer(AskAnswer(questionnaire="robot-ux", item=item, value=value, **rest))


def test_what_is_for_the_start_is_due_before_the_first_trial(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        assign(rig)
        assert due(rig) == [DueQuestionnaire("robot-ux")]
        begin(rig)
        end(rig, "declined")
        assert due(rig) == []
        assign(rig, "P02")
        assert due(rig) == [DueQuestionnaire("robot-ux")]
        trial_control(rig.session).trial("begin", "")
        assert due(rig) == []
        trial_control(rig.session).trial("done", "")
        assert due(rig) == []

    on_stage(tmp_path, scenario)


def test_the_order_is_by_seed_participant_and_round_and_in_the_log(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        assign(rig)
        for what in ("left", "left", "declined"):
            begin(rig)
            end(rig, what)
        assign(rig, "P02")
        begin(rig)

    def orders(name: str) -> list[list[tuple[str, bool]]]:
        (tmp_path / name).mkdir()
        rig = on_stage(tmp_path / name, scenario)
        return [
            [(str(item["name"]), bool(item.get("flipped"))) for item in line.items]
            for line in rig.lines
            if isinstance(line, QuestionnaireStarted)
        ]

    found = orders("once")
    assert orders("again") == found
    assert len({tuple(order) for order in found}) == 4
    assert {order[0][0] for order in found} == {"page-1"}
    for order in found:
        names = [name for name, _ in order]
        assert names.index("which") == names.index("known") + 1


def test_answers_of_every_kind(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        assign(rig)
        begin(rig, language="de", given="read_aloud")
        answer(rig, "natural", -3)
        answer(rig, "effort", 35)
        answer(rig, "often", skipped=True, reason="does_not_apply")
        answer(rig, "known", 1)
        answer(rig, "which", ticked=[1, 6], text="ein Mäher")
        answer(rig, "since", text="2026-11")
        answer(rig, "words", text="Anna", given="browser")
        answer(rig, "hard", 20)
        end(rig, "done")

    rig = on_stage(tmp_path, scenario)
    started = next(line for line in rig.lines if isinstance(line, QuestionnaireStarted))
    assert (started.language, started.title) == ("de", "Wie war der Roboter?")
    told = {line.item: line for line in rig.lines if isinstance(line, QuestionnaireAnswered)}
    assert told["natural"].question == "Der Roboter war fake - natürlich"
    assert (told["which"].ticked, told["which"].text) == ([1, 6], "ein Mäher")
    assert (told["words"].private, told["known"].private) == (True, False)
    assert (told["words"].given, told["known"].given) == ("browser", "read_aloud")


@pytest.mark.parametrize(
    ("item", "value", "rest", "reason"),
    [
        ("natural", 4, {}, "expected a whole number from -3 to 3"),
        ("effort", 36, {}, "expected steps of 5 from 0"),
        ("effort", None, {"skipped": True}, "'effort' needs an answer"),
        ("often", None, {"skipped": True, "reason": "prefer_not"}, "does not offer that"),
        ("known", 4, {}, "expected one of [1, 2, 3]"),
        ("known", 1, {"text": "no"}, "no text is wanted here"),
        ("which", None, {"ticked": [1]}, "'which' is not asked"),
        ("since", None, {"text": "2026-13"}, "expected a month"),
        ("page-1", 1, {}, "an instruction has no answer"),
        ("age", 17, {}, "expected a whole number from 18 to 99"),
    ],
)
def test_what_is_no_answer(
    tmp_path: Path, item: str, value: float | None, rest: dict[str, Any], reason: str
) -> None:
    async def scenario(rig: SessionRig) -> None:
        assign(rig)
        begin(rig)
        with pytest.raises(RequestError) as refused:
            answer(rig, item, value, **rest)
        assert reason in str(refused.value)

    on_stage(tmp_path, scenario)


def test_a_language_that_it_has_not_is_refused(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        assign(rig)
        with pytest.raises(RequestError, match="not in the language 'fr'"):
            begin(rig, language="fr")

    on_stage(tmp_path, scenario)
