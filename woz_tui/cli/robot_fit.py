"""What another robot than the file's own does of each action, for `woz check --robot`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from rich.columns import Columns
from rich.table import Table
from rich.text import Text

from woz_tui.config.bundled_files import robot_files
from woz_tui.config.experiment import Action, Call, Experiment, ParallelCalls
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.loading import load
from woz_tui.config.performers import performers
from woz_tui.config.robots import PLAY
from woz_tui.console.drawing.text_console import TextConsole
from woz_tui.drivers.contract import Driver
from woz_tui.protocol.messages import Json

#: For `--robot`: every robot there is a file of.
ALL = "all"
#: How much of an action a robot does, and the looks of the word.
_STYLES = {"yes": "green", "part": "yellow", "no": "red"}
#: Actions below one heading, and cells of an action's label and of a robot's column, gap included.
_ROWS, _LABELS, _COLUMN = 20, (8, 18), 5


def actions_of(experiment: Experiment) -> list[Action]:
    """The actions whose table is shown: all but those that need no verb."""
    return [action for action in experiment.actions if action.steps]


def share(action: Action) -> str:
    """How much of it this robot does: yes (all), part, no (nothing)."""
    if not action.left_out:
        return "yes"
    return "part" if action.calls else "no"


def action_table(experiment: Experiment) -> Table:
    """For each action: what this robot does and which driver does it, and what is left out."""
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0), header_style="bold")
    table.add_column("panel", overflow="fold", style="dim", max_width=12)
    table.add_column("action", overflow="fold", max_width=18)
    table.add_column("does", overflow="fold", ratio=1)
    table.add_column("leaves out", overflow="fold", style="yellow", max_width=20)
    panel = ""
    for action in actions_of(experiment):
        heading = "" if action.panel == panel else action.panel
        panel = action.panel
        left_out = ", ".join(each.what for each in action.left_out)
        table.add_row(
            Text(heading),
            Text(action.label),
            Text(_does(action, len(experiment.drivers) > 1)),
            Text(left_out),
        )
    return table


def _does(action: Action, several: bool) -> str:
    """`say, play nod`, steps one after the other; with `several` drivers `say -> voice`."""
    steps = [step.calls for step in action.steps if isinstance(step, ParallelCalls)]
    texts = [", ".join(_call(call, several) for call in calls) for calls in steps if calls]
    return "; ".join(texts) or "nothing"


def _call(call: Call, several: bool) -> str:
    move = call.args.get("move") if call.verb == PLAY else None
    text = f"{call.verb} {move}" if isinstance(move, str) else call.verb
    return f"{text} -> {call.driver}" if several and call.driver not in performers() else text


@dataclass(frozen=True, slots=True)
class RobotMatrix:
    """One experiment on several robots; `wrong`: those whose file cannot be used, and why."""

    experiments: dict[str, Experiment] = field(default_factory=dict)
    wrong: dict[str, str] = field(default_factory=dict)

    @classmethod
    def of(cls, file: Path, catalogue: Mapping[str, type[Driver]]) -> RobotMatrix:
        """The experiment with each robot that there is a file of."""
        found = cls()
        for name in robot_files(file.parent):
            try:
                found.experiments[name] = load(file, catalogue, robot=name)
            except ExperimentError as error:
                found.wrong[name] = str(error.problems[0])
        return found

    def as_json(self) -> Json:
        """For each robot what it leaves out, by action."""
        return {
            "robots": {
                name: {
                    action.name: [each.what for each in action.left_out]
                    for action in actions_of(experiment)
                }
                for name, experiment in self.experiments.items()
            },
            "wrong": {**self.wrong},
        }

    def show(self, console: TextConsole) -> None:
        """What the columns are, a row for each action; then what each robot leaves out."""
        names = (f"{number} {name}" for number, name in enumerate(self.experiments, 1))
        console.print(Columns(map(Text, names), padding=(0, 3)))
        first = next(iter(self.experiments.values()), None)
        actions = list(actions_of(first)) if first is not None else []
        for begin in range(0, len(actions), _ROWS):
            console.print()
            console.print(self._table(actions[begin : begin + _ROWS], console.width))
        console.print()
        for number, (name, experiment) in enumerate(self.experiments.items(), 1):
            counts = Counter(
                each.what for action in actions_of(experiment) for each in action.left_out
            )
            what = ", ".join(f"{verb} {count}" for verb, count in counts.most_common())
            does = f"leaves out {what}" if what else "does everything"
            console.print(Text(f"{number:2} {name}: {does}"))
        for name, why in self.wrong.items():
            console.print(Text(f"   {name}: {why}"))

    def _table(self, actions: Sequence[Action], width: int) -> Table:
        """Columns as wide as in any other part of the whole."""
        least, most = _LABELS
        label = max(least, min(most, width - _COLUMN * len(self.experiments) - 1))
        table = Table(box=None, pad_edge=False, padding=(0, 1, 0, 0), header_style="bold")
        table.add_column("action", overflow="fold", width=label)
        for number, _ in enumerate(self.experiments, 1):
            table.add_column(str(number), no_wrap=True, width=_COLUMN - 1)
        for action in actions:
            cells = []
            for experiment in self.experiments.values():
                same = next(each for each in experiment.actions if each.name == action.name)
                how = share(same)
                cells.append(Text(how, style=_STYLES[how]))
            table.add_row(Text(action.label), *cells)
        return table
