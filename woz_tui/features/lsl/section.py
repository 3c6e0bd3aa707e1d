"""The section `lsl`: what of a session goes to a lab's recorder, and what it takes from there.

lsl:
  sensors: [distance]
  take: [{stream: eyes, as: marker}]
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal

from woz_tui.config.experiment import Experiment
from woz_tui.config.feature_section import FeatureSection, FileContents
from woz_tui.config.problems import quoted
from woz_tui.config.reload_changes import changed_entries, changed_settings
from woz_tui.config.yaml_cursor import Cursor, texts_of
from woz_tui.drivers.contract import LEAVES
from woz_tui.drivers.fields import Doc, Entry, NotBlank, OneOf, Pattern, Seconds, Unique
from woz_tui.protocol.sentence import Sentence

#: What of the log is sent only where the file says so.
SHARED = ("texts", "conditions", "codes")
#: Sensors that tell words or who somebody is.
_WORDS = ("identity", "speech", "transcriber")
#: Each stream takes two of the 32 ports that the Lab Streaming Layer has.
MOST_SENSORS = 10


@dataclass(frozen=True, slots=True)
class TakenEntry(Entry):
    """A stream of another program that is taken into the session's log."""

    what = Sentence("lsl.a_stream", "a stream")
    example = "{stream: eyes, as: marker}"
    stream: Annotated[str, NotBlank(), Doc("the stream's name, as its program gives it")]
    source_id: Annotated[str, Doc("only the one with this source_id")] = ""
    type: Annotated[str, Doc("only one of this type, such as Markers")] = ""
    as_: Annotated[
        Literal["marker", "cue", "reading"],
        Doc("marker: texts become markers; cue: markers that want an answer; reading: a sensor"),
    ] = "marker"
    sensor: Annotated[
        str,
        Pattern(r"[a-z][a-z0-9_]*|", Sentence("lsl.sensor_sign", "small letters, digits and _")),
        Doc("of a reading: what the sensor is called (default: the stream's name)"),
    ] = ""
    every: Annotated[float, Seconds(0.02, 60), Doc("of a reading: time between two at least")] = 0.1

    @property
    def called(self) -> str:
        """The name of its sensor."""
        letters = "".join(c if c.isascii() and c.isalnum() else "_" for c in self.stream.lower())
        return self.sensor or letters


@dataclass(frozen=True, slots=True)
class LslSettings:
    """What `woz lsl` sends and takes."""

    start: Annotated[
        bool, Doc("`woz lsl` is started with the session; off: start it yourself, also elsewhere")
    ] = True
    prefix: Annotated[
        str,
        Pattern(
            r"[A-Za-z][A-Za-z0-9_-]{0,30}", Sentence("lsl.stream_name", "letters, digits, - and _")
        ),
        Doc("the names of its streams begin so; another one for each robot of a lab"),
    ] = "woz"
    sensors: Annotated[
        tuple[str, ...], Unique(), Doc("names of sensors, each sent as a stream (10 at the most)")
    ] = ()
    shares: Annotated[
        tuple[str, ...],
        OneOf(SHARED),
        Unique(),
        Doc(
            "what else is sent: texts that people said, typed or wrote; conditions; codes of people"
        ),
    ] = ()
    take: Annotated[tuple[TakenEntry, ...], Doc("streams of other programs that are taken")] = ()


@dataclass(frozen=True, kw_only=True)
class LslKeys:
    """The key `lsl`."""

    lsl: Annotated[LslSettings | None, Doc("streams to and from a lab's recorder (`woz lsl`)")] = (
        None
    )


class LslSection(FeatureSection[LslSettings | None]):
    """The section, or None where the file has none."""

    in_trainings = False  # nobody is recorded in one

    def read(
        self, table: Mapping[str, Cursor], file: Any, contents: FileContents
    ) -> LslSettings | None:
        settings: LslSettings | None = file.lsl
        cursor = table.get("lsl")
        if cursor is None or settings is None:
            return settings
        keys = dict(cursor.entries())
        for entry, name in texts_of(keys.get("sensors")):
            if name.rpartition(".")[2] in _WORDS:
                entry.error(
                    Sentence(
                        "lsl.sensor_of_words",
                        "{name} gives words; a stream of a sensor has numbers",
                        name=quoted(name),
                    )
                )
            elif contents.complete and name not in (contents.sensors or (name,)):
                near = entry.report.hint(
                    name,
                    contents.sensors or (),
                    or_list=Sentence("check.sensors_are", "sensors are"),
                )
                entry.error(
                    Sentence(
                        "check.no_sensor",
                        "there is no sensor {name}{near}",
                        name=quoted(name),
                        near=near,
                    )
                )
        if len(settings.sensors) > MOST_SENSORS:
            keys["sensors"].error(
                Sentence(
                    "lsl.too_many_sensors",
                    "at most {most}: the Lab Streaming Layer has few ports",
                    most=MOST_SENSORS,
                )
            )
        _check_taken(keys.get("take"), settings, contents)
        if "conditions" in settings.shares:
            keys["shares"].warning(
                Sentence("lsl.shows_conditions", "whoever sees the recording sees the conditions")
            )
        return settings

    def changes(self, old: LslSettings | None, new: LslSettings | None) -> Iterable[str]:
        if old is None or new is None:
            return changed_settings("lsl", old, new)
        takes = ({each.stream: each for each in some.take} for some in (old, new))
        alike = replace(old, take=new.take)
        return *changed_settings("lsl", alike, new), *changed_entries(
            Sentence("reload.a_stream", "stream"), *takes
        )

    def people_data(self, experiment: Experiment) -> Iterable[tuple[str, str]]:
        section = self.of(experiment)
        if section is None:
            return
        shared = " and ".join(section.shares) or "no texts of people, conditions or codes"
        sensors = f", {', '.join(section.sensors)}" if section.sensors else ""
        yield (
            LEAVES,
            f"to every recorder of the lab's network, by `woz lsl`: events{sensors}, {shared}",
        )

    def summary(self, experiment: Experiment) -> Iterable[tuple[str, str]]:
        section = self.of(experiment)
        if section is None:
            return
        sensors = f", {', '.join(section.sensors)}" if section.sensors else ""
        shared = f", with {' and '.join(section.shares)}" if section.shares else ""
        yield "lsl", f"`woz lsl` sends markers and events{sensors}{shared}"
        for each in section.take:
            yield "lsl", f"takes the stream {each.stream} as {each.as_}"


def _check_taken(cursor: Cursor | None, settings: LslSettings, contents: FileContents) -> None:
    taken: set[str] = set()
    names = {*(contents.sensors or ())}
    entries = [*cursor.items()] if cursor is not None else []
    for entry, each in zip(entries, settings.take, strict=False):  # wrong ones are left out
        if each.stream in taken:
            entry.error(
                Sentence(
                    "lsl.stream_taken",
                    "the stream {stream} is taken already",
                    stream=quoted(each.stream),
                )
            )
        elif each.stream.startswith(f"{settings.prefix}-"):
            entry.error(
                Sentence(
                    "lsl.own_stream",
                    "{stream} would be a stream of the session itself",
                    stream=quoted(each.stream),
                )
            )
        taken.add(each.stream)
        if each.as_ == "reading" and each.called in names:
            entry.error(
                Sentence(
                    "lsl.sensor_taken",
                    "there is a sensor {called} already; add sensor: NAME",
                    called=quoted(each.called),
                )
            )
        elif each.as_ == "reading":
            names.add(each.called)


LSL = LslSection(LslKeys, None)
