"""What a log's `session.plan` says of the study around its session."""

from __future__ import annotations

from typing import Any

import msgspec

from woz_tui.core import messages as m
from woz_tui.core.messages import Json


def study_of(plan: m.SessionPlan) -> dict[str, Any]:
    """What a plan says of the study; nothing where it says nothing, or nothing sensible."""
    told = plan.settings.get("study")
    return told if isinstance(told, dict) else {}


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
