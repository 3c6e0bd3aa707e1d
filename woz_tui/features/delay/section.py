"""The section `shaping`: how soon the robot may answer.

shaping: {floor: 0.8 s, jitter: 0.4 s, cues: [speech, marker]}
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Annotated, Any

from woz_tui.config.experiment import Experiment
from woz_tui.config.feature_section import FeatureSection, FileContents
from woz_tui.config.reload_changes import changed_settings
from woz_tui.config.study_words import CUES
from woz_tui.config.yaml_cursor import Cursor
from woz_tui.drivers.contract import SPEECH
from woz_tui.drivers.fields import Doc, OneOf, Seconds, Unique
from woz_tui.protocol.sentence import Sentence
from woz_tui.protocol.welcome import ShapingView


@dataclass(frozen=True, slots=True)
class ResponseShaping:
    """How soon the robot may answer a cue: not before `floor`, and up to `jitter` later at random,
    so that a wizard's quickness does not tell. An answer that comes later anyway is not held up.
    """

    floor: Annotated[
        float, Seconds(0, 60), Doc("shortest time from the cue to the robot's action, in seconds")
    ] = 0.0
    jitter: Annotated[
        float, Seconds(0, 60), Doc("longest random time that is added, in seconds")
    ] = 0.0
    cues: Annotated[tuple[str, ...], OneOf(CUES), Unique(), Doc("speech, engagement, marker")] = (
        "speech",
    )


@dataclass(frozen=True, kw_only=True)
class ShapingKeys:
    """The key `shaping`."""

    shaping: Annotated[ResponseShaping | None, Doc("delays before the robot answers a cue")] = None


class ShapingSection(FeatureSection[ResponseShaping | None]):
    """The section, or None where the file has none."""

    def read(
        self, table: Mapping[str, Cursor], file: Any, contents: FileContents
    ) -> ResponseShaping | None:
        shaping: ResponseShaping | None = file.shaping
        cursor = table.get("shaping")
        if cursor is None or shaping is None:
            return shaping
        cues = dict(cursor.entries()).get("cues", cursor)
        if not shaping.cues:
            cues.error(
                Sentence("delay.no_cues", "the list has no cue; add one, or remove the section")
            )
        if not shaping.floor and not shaping.jitter:
            cursor.warning(
                Sentence(
                    "delay.delays_nothing", "delays nothing; add a floor, such as floor: 0.8 s"
                )
            )
        if "engagement" in shaping.cues and "engagement" not in table:
            cues.warning(
                Sentence(
                    "delay.no_engagement",
                    "the cue engagement never occurs: the file has no section engagement",
                )
            )
        sensors = contents.sensors
        hears = sensors is None or SPEECH in {name.rpartition(".")[2] for name in sensors}
        if "speech" in shaping.cues and not hears:
            cues.warning(
                Sentence(
                    "delay.no_speech",
                    "the cue speech never occurs: no driver detects the end of speech",
                )
            )
        return shaping

    def changes(self, old: ResponseShaping | None, new: ResponseShaping | None) -> Iterable[str]:
        return changed_settings("shaping", old, new)

    def study(self, section: ResponseShaping | None) -> Mapping[str, Any]:
        if section is None:
            return {}
        return {"shaping": ShapingView(section.floor, section.jitter, [*section.cues])}

    def summary(self, experiment: Experiment) -> Iterable[tuple[str, str]]:
        section = self.of(experiment)
        if section is not None:
            first, last = section.floor, section.floor + section.jitter
            span = f"{first:g} s" if first == last else f"{first:g} to {last:g} s"
            cues = " and ".join(section.cues)
            yield "shaping", f"the robot answers no earlier than {span} after {cues}"


SHAPING = ShapingSection(ShapingKeys, None)
