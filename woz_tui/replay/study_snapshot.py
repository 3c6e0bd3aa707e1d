"""What a log's `session.plan` says of the study around its session."""

from __future__ import annotations

import msgspec

from woz_tui.protocol import messages as m
from woz_tui.protocol.welcome import PerceptionView, StudySettings


def last_blind(before: StudySettings | None, plan: m.SessionPlan) -> StudySettings:
    """The study of the last plan whose wizard was blind to the condition, else the defaults."""
    study = plan.settings.study
    return study if study.blind else before or StudySettings()


def revealed(plan: m.SessionPlan) -> m.SessionPlan:
    """The plan with nothing kept from whoever sees it."""
    study = msgspec.structs.replace(plan.settings.study, blind={}, perception=PerceptionView())
    settings = msgspec.structs.replace(plan.settings, study=study)
    return msgspec.structs.replace(plan, settings=settings)
