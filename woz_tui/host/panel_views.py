"""The experiment as a console sees it."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import asdict
from typing import Protocol

import msgspec

from woz_tui.config.experiment import Action, Experiment, Panel, Profile
from woz_tui.config.profiles import FIELDS
from woz_tui.config.sensor_names import published_names
from woz_tui.drivers.contract import Driver
from woz_tui.protocol.messages import Json
from woz_tui.protocol.panels import ActionView, PanelView, PhaseView
from woz_tui.protocol.welcome import Allowance, ModelLimits
from woz_tui.session.session import Session

log = logging.getLogger(__name__)


class Cast(Protocol):
    """An experiment and the classes of its drivers; a session is one."""

    @property
    def experiment(self) -> Experiment:
        """What the file says."""
        ...

    @property
    def catalogue(self) -> Mapping[str, type[Driver]]:
        """Driver classes by type."""
        ...


def panel_views(
    experiment: Experiment, locked: Mapping[str, bool], profile: Profile | None = None
) -> list[PanelView]:
    """All panels with their actions, in the file's order.

    What `profile` does not allow is locked, or left out where it says `hide`.
    """
    views = [
        PanelView(
            title=panel.title,
            actions=[
                action_view(action, profile)
                for action in panel.actions
                if profile is None or not profile.hide or profile.plays(action)
            ],
            locked=locked.get(panel.title, panel.locked) or _shut(panel, profile),
            covers=list(panel.covers),
        )
        for panel in experiment.panels
    ]
    return [view for view in views if view.actions or not (profile and profile.hide)]


def _shut(panel: Panel, profile: Profile | None) -> bool:
    """Whether nothing of a panel is in the profile."""
    return profile is not None and not any(map(profile.plays, panel.actions))


def action_view(action: Action, profile: Profile | None) -> ActionView:
    """One action, locked where the profile does not allow it."""
    calls = action.calls
    return ActionView(
        name=action.name,
        label=action.label,
        key=action.key,
        help=action.help,
        verbs=list(dict.fromkeys(call.verb for call in calls)),
        utterances=[
            text for call in calls if isinstance(text := call.args.get("text"), str) and text
        ],
        locked=action.locked or (profile is not None and not profile.plays(action)),
        then=[*action.then],
    )


def phase_views(experiment: Experiment) -> list[PhaseView]:
    """All phases in the file's order."""
    return [msgspec.convert(phase, PhaseView, from_attributes=True) for phase in experiment.phases]


def verb_names(experiment: Experiment) -> dict[str, list[str]]:
    """Names of the verbs that each driver offers."""
    return {spec.name: [verb.name for verb in spec.verbs] for spec in experiment.drivers}


def variable_names(session: Session) -> list[str]:
    """What may stand in braces in an utterance."""
    return sorted(session.values())


def allowances(experiment: Experiment) -> dict[str, Allowance]:
    """What each profile names, by its name; `hide` where it does not show the rest."""
    return {name: _allowance(profile) for name, profile in experiment.profiles.items()}


def _allowance(profile: Profile) -> Allowance:
    named = {field: sorted(getattr(profile, field)) for field in FIELDS if field != "hide"}
    return Allowance(**named, hide=profile.hide)


def engagement_limits(experiment: Experiment) -> ModelLimits:
    """What limits the engagement model in time; nothing in a session without one."""
    if experiment.engagement is None:
        return ModelLimits()
    settings = experiment.engagement.settings
    handshake = settings.handshake
    return ModelLimits(asdict(settings.timeouts), handshake.seconds, handshake.attempts)


def joint_limits(session: Cast) -> dict[str, tuple[float, float]]:
    """Lowest and highest angle of each joint in degrees, as far as its driver's class tells.

    Named as its sensor is published, without `joint.`: `left.pan` for `left.joint.pan`.
    """
    limits: dict[str, tuple[float, float]] = {}
    published = published_names(session.experiment.drivers)
    for spec in session.experiment.drivers:
        joints = session.catalogue[spec.type].joints(spec.settings)
        for name, span in (joints or {}).items():
            if span.low is not None and span.high is not None:
                sensor = published[spec.name].get(f"joint.{name}", name)
                limits[sensor.replace("joint.", "", 1)] = float(span.low), float(span.high)
    return limits


def outlines(session: Cast) -> dict[str, Json]:
    """What drivers look like, by name, as far as their classes tell: `outline(settings)`.

    A body's outline has the `kind` body, its `joints` from the base up and its `face`; a control
    panel's has the `kind` panel and its `controls`.
    """
    told: dict[str, Json] = {}
    for spec in session.experiment.drivers:
        try:
            outline = session.catalogue[spec.type].outline(spec.settings)
            if outline:
                told[spec.name] = outline
        except Exception:  # a stranger's code must not keep the wizard from attaching
            log.exception("the outline of %s is left out", spec.name)
    return told
