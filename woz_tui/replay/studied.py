"""The study around a session, as it stood at a moment of its log."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import msgspec

from woz_tui.core import messages as m
from woz_tui.core.messages import Json
from woz_tui.session.progress import Progress
from woz_tui.session.study_view import standing

#: What a progress goes by.
SEEN = (
    m.SessionStart,
    m.SessionChanged,
    m.ConditionsAssigned,
    m.TrialStarted,
    m.TrialEnded,
    m.BreakStarted,
    m.BreakEnded,
    m.PreflightChecked,
    m.QuestionnaireStarted,
    m.QuestionnaireAnswered,
    m.QuestionnaireEnded,
)


def study_of(plan: m.SessionPlan) -> dict[str, Any]:
    """What a plan says of the study; nothing where it says nothing, or nothing sensible."""
    told = plan.settings.get("study")
    return told if isinstance(told, dict) else {}


def study_at(plan: m.SessionPlan, messages: Iterable[m.AnyMessage]) -> dict[str, Json]:
    """`settings["study"]` of a welcome after these messages; empty for a plan without it."""
    told = study_of(plan)
    listed = told.get("preflight")
    if not told or not isinstance(listed, list):
        return told
    checks = [each.get("check", "") if isinstance(each, Mapping) else str(each) for each in listed]
    progress = Progress({**told, "preflight": checks})
    for message in messages:
        progress.see(message)
    return standing(progress)


def blind_study(plan: m.SessionPlan) -> dict[str, Json]:
    """What a plan says of the study, if its wizard is blind to the condition; else nothing."""
    return study_of(plan) if labels_of(plan) else {}


def labels_of(plan: m.SessionPlan) -> dict[str, str]:
    """Condition -> what a wizard is told instead who is blind to it."""
    blind = study_of(plan).get("blind")
    pairs = blind.items() if isinstance(blind, dict) else ()
    return {str(condition): str(label) for condition, label in pairs}


def revealed(plan: m.SessionPlan) -> m.SessionPlan:
    """The plan with nothing kept from whoever sees it."""
    study = study_of(plan)
    if not study:
        return plan
    shown = {**study, "blind": {}, "perception": {"hide": [], "blur": []}}
    return msgspec.structs.replace(plan, settings={**plan.settings, "study": shown})
