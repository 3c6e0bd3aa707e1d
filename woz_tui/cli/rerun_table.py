"""What a re-run will do, in lines of text: the summary before the question, and the dry run."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace

from woz_tui.config.experiment import Experiment
from woz_tui.protocol import messages as m
from woz_tui.replay.rerun_plan import RerunPlan, RerunStep, unfit_steps
from woz_tui.session.redactor import Redactor
from woz_tui.system.text_cleaning import clean

#: Characters of the arguments that a line of the table has room for.
ARGS = 56
#: Different reasons for leaving something out that the summary tells.
REASONS = 8


def redacted(plan: RerunPlan, redactor: Redactor) -> RerunPlan:
    """The plan as the wizard may see it."""
    return replace(plan, steps=tuple(_visible_step(step, redactor) for step in plan.steps))


def _visible_step(step: RerunStep, redactor: Redactor) -> RerunStep:
    command = redactor.message(step.command)
    if command is step.command or not isinstance(command, m.Command):
        return step
    why = "reason is hidden: it could reveal what this study hides from you" if step.skip else ""
    return replace(step, command=command, skip=why)


def summary(plan: RerunPlan, experiment: Experiment, *, headless: bool) -> Iterator[str]:
    """What will be run, on what, and what will not."""
    drives = sum(step.drives for step in plan.sent)
    yield f"session     {plan.session or 'without a code'}  ({clean(plan.name)})"
    yield f"experiment  {clean(experiment.title)}  ({experiment.path})"
    yield f"robot       {_robot(plan, experiment)}"
    yield f"commands    {len(plan.sent)} in {clock(plan.duration)}{_counts(plan)}"
    if drives:
        who = (
            "are refused, because no wizard watches" if headless else "need a wizard at the console"
        )
        yield f"drives      {drives}: they {who}"
    cut = sum(step.cut >= 0 for step in plan.sent)
    if cut:
        yield f"cut short   {cut}, at the same moments as in the log"
    if plan.stops:
        yield f"stops       {plan.stops} in the log; the stop is not pressed again"
    for count, reason in _reasons(plan):
        yield f"left out    {count}: {reason}"
    if not plan.ended:
        yield "the log has no end: its session was interrupted, or is still running"
    for sentence in plan.damage:
        yield f"damage      {clean(sentence)}"


def _robot(plan: RerunPlan, experiment: Experiment) -> str:
    types = {spec.name: spec.type for spec in experiment.drivers}
    return ", ".join(f"{clean(name)} ({types.get(name, '?')})" for name in plan.drivers) or "none"


def _counts(plan: RerunPlan) -> str:
    by_driver: dict[str, list[str]] = {}
    for (driver, verb), count in plan.counts.items():
        by_driver.setdefault(clean(driver), []).append(f"{count} {clean(verb)}")
    return "".join(f"\n              {name}: {', '.join(c)}" for name, c in by_driver.items())


def _reasons(plan: RerunPlan) -> list[tuple[int, str]]:
    """The reasons, the most frequent first; rare ones beyond `REASONS` together."""
    counted = Counter(clean(step.skip) for step in plan.skipped).most_common()
    reasons = [(count, reason) for reason, count in counted[:REASONS]]
    rest = sum(count for _, count in counted[REASONS:])
    return [*reasons, (rest, "for other reasons; --dry-run names each")] if rest else reasons


def table(plan: RerunPlan) -> Iterator[str]:
    """One line for each command of the original, in order."""
    names = [f"{clean(step.command.driver)}.{clean(step.command.verb)}" for step in plan.steps]
    width = min(28, max(map(len, names), default=8))
    yield f"{'time':>10}  {'command':{width}}  {'arguments':{ARGS}}  what"
    for name, step in zip(names, plan.steps, strict=True):
        time = clock(step.at - plan.start)
        yield f"{time:>10}  {name:{width}}  {_args(step):{ARGS}}  {_outcome(step, plan)}"


def verdict(plan: RerunPlan) -> str:
    """The last line of a dry run."""
    text = f"{len(plan.sent)} would be sent, {len(plan.skipped)} left out"
    impossible = len(unfit_steps(plan))
    return f"{text}, {impossible} of them because this robot cannot do them" if impossible else text


def _outcome(step: RerunStep, plan: RerunPlan) -> str:
    if step.skip:
        return f"left out: {clean(step.skip)}"
    cut = ""
    if step.cut >= 0:
        cut = f", cut at {clock(step.cut - plan.start)} ({clean(step.why_cut)})"
    return f"{'drives' if step.drives else 'sent'}{cut}"


def _args(step: RerunStep) -> str:
    text = clean(json.dumps(step.command.args, ensure_ascii=False)) if step.command.args else ""
    return text if len(text) <= ARGS else f"{text[: ARGS - 3]}..."


def clock(us: int) -> str:
    """`1:02.345`; before the first command `-0:00.500`."""
    sign, us = ("-", -us) if us < 0 else ("", us)
    minutes, rest = divmod(us, 60_000_000)
    return f"{sign}{minutes}:{rest / 1_000_000:06.3f}"
