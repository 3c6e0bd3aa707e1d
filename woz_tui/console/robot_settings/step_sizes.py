"""How far one press of an arrow key moves: as in the experiment file, or as the wizard sets it."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace

import msgspec

from woz_tui.config.screen_language import word
from woz_tui.console.input.keyboard import ArrowSizes, Keyboard
from woz_tui.protocol.robot_outline import Setting
from woz_tui.protocol.sentence import Sentence

SECTION = Sentence("settings.arrow_keys", "Arrow keys of this console")
#: The same limits as a section `steps` of an experiment file has.
STEPS = (
    Setting(name="head", section=SECTION, label=Sentence("settings.head", "Head"),
            verb="nudge", kind="number", low=0.1, high=90, step=1, unit="°",
            help=Sentence("settings.head_help", "one press turns the head so far")),
    Setting(name="hip", section=SECTION, label=Sentence("settings.hip", "Hip, with shift"),
            verb="hip", kind="number", low=0.1, high=45, step=1, unit="°",
            help=Sentence("settings.hip_help", "one press bends the hip so far")),
    Setting(name="drive", section=SECTION, label=Sentence("settings.drive", "Drive, with alt"),
            verb="drive", kind="number", low=0.01, high=5, step=0.05, unit="m",
            help=Sentence("settings.drive_help", "one press drives the base so far")),
    Setting(name="turn", section=SECTION, label=Sentence("settings.turn", "Turn, with alt"),
            verb="drive", kind="number", low=1, high=360, step=5, unit="°",
            help=Sentence("settings.turn_help", "one press turns the base so far")),
)  # fmt: skip


class ArrowSteps:
    """The steps of one console's arrow keys."""

    def __init__(self, keyboard: Keyboard) -> None:
        self._keyboard = keyboard
        self._of_file: Mapping[str, float] = {}

    def adopt(self, told: Mapping[str, float]) -> None:
        """Take the experiment file's steps; the same ones again keep the wizard's changes."""
        if told == self._of_file:
            return
        self._of_file = told
        for setting in STEPS:
            value = told.get(setting.name)
            if value is not None and setting.low <= value <= setting.high:  # NaN is not
                self.change(setting.name, value)

    def change(self, name: str, value: float) -> None:
        """From now on one press goes so far: degrees, or metres of `drive`."""
        changed: dict[str, float] = {name: value}
        self._keyboard.steps = replace(self._keyboard.steps, **changed)

    def value(self, name: str) -> float:
        """How far one press goes now."""
        return float(getattr(self._keyboard.steps, name))


def steps_offered(verbs: Collection[str]) -> list[Setting]:
    """The steps of those arrow keys that move something, in the language of the screen."""
    return [
        msgspec.structs.replace(setting, label=word(setting.label), help=word(setting.help))
        for setting in STEPS
        if setting.verb in verbs
    ]


__all__ = ["SECTION", "STEPS", "ArrowSizes", "ArrowSteps", "steps_offered"]
