"""An experiment without what the robot that plays it cannot do, for demos.

What a study leaves out has to stay in sight; a demo that shows off a robot has the size of that
robot.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from typing import Any

from woz_tui.config.engagement_section import signs_given
from woz_tui.config.experiment import (
    Action,
    Engagement,
    Experiment,
    ParallelCalls,
    Step,
)
from woz_tui.config.feature_section import FeatureSection
from woz_tui.config.performers import performers
from woz_tui.config.sensor_names import ENGAGEMENT, POSE, published_names
from woz_tui.feature import answer_of, pieces


def fitted(experiment: Experiment) -> Experiment:
    """Without actions of which the robot does nothing, panels that are empty then, and sensors and
    signs that nobody gives. What is left out inside of an action is not told of.
    """
    playable = [
        replace(panel, actions=tuple(filter(_does_something, panel.actions)))
        for panel in experiment.panels
    ]
    titles = {panel.title for panel in playable if panel.actions}
    panels = []
    for panel in playable:
        actions = tuple(map(_without_remarks, panel.actions))
        kept = tuple(action for action in actions if _panels_locked_by(action) <= titles)
        if kept:
            panels.append(replace(panel, actions=kept))
    names = {action.name for panel in panels for action in panel.actions}
    published = {
        name for own in published_names(experiment.drivers).values() for name in own.values()
    }
    given = published | {
        sign for panel in panels for action in panel.actions for sign in signs_given(action)
    }
    engagement = _with_signs(experiment.engagement, given)
    sections: dict[object, Any] = {}
    for name, section in pieces("section", FeatureSection).items():
        said = section.of(experiment)
        sections[section] = answer_of(name, said, section.fitted, said, names)
    known = published | {POSE} | ({ENGAGEMENT} if engagement is not None else set())
    return replace(
        experiment,
        panels=tuple(panels),
        sections=sections,
        sensors=tuple(name for name in experiment.sensors if name in known),
        engagement=engagement,
        warnings=(),
    )


def _does_something(action: Action) -> bool:
    """Whether anything remains that a visitor would notice, if something is left out."""
    return not action.left_out or any(call.driver not in performers() for call in action.calls)


def _panels_locked_by(action: Action) -> set[str]:
    """Panels that it locks or unlocks."""
    return {str(call.args["panel"]) for call in action.calls if call.verb in ("lock", "unlock")}


def _without_remarks(action: Action) -> Action:
    steps: list[Step] = []
    for step in action.steps:
        if isinstance(step, ParallelCalls):
            step = replace(step, left_out=())  # noqa: PLW2901
            if not step.calls:
                continue
        steps.append(step)
    return replace(action, steps=tuple(steps))


def _with_signs(engagement: Engagement | None, given: Collection[str]) -> Engagement | None:
    """Engagement that can be reached by the signs that are given; None: there are none."""
    if engagement is None:
        return None
    settings = engagement.settings
    signs = tuple(name for name in settings.signs if settings.sign(name).sensor or name in given)
    return replace(engagement, settings=replace(settings, signs=signs)) if signs else None
