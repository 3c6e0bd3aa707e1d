"""A published questionnaire from the file beside the experiment to its score."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.analysis.example_sessions import figures_of
from tests.features.questionnaires.rig import questionnaires
from tests.features.questionnaires.test_instruments import copied, read
from tests.features.questionnaires.test_scores import planned
from tests.session import study_rig
from tests.session.rig import SessionRig
from woz_tui.features.questionnaires.figures import asked_in
from woz_tui.features.questionnaires.kinds import AskAnswer
from woz_tui.features.questionnaires.section import QUESTIONNAIRES, Asked

RATINGS = {
    **{"mental": 30, "physical": 15, "temporal": 60},
    **{"performance": 40, "effort": 30, "frustration": 40},
}


def asked(tmp_path: Path, *names: str) -> Asked:
    for name in names:
        copied(tmp_path, name)
    return QUESTIONNAIRES.of(
        read(tmp_path, ", ".join(f"{{file: {name}.yaml, when: hand}}" for name in names))
    )


def answers(rig: SessionRig, name: str, given: dict[str, int]) -> None:
    control = questionnaires(rig)
    control.begin_or_end(name, "begin", "wizard")
    for item, value in given.items():
        control.answer(AskAnswer(questionnaire=name, item=item, value=value))
    control.begin_or_end(name, "done", "wizard")


def scores(tmp_path: Path, name: str, given: dict[str, int]) -> dict[str, float | None]:
    async def scenario(rig: SessionRig) -> None:
        answers(rig, name, given)

    section = asked(tmp_path, name)
    rig = study_rig.on_stage(tmp_path, scenario, sections={QUESTIONNAIRES: section})
    start, *course = rig.lines
    found = figures_of([start, planned(section.questionnaires), *course])  # as the host writes it
    return {row.score: row.value for row in asked_in(found).scores}


def test_raw_tlx_is_the_mean_of_six(tmp_path: Path) -> None:
    found = scores(tmp_path, "tlx", RATINGS)
    assert found == {"workload": pytest.approx(sum(RATINGS.values()) / 6)}


def test_weighted_tlx_is_the_sum_of_products_by_fifteen(tmp_path: Path) -> None:
    names = [*RATINGS]
    rank = [3, 6, 1, 5, 2, 4]  # of each: the lower of two is the one that did more
    chosen = {
        f"{first}-{second}": (a if rank[a] < rank[b] else b) + 1
        for a, first in enumerate(names)
        for b, second in enumerate(names)
        if a < b
    }
    weights = [6 - each for each in rank]
    assert sum(weights) == 15
    found = scores(tmp_path, "tlx-weighted", RATINGS | chosen)
    products = sum(w * value for w, value in zip(weights, RATINGS.values(), strict=True))
    assert found["workload"] == pytest.approx(products / 15)


def test_sus_of_somebody_who_agrees_to_everything(tmp_path: Path) -> None:
    assert scores(tmp_path, "sus", {f"sus-{n}": 5 for n in range(1, 11)}) == {"sus": 50}


def test_mini_ipip_turns_its_phrases_round(tmp_path: Path) -> None:
    found = scores(tmp_path, "mini-ipip", {f"ipip-{n}": 5 for n in range(1, 21)})
    assert found == {
        **{"extraversion": 3, "agreeableness": 3, "conscientiousness": 3, "neuroticism": 3},
        "imagination": 2,  # three of its four phrases count from the other end
    }
