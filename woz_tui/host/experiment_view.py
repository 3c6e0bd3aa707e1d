"""Makes what consoles get of an experiment, for the welcome and for the log."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import msgspec

from woz_tui.config.experiment import Action, Experiment
from woz_tui.config.sensor_names import published_names
from woz_tui.feature import answer_of, pieces
from woz_tui.host.feature_view import FeatureView
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json
from woz_tui.protocol.panels import ActionView, PanelView
from woz_tui.protocol.sentence import Sentence
from woz_tui.protocol.welcome import ModelLimits, StudySettings, WelcomeSettings
from woz_tui.session.session import Session
from woz_tui.session.session_plan import study_settings, study_snapshot
from woz_tui.session.session_start import text_without_home

log = logging.getLogger(__name__)


def panel_views(
    experiment: Experiment, locked: Mapping[str, bool], facts: Mapping[str, object] | None = None
) -> list[PanelView]:
    """All panels with their actions, in the file's order. `facts`: what holds of features."""
    features = pieces("view", FeatureView)
    views = []
    for panel in experiment.panels:
        view: PanelView | None = PanelView(
            title=panel.title,
            actions=[action_view(action) for action in panel.actions],
            locked=locked.get(panel.title, panel.locked),
            covers=list(panel.covers),
            parts=list(panel.parts),
        )
        for name, feature in features.items():
            if view is not None:
                fact = (facts or {}).get(name)
                view = answer_of(name, view, feature.panel, panel, view, fact)
        if view is not None:
            views.append(view)
    return views


def action_view(action: Action) -> ActionView:
    calls = action.calls
    return ActionView(
        name=action.name,
        label=str(action.label),
        key=action.key,
        help=action.help,
        verbs=list(dict.fromkeys(call.verb for call in calls)),
        utterances=[
            text for call in calls if isinstance(text := call.args.get("text"), str) and text
        ],
        locked=action.locked,
        then=[*action.then],
        without=[each.what for each in action.left_out],
        code=action.label.code if isinstance(action.label, Sentence) else "",
    )


def engagement_limits(experiment: Experiment) -> ModelLimits:
    """What limits the engagement model in time; nothing in a session without one."""
    if experiment.engagement is None:
        return ModelLimits()
    settings = experiment.engagement.settings
    handshake = settings.handshake
    return ModelLimits(settings.limits, handshake.seconds, handshake.attempts)


def joint_limits(shown: ExperimentView) -> dict[str, tuple[float, float]]:
    """Lowest and highest angle of each joint in degrees, as far as its driver's class tells.

    Named as its sensor is published, without `joint.`: `left.pan` for `left.joint.pan`.
    """
    limits: dict[str, tuple[float, float]] = {}
    published = published_names(shown.experiment.drivers)
    for spec in shown.experiment.drivers:
        for name, span in (spec.offer.joints or {}).items():
            if span.low is not None and span.high is not None:
                sensor = published[spec.name].get(f"joint.{name}", name)
                limits[sensor.replace("joint.", "", 1)] = float(span.low), float(span.high)
    return limits


def driver_outlines(shown: ExperimentView) -> dict[str, Json]:
    """What drivers look like, by name, as far as their classes tell.

    A body's outline has the `kind` body, its `joints` from the base up and its `face`; a control
    panel's has the `kind` panel and its `controls`.
    """
    drivers = shown.experiment.drivers
    return {spec.name: {**spec.offer.outline} for spec in drivers if spec.offer.outline}


def driver_moves(shown: ExperimentView) -> dict[str, list[str]]:
    """All moves that a driver plays, by driver, as far as their classes tell; those of a whole
    robot are in its outline.
    """
    return {
        spec.name: [*argument.choices]
        for spec in shown.experiment.drivers
        if "moves" not in spec.offer.outline
        for verb in spec.offer.verbs
        for argument in verb.arguments
        if (verb.name, argument.name) == ("play", "move") and argument.choices
    }


@dataclass(frozen=True, slots=True)
class ExperimentView:
    """An experiment, and how it stands in a session: locks by panel's title, what holds of features
    by name, the variables with their values at this moment, what holds in the study.
    """

    experiment: Experiment
    locked: Mapping[str, bool] = field(default_factory=dict)
    facts: Mapping[str, object] = field(default_factory=dict)
    values: Mapping[str, str] = field(default_factory=dict)
    study: StudySettings | None = None

    @classmethod
    def of(cls, session: Session) -> ExperimentView:
        """As a session stands now."""
        return cls(
            session.experiment,
            session.locked,
            session.features.facts(),
            session.own_values(),
            study_snapshot(session.state.study.settings, session.state),
        )


def plan_of(shown: ExperimentView) -> m.SessionPlan:
    """Everything a console is shown, with all values."""
    experiment = shown.experiment
    nothing: Mapping[str, Any] = {}
    fields: dict[str, Any] = {}  # of features, as the settings
    settings: dict[str, Any] = {}
    for name, view in pieces("view", FeatureView).items():
        fact = shown.facts.get(name)
        settings |= answer_of(name, nothing, view.settings, experiment, fact)
        fields |= answer_of(name, nothing, view.plan, experiment)
    return m.SessionPlan(
        title=experiment.title,
        panels=panel_views(experiment, shown.locked, shown.facts),
        verbs={spec.name: [verb.name for verb in spec.offer.verbs] for spec in experiment.drivers},
        variables=sorted(shown.values),
        conditions=list(experiment.conditions),
        keyboard=experiment.keyboard,
        drivers=[spec.name for spec in experiment.drivers],
        simulated=[spec.name for spec in experiment.drivers if spec.simulated],
        settings=WelcomeSettings(
            stale_after=experiment.session.stale_after,
            dead_man=experiment.session.dead_man,
            abandon_after=experiment.session.abandon_after,
            driving=experiment.session.driving,
            participant_pattern=experiment.participant_pattern,
            joints=joint_limits(shown),
            outlines=driver_outlines(shown),
            moves=driver_moves(shown),
            values=dict(shown.values),
            steps=asdict(experiment.steps),
            lanes={
                spec.name: {verb.name: verb.lane for verb in spec.offer.verbs}
                for spec in experiment.drivers
            },
            engagement=engagement_limits(experiment),
            sensors=[*experiment.sensors],
            study=shown.study or study_settings(experiment),
            **settings,
        ),
        **fields,
    )


def plan_for_log(shown: ExperimentView) -> m.SessionPlan:
    """The same without what tells who is there: of the variables only the experiment's own, and
    the home folder is `~` wherever a text begins a path with it.
    """
    plan = plan_of(shown)
    own = {name: text for name, text in shown.values.items() if name in shown.experiment.variables}
    settings = msgspec.structs.replace(plan.settings, values=own)
    logged = msgspec.structs.replace(plan, settings=settings)
    line = text_without_home(codec.encode(logged).decode())
    return msgspec.json.decode(line, type=m.SessionPlan)
