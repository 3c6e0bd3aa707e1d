"""A session with a study around it, in which participants are asked something."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

from tests.session import study_rig
from tests.session.rig import SessionRig
from woz_tui.config.experiment import Experiment
from woz_tui.config.study import Study
from woz_tui.features.questionnaires.history import DueQuestionnaire, QuestionnaireHistory
from woz_tui.features.questionnaires.in_session import QuestionnaireController
from woz_tui.features.questionnaires.section import QUESTIONNAIRES, Asked
from woz_tui.protocol.welcome import Questionnaire, QuestionnaireItem

ITEMS = (
    QuestionnaireItem("pleasant", "How pleasant was it?", 1, 5, ("not at all", "very")),
    QuestionnaireItem("else", "Anything else?", text=True, optional=True),
)
ASKED = Asked(
    (
        Questionnaire(
            "each",
            "Each trial",
            when="trial",
            items=(QuestionnaireItem("hard", "How hard was it?"),),
        ),
        Questionnaire("ux", "How was it?", when="condition", items=ITEMS),
        Questionnaire("last", "At last", items=(QuestionnaireItem("why", "Why?", text=True),)),
        Questionnaire(
            "whenever", "Whenever", when="hand", items=(QuestionnaireItem("now", "Now?", 0, 100),)
        ),
    )
)


def study_experiment(tmp_path: Path, study: Study = study_rig.STUDY) -> Experiment:
    """The experiment of the study's rig, with questionnaires."""
    return study_rig.study_experiment(tmp_path, study, {QUESTIONNAIRES: ASKED})


def on_stage(
    tmp_path: Path,
    scenario: Callable[[SessionRig], Awaitable[None]],
    study: Study = study_rig.STUDY,
    **options: Any,
) -> SessionRig:
    """As the study's rig, with questionnaires."""
    sections: dict[object, Any] = {QUESTIONNAIRES: ASKED}
    return study_rig.on_stage(tmp_path, scenario, study, sections=sections, **options)


def questionnaires(rig: SessionRig) -> QuestionnaireController:
    """Those of a session."""
    return rig.session.features.of(QuestionnaireController)


def history(rig: SessionRig) -> QuestionnaireHistory:
    """What the session keeps of them."""
    return rig.session.state.history(QuestionnaireHistory)


def due(rig: SessionRig) -> list[DueQuestionnaire]:
    """What is due."""
    return history(rig).due(rig.session.state)
