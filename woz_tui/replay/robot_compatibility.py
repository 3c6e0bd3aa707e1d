"""Can the robot of now do what a plan wants? Asked of the experiment before anything moves."""

from __future__ import annotations

from dataclasses import replace

from woz_tui.config.experiment import Experiment
from woz_tui.drivers.argument_check import ArgumentError, checked
from woz_tui.drivers.contract import Verb
from woz_tui.replay.rerun_plan import RerunPlan, RerunStep
from woz_tui.session.session_driver import SESSION, VERBS

#: Begins every reason that lies in the present robot, and not in what happened then.
UNFIT = "not possible now: "


def fitted(plan: RerunPlan, experiment: Experiment) -> RerunPlan:
    """The plan for this experiment: what its robot does not offer is skipped, with the reason."""
    offered = {spec.name: {verb.name: verb for verb in spec.verbs} for spec in experiment.drivers}
    offered[SESSION] = {verb.name: verb for verb in VERBS}
    return replace(plan, steps=tuple(_fitted(step, offered) for step in plan.steps))


def unfit_steps(plan: RerunPlan) -> tuple[RerunStep, ...]:
    """What a fitted plan does not send because the present robot cannot do it."""
    return tuple(step for step in plan.steps if step.skip.startswith(UNFIT))


def _fitted(step: RerunStep, offered: dict[str, dict[str, Verb]]) -> RerunStep:
    if step.skip:
        return step
    driver, name = step.command.driver, step.command.verb
    verbs = offered.get(driver)
    if verbs is None:
        there = ", ".join(one for one in offered if one != SESSION) or "none"
        return replace(step, skip=f"{UNFIT}there is no driver {driver!r} (there is {there})")
    verb = verbs.get(name)
    if verb is None:
        return replace(step, skip=f"{UNFIT}{driver} does not offer {name!r}")
    try:
        checked(verb, step.command.args)
    except ArgumentError as error:
        return replace(step, skip=f"{UNFIT}{error}")
    return replace(step, drives=verb.drives)
