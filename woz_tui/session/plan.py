"""From what a session shows (`session.plan`) to what its consoles are told."""

from __future__ import annotations

from collections.abc import Mapping

from woz_tui.core import messages as m
from woz_tui.core.requests import PROTOCOL, PanelsChanged, Welcome

#: Settings that a console is told again when panels change, and what each of them is.
_CHANGING: Mapping[str, type] = {
    "values": dict,
    "steps": dict,
    "profiles": list,
    "profile": str,
    "allows": dict,
    "engagement": dict,
    "study": dict,
}


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
    told = {
        name: plan.settings[name]
        for name, kind in _CHANGING.items()
        if isinstance(plan.settings.get(name), kind)
    }
    return PanelsChanged(
        title=plan.title,
        panels=plan.panels,
        script=plan.script,
        verbs=plan.verbs,
        conditions=plan.conditions,
        keyboard=plan.keyboard,
        **told,  # type: ignore[arg-type]  # the kinds were looked at
    )
