"""Questionnaires in exports: each round is an interval."""

from __future__ import annotations

import re

from woz_tui.export.feature_export import ExportedEpisode, FeatureExport
from woz_tui.features.questionnaires.due import SUSPICION, WHENS
from woz_tui.features.questionnaires.history import QuestionnaireEpisode
from woz_tui.features.questionnaires.items import GIVEN
from woz_tui.features.questionnaires.kinds import (
    QuestionnaireAnswered,
    QuestionnaireEnded,
    QuestionnaireStarted,
)
from woz_tui.features.questionnaires.scoring import HOWS

#: Whatever the experiment file says: the researcher's words, not those of a participant.
_WORDS = re.compile(r".*", re.DOTALL)
#: What an item says, and what of it has texts within.
_OF_ITEM = (
    *("name", "question", "ends", "kind", "stem", "unit", "group", "does_not_apply", "prefer_not"),
    *("labels.text", "choices.text", "only_if.item"),
)
_OF_PLAN = (
    *("name", "title", "introduction", "language", "versions.language", "versions.title"),
    *("versions.introduction", *(f"items.{each}" for each in _OF_ITEM)),
    *(f"versions.items.{each}" for each in _OF_ITEM),
    *(f"scores.{each}" for each in ("name", "items", "reverse", "pairs")),
)

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
        "questionnaire.answered": ("questionnaire", "item", "question"),
        "questionnaire.ended": ("questionnaire",),
    },
    kept_at={
        "questionnaire.started": {
            "title": _WORDS,
            "language": re.compile(r"[a-z]{2,3}(-[A-Za-z0-9]{1,8})*"),
            "given": re.compile("|".join(GIVEN)),
            **{f"items.{each}": _WORDS for each in _OF_ITEM},
        },
        "questionnaire.answered": {
            "reason": re.compile("does_not_apply|prefer_not"),
            "given": re.compile("|".join(GIVEN)),
        },
        "questionnaire.ended": {"reason": re.compile("done|declined|left")},
        "session.plan": {
            **{f"settings.study.questionnaires.{each}": _WORDS for each in _OF_PLAN},
            "settings.study.questionnaires.when": re.compile("|".join(WHENS)),
            "settings.study.questionnaires.role": re.compile(SUSPICION),
            "settings.study.questionnaires.scores.how": re.compile("|".join(HOWS)),
        },
    },
    begun=("questionnaire",),
    private={"questionnaire.answered": ("value", "ticked", "text")},
)
