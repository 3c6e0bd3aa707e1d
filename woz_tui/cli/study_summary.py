"""What `woz check` says about the study around the robot: in a few lines, and for programs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import msgspec

from woz_tui.analysis.text_format import counted
from woz_tui.config.counterbalancing import Order, block_size, planned, rows
from woz_tui.config.experiment import Experiment
from woz_tui.config.feature_section import sections
from woz_tui.config.study import Design
from woz_tui.protocol.messages import Json
from woz_tui.session.session_plan import study_settings

#: So many orders are listed; the rest is counted.
_LISTED = 12


def study_lines(experiment: Experiment) -> Iterator[tuple[str, str]]:
    """Yields subjects and sentences about the study; nothing without any of these sections."""
    study, conditions = experiment.study, experiment.conditions
    for name, texts in experiment.by_condition.items():
        yield f"{{{name}}}", "; ".join(f'{each}: "{text}"' for each, text in texts.items())
    if study.design is not None:
        yield "design", design_sentence(study.design, len(conditions))
        for row, order in enumerate(rows(study.design, conditions)[:_LISTED]):
            yield f"row {row + 1}", order_text(order, study.design.blind)
        left = len(rows(study.design, conditions)) - _LISTED
        if left > 0:
            yield "", f"and {left} more: woz design"
    for check in study.preflight:
        yield "preflight", check
    for section in sections():
        yield from section.summary(section.of(experiment))
    for cue, names in study.answers.items():
        yield "answers", f"{cue}: {', '.join(names)}"
    if study.perception.hide:
        yield "hidden", ", ".join(study.perception.hide)
    if study.perception.blur:
        yield "blurred", ", ".join(study.perception.blur)


def as_json(experiment: Experiment) -> dict[str, Json]:
    """The study for programs: its sections, and the design's orders."""
    study = experiment.study
    found: dict[str, Json] = msgspec.to_builtins(study_settings(experiment))
    for now in ("assigned", "planned", "trial", "running", "on_break", "due"):
        del found[now]
    found["preflight"] = [*study.preflight]
    for section in sections():
        found |= section.as_json(section.of(experiment))
    if study.design is not None:
        found["orders"] = [[*order] for order in rows(study.design, experiment.conditions)]
        found["planned"] = planned(study.design, experiment.conditions)
    return found


def design_sentence(design: Design, conditions: int) -> str:
    """The design in one sentence."""
    count = counted(conditions, "condition")
    who = f"everybody gets all {count}" if design.within else f"everybody gets one of {count}"
    trials = f"{counted(design.trials, 'trial')} in each"
    how = {
        "latin-square": "Latin square (Williams)",
        "blocks": f"shuffled blocks of {block_size(design, range(conditions))}, seed {design.seed}",
        "fixed": "in the order of the file" if design.within else "in turn",
    }[design.order]
    if not conditions:
        return counted(design.trials, "trial")
    blind = "; the wizard sees labels" if design.blind else ""
    return f"{how}: {who}, {trials}{blind}"


def order_text(order: Order, blind: Mapping[str, str]) -> str:
    """`warm (A), cold (B)`."""
    return ", ".join(f"{each} ({blind[each]})" if blind else each for each in order) or "-"
