"""The script of an experiment: names of actions in the order in which Space plays them.

script: [Hello, Sit down, Show the whale, Bye]
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated

from woz_tui.config.action_names import check_actions
from woz_tui.config.experiment import Experiment
from woz_tui.config.feature_section import FeatureSection, FileContents
from woz_tui.config.reload_changes import section_changed
from woz_tui.config.yaml_cursor import Cursor
from woz_tui.drivers.fields import Doc
from woz_tui.features.phases.section import PHASES
from woz_tui.protocol.sentence import Sentence


@dataclass(frozen=True, kw_only=True)
class ScriptKeys:
    """The key `script`."""

    script: Annotated[tuple[str, ...], Doc("names of actions; space plays the next one")] = ()


class ScriptSection(FeatureSection[tuple[str, ...]]):
    """The lines of the file's own script. Phases may have others, which are theirs."""

    def read(
        self, table: Mapping[str, Cursor], file: ScriptKeys, contents: FileContents
    ) -> tuple[str, ...]:
        if file.script:
            check_actions(table["script"], contents.actions)
        return file.script

    def fitted(self, section: tuple[str, ...], actions: Collection[str]) -> tuple[str, ...]:
        return tuple(line for line in section if line in actions)

    def changes(self, old: tuple[str, ...], new: tuple[str, ...]) -> Iterable[str]:
        if len(old) != len(new):
            yield Sentence(
                "reload.script_lines",
                "script has {now} lines, it had {was}",
                now=len(new),
                was=len(old),
            )
        elif old != new:
            yield section_changed("script")

    def all_of(self, experiment: Experiment) -> dict[str, Sequence[str]]:
        """The lines of all scripts, by the phase whose each is; empty: the file's own."""
        phases = {phase.name: phase.script for phase in PHASES.of(experiment) if phase.script}
        return {"": self.of(experiment), **phases}


SCRIPT = ScriptSection(ScriptKeys, ())
