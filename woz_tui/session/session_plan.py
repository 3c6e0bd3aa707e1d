"""What consoles get of a session: welcome and panels from its plan, and the study's settings.

`docs/reference/protocol.md` has the keys.
"""

from __future__ import annotations

from typing import Any

import msgspec

from woz_tui.config.experiment import Experiment
from woz_tui.config.feature_section import FeatureSection
from woz_tui.feature import pieces
from woz_tui.protocol import messages as m
from woz_tui.protocol import welcome as s
from woz_tui.protocol.requests import PANEL_SETTINGS, PROTOCOL, PanelsChanged, Welcome
from woz_tui.timeline.session_state import SessionState


def study_settings(experiment: Experiment) -> s.StudySettings:
    """What the file says; what became of it is in the stream's messages."""
    study = experiment.study
    of_features: dict[str, Any] = {}
    for section in pieces("section", FeatureSection).values():
        of_features |= section.study(section.of(experiment))
    return s.StudySettings(
        preflight=[*map(s.PreflightCheck, study.preflight)],
        perception=s.PerceptionView([*study.perception.hide], [*study.perception.blur]),
        language=experiment.language,
        answers={cue: [*names] for cue, names in study.answers.items()},
        by_condition={name: dict(texts) for name, texts in experiment.by_condition.items()},
        **of_features,
    )


def study_snapshot(settings: s.StudySettings, state: SessionState) -> s.StudySettings:
    """The file's part, and what holds now: the list with its ticks, the order, what features say.

    Args:
        settings: What the file says, or what a log's `session.plan` says of it.
        state: What holds now.
    """
    study = state.study
    of_features: dict[str, Any] = {}
    for history in state.histories.values():
        of_features |= history.study(state)
    return msgspec.structs.replace(
        settings,
        preflight=[
            s.PreflightCheck(each.check, study.ticked(each.check)) for each in settings.preflight
        ],
        assigned=[*study.order],
        planned=study.planned,
        trial=study.next_trial,
        running=study.trial is not None,
        on_break=study.in_break is not None,
        **of_features,
    )


#: What a welcome and a change of the panels take over from a plan.
_PLAN = tuple(
    name
    for name in PanelsChanged.__struct_fields__
    if name in m.SessionPlan.__struct_fields__ and name in Welcome.__struct_fields__
)


def welcome(plan: m.SessionPlan, *, console: str, role: str, seq: int, t: int, log: str) -> Welcome:
    """A welcome with this plan, and neither state nor history yet."""
    return Welcome(
        protocol=PROTOCOL,
        console=console,
        role=role,
        seq=seq,
        t=t,
        log=log,
        drivers=plan.drivers,
        settings=plan.settings,
        **_panels(plan),
    )


def panels_changed(plan: m.SessionPlan) -> PanelsChanged:
    """What is news in a plan for a console that has had another one."""
    settings: dict[str, Any] = {name: getattr(plan.settings, name) for name in PANEL_SETTINGS}
    return PanelsChanged(**_panels(plan), **settings)


def _panels(plan: m.SessionPlan) -> dict[str, Any]:
    """What both have of a plan."""
    return {name: getattr(plan, name) for name in _PLAN}
