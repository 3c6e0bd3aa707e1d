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
_LANGUAGE = re.compile(r"[a-z]{2,3}(-[A-Za-z0-9]{1,8})*|")
#: What an item says, and what of it has texts within.
_WORDS_OF_ITEM = (
    *("name", "question", "ends", "stem", "unit", "group", "does_not_apply", "prefer_not"),
    *("labels.text", "choices.text", "only_if.item"),
)
_OF_ITEM = {
    **dict.fromkeys(_WORDS_OF_ITEM, _WORDS),
    "kind": re.compile("scale|slider|choices?|number|month|page"),
}
_OF_VERSION = {
    **dict.fromkeys(("title", "introduction"), _WORDS),
    "language": _LANGUAGE,
    **{f"items.{place}": text for place, text in _OF_ITEM.items()},
}
_OF_PLAN = {
    "name": _WORDS,
    **_OF_VERSION,
    **{f"versions.{place}": text for place, text in _OF_VERSION.items()},
    **dict.fromkeys((f"scores.{each}" for each in ("name", "items", "reverse", "pairs")), _WORDS),
    "scores.how": re.compile("|".join(HOWS)),
    "when": re.compile("|".join(WHENS)),
    "role": re.compile(SUSPICION),
}

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
            "language": _LANGUAGE,
            "given": re.compile("|".join(GIVEN)),
            **{f"items.{place}": text for place, text in _OF_ITEM.items()},
        },
        "questionnaire.answered": {
            "reason": re.compile("does_not_apply|prefer_not"),
            "given": re.compile("|".join(GIVEN)),
        },
        "questionnaire.ended": {"reason": re.compile("done|declined|left")},
        "session.plan": {
            f"settings.study.questionnaires.{place}": text for place, text in _OF_PLAN.items()
        },
    },
    begun=("questionnaire",),
    private={"questionnaire.answered": ("value", "ticked", "text")},
)
