"""From what a session shows (`session.plan`) to what its consoles are told."""

from __future__ import annotations

from woz_tui.core import messages as m
from woz_tui.core.requests import PROTOCOL, PanelsChanged, Welcome


def welcome(plan: m.SessionPlan, *, console: str, role: str, seq: int, t: int, log: str) -> Welcome:
    """A welcome with this plan, and neither state nor history yet."""
    return Welcome(
        protocol=PROTOCOL,
        console=console,
        role=role,
        seq=seq,
        t=t,
        title=plan.title,
        log=log,
        panels=plan.panels,
        script=plan.script,
        verbs=plan.verbs,
        variables=plan.variables,
        conditions=plan.conditions,
        keyboard=plan.keyboard,
        drivers=plan.drivers,
        settings=plan.settings,
    )


def panels_changed(plan: m.SessionPlan) -> PanelsChanged:
    """What is news in a plan for a console that has had another one."""
    settings = plan.settings
    return PanelsChanged(
        title=plan.title,
        panels=plan.panels,
        script=plan.script,
        verbs=plan.verbs,
        conditions=plan.conditions,
        keyboard=plan.keyboard,
        values=settings.values,
        steps=settings.steps,
        repairs=settings.repairs,
        profiles=settings.profiles,
        profile=settings.profile,
        allows=settings.allows,
        engagement=settings.engagement,
        phases=settings.phases,
        study=settings.study,
    )
