"""From what a session shows (`session.plan`) to what its consoles are told."""

from __future__ import annotations

from typing import Any

from woz_tui.protocol import messages as m
from woz_tui.protocol.requests import PANEL_SETTINGS, PROTOCOL, PanelsChanged, Welcome


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
    settings: dict[str, Any] = {name: getattr(plan.settings, name) for name in PANEL_SETTINGS}
    return PanelsChanged(
        title=plan.title,
        panels=plan.panels,
        script=plan.script,
        verbs=plan.verbs,
        variables=plan.variables,
        conditions=plan.conditions,
        keyboard=plan.keyboard,
        **settings,
    )
