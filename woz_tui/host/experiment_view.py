"""What consoles are shown of an experiment: the same for the welcome and for the log."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field

import msgspec

from woz_tui.config.experiment import Experiment, Profile
from woz_tui.drivers.contract import Driver
from woz_tui.host.panel_views import (
    action_view,
    allowances,
    engagement_limits,
    joint_limits,
    outlines,
    panel_views,
    phase_views,
    verb_names,
)
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol.welcome import StudySettings, WelcomeSettings
from woz_tui.session.session import Session
from woz_tui.session.session_start import without_home
from woz_tui.session.study_settings import study_settings, study_snapshot


@dataclass(frozen=True, slots=True)
class ExperimentView:
    """An experiment, and how it stands in a session: locks by panel's title, the profile in use,
    the variables with their values at this moment, what holds in the study.
    """

    experiment: Experiment
    catalogue: Mapping[str, type[Driver]]
    locked: Mapping[str, bool] = field(default_factory=dict)
    profile: Profile | None = None
    values: Mapping[str, str] = field(default_factory=dict)
    study: StudySettings | None = None

    @classmethod
    def of(cls, session: Session) -> ExperimentView:
        """As a session stands now."""
        return cls(
            session.experiment,
            session.catalogue,
            session.locked,
            session.profiles.current,
            session.values(),
            study_snapshot(session.study.settings, session.study.state),
        )


def plan_of(shown: ExperimentView) -> m.SessionPlan:
    """Everything a console is shown, with all values."""
    experiment = shown.experiment
    return m.SessionPlan(
        title=experiment.title,
        panels=panel_views(experiment, shown.locked, shown.profile),
        script=list(experiment.script),
        verbs=verb_names(experiment),
        variables=sorted(shown.values),
        conditions=list(experiment.conditions),
        keyboard=experiment.keyboard,
        drivers=[spec.name for spec in experiment.drivers],
        settings=WelcomeSettings(
            stale_after=experiment.session.stale_after,
            dead_man=experiment.session.dead_man,
            participant_pattern=experiment.participant_pattern,
            joints=joint_limits(shown),
            outlines=outlines(shown),
            values=dict(shown.values),
            steps=asdict(experiment.steps),
            lanes={
                spec.name: {verb.name: verb.lane for verb in spec.verbs}
                for spec in experiment.drivers
            },
            repairs=[action_view(action, None) for action in experiment.repairs],
            profiles=[*experiment.profiles],
            profile=shown.profile.name if shown.profile is not None else "",
            allows=allowances(experiment),
            engagement=engagement_limits(experiment),
            phases=phase_views(experiment),
            sensors=[*experiment.sensors],
            study=shown.study or study_settings(experiment),
        ),
    )


def plan_for_log(shown: ExperimentView) -> m.SessionPlan:
    """The same without what tells who is there: of the variables only the experiment's own, and
    the home folder is `~` wherever a text begins a path with it.
    """
    plan = plan_of(shown)
    own = {name: text for name, text in shown.values.items() if name in shown.experiment.variables}
    settings = msgspec.structs.replace(plan.settings, values=own)
    told = msgspec.structs.replace(plan, settings=settings)
    line = without_home(codec.encode(told).decode())
    return msgspec.json.decode(line, type=m.SessionPlan)
