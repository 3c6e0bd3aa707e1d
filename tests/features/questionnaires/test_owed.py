"""What an earlier session owes of questionnaires is told when its participant comes again."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.features.questionnaires.rig import on_stage
from tests.session.rig import SessionRig
from tests.session.study_rig import had, log, trial_control
from woz_tui.features.questionnaires.kinds import QuestionnaireEnded
from woz_tui.protocol import messages as m
from woz_tui.session.participant_identity import SessionIdentity


def assign_participant(rig: SessionRig, participant: str = "P01") -> None:
    order = [*trial_control(rig.session).propose(participant).order]
    trial_control(rig.session).assign(participant, order)


@pytest.mark.parametrize("answered", [False, True])
def test_a_questionnaire_that_an_earlier_session_owes_is_told(
    tmp_path: Path, answered: bool
) -> None:
    lines = had("P01", ["warm", "cold"], "dd", row=0)
    for name in ("each", "ux") if answered else ("each",):
        lines.append(QuestionnaireEnded(questionnaire=name, reason="done", answered=1))
    name = "2026-03-01T10-00-00_P01_S01"
    log(tmp_path / "recordings", name, lines, title="Made by hand")

    async def scenario(rig: SessionRig) -> None:
        assign_participant(rig)

    rig = on_stage(tmp_path, scenario)
    notices = [line.text for line in rig.of(m.Notice)]
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

    async def scenario(rig: SessionRig) -> None:
        assign_participant(rig)

    rig = on_stage(tmp_path, scenario, identity=SessionIdentity(participant="P01"))
    notices = [line.text for line in rig.of(m.Notice)]
    assert [text for text in notices if "has not answered" in text]
