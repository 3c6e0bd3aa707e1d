"""Questionnaires in exports: each round is an interval."""

from __future__ import annotations

import re

from woz_tui.export.feature_export import ExportedEpisode, FeatureExport
from woz_tui.features.questionnaires.due import WHENS
from woz_tui.features.questionnaires.history import QuestionnaireEpisode
from woz_tui.features.questionnaires.kinds import (
    QuestionnaireAnswered,
    QuestionnaireEnded,
    QuestionnaireStarted,
)

#: Names that the experiment file gives.
_NAME = re.compile(r".*", re.DOTALL)

EXPORT = FeatureExport(
    parts=(QuestionnaireStarted, QuestionnaireAnswered, QuestionnaireEnded),
    episodes={
        QuestionnaireEpisode: ExportedEpisode(
            "questionnaire",
            "a questionnaire was given to the participant",
            tier="questionnaires",
            outcome="reason",
            used=("questionnaire", "items"),
        )
    },
    kept={
        "questionnaire.started": ("questionnaire",),
        "questionnaire.answered": ("questionnaire", "item"),
        "questionnaire.ended": ("questionnaire",),
    },
    kept_at={
        "questionnaire.ended": {"reason": re.compile("done|declined|left")},
        "session.plan": {
            "settings.study.questionnaires.name": _NAME,
            "settings.study.questionnaires.when": re.compile("|".join(WHENS)),
        },
    },
    begun=("questionnaire",),
)
