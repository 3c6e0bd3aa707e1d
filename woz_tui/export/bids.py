"""A BIDS dataset: `beh/*_events.tsv` with sidecars, answers as `*_beh.tsv`, sensors as `*_physio`.

K. J. Gorgolewski et al., "The brain imaging data structure", Scientific Data 3, 2016;
https://bids-specification.readthedocs.io.
"""

from __future__ import annotations

import gzip
import json
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import takewhile
from pathlib import PurePath
from typing import Any

from woz_tui import __version__
from woz_tui.analysis.experiment_names import ExperimentNames
from woz_tui.analysis.feature_figures import FeatureFigures
from woz_tui.analysis.feature_report import BehaviourTable, reports
from woz_tui.analysis.participants import somebody_was_there
from woz_tui.analysis.tables import EVENTS, Cell, Column, TableDefinition
from woz_tui.analysis.text_format import counted
from woz_tui.export.event_model import ExportEvent, ExportSession, letters
from woz_tui.export.exporter import Exporter, ExportOptions, SessionSummary
from woz_tui.export.feature_export import exported_episodes
from woz_tui.export.log_sources import LogSource
from woz_tui.export.output_folder import OutputFolder
from woz_tui.feature import pieces
from woz_tui.log.log_reader import Damage
from woz_tui.protocol.kinds import message_kinds
from woz_tui.system.text_cleaning import cell, one_line

VERSION = "1.11.1"
_ABOUT = """## Files

A dataset as in the Brain Imaging Data Structure (BIDS), without imaging: events of each session in
`sub-*/ses-*/beh/*_events.tsv`, answers to questionnaires in `*_beh.tsv`, values of sensors in
`*_physio.tsv.gz` (only with `--samples`). The `.json` beside each file says what its columns mean.
Sessions without a participant's code are those of `sub-unknown01` and so on, unless nothing was
played in them. What happened before the first code was set is with the first participant, and does
not count (`counted`). Tabs and line ends in
texts are shown as ␉ and ␊. Texts that begin with = + - @ ' have one ' more before them, so that no
spreadsheet takes them for a formula."""


@dataclass(slots=True)
class _Run:
    """What one session has of one participant; the names of its files begin with `stem`."""

    place: str
    stem: str
    started: str
    kinds: list[str] = field(default_factory=list)

    def path(self, number: int = 0) -> str:
        """Where the files are, without their suffixes; 0: no number tells runs apart."""
        return f"{self.place}/beh/{self.stem}" + (f"_run-{number}" if number else "")


class BidsExporter(Exporter):
    """Writes one dataset for all sessions."""

    meaning = "a dataset in the Brain Imaging Data Structure"
    about = _ABOUT
    takes_samples = True
    takes_recording = True

    def __init__(self, folder: OutputFolder, options: ExportOptions) -> None:
        super().__init__(folder, options)
        #: A participant's code, or the name of a log without one -> the label of `sub-`.
        self._labels: dict[str, str] = {}
        self._conditions: dict[str, list[str]] = {}
        self._experiments: dict[str, None] = {}
        self._names = ExperimentNames()
        #: Runs that would be called the same, by what they would be called.
        self._runs: dict[str, list[_Run]] = {}

    def add(self, session: ExportSession, source: LogSource) -> list[str]:
        """Writes one session: for each participant, what happened under their code."""
        if not session.figures.of_study:
            kinds, name = pieces("figures", FeatureFigures), session.figures.apart
            apart = kinds[name].apart if name else None
            what = apart.what if apart is not None else "a re-run"
            return [f"{what}, in which nobody took part: it is left out"]
        codes = session.participants or [""]
        if not session.participants and not somebody_was_there(session.figures):
            return ["no participant's code, and nothing was played: it is left out"]
        setup, others = _of_nobody(session.events, codes)
        paths = [
            self._participant(session, code, setup if code == codes[0] else ()) for code in codes
        ]
        notes = []
        if others:
            whose = [code or "nobody's code" for code in others]
            notes.append(
                f"{counted(others.total(), 'event')} under {', '.join(whose)}, who did not take"
                " part: left out"
            )
        if not session.participants:
            notes.append(f"no participant's code: it is in sub-{self._label(session, '')}")
        if self._options.samples and len(session.participants) > 1:
            notes.append(
                "several participants: values of sensors cannot be assigned and are left out"
            )
        elif self._options.samples:
            notes += write_physio(
                self._folder, paths[0], source, self._common(session), _moved_us(session) / 1e6
            )
        return notes

    def _participant(self, session: ExportSession, code: str, setup: Sequence[ExportEvent]) -> str:
        events = [*setup, *(event for event in session.events if event.participant == code)]
        label = self._label(session, code)
        listed = self._conditions.setdefault(label, [])
        conditions = dict.fromkeys(event.condition for event in events if event.condition)
        listed += [each for each in conditions if each not in listed]
        run = self._run(session, label)
        path = run.path(len(self._runs[run.path()]))
        write_events(self._folder, path, session, events, self._common(session))
        run.kinds.append("events")
        for report in reports():
            if (of := report.behaviour) is None:
                continue
            rows = [row for row in of.table.rows(session.figures) if row.participant == code]
            if rows:
                common = self._common(session)
                write_behaviour(self._folder, path, session, of, rows, common=common)
                run.kinds.append("beh")
        return path

    def _label(self, session: ExportSession, code: str) -> str:
        key = code or f"log {session.name}"
        if key not in self._labels:
            preferred = letters(code, "") if code else ""
            number = 1
            label = preferred or "unknown01"
            taken = {other.casefold() for other in self._labels.values()}  # as on disks
            while label.casefold() in taken:
                number += 1
                label = f"{preferred}x{number}" if preferred else f"unknown{number:02d}"
            self._labels[key] = label
        return self._labels[key]

    def _run(self, session: ExportSession, label: str) -> _Run:
        place = f"sub-{label}/ses-{letters(session.code, 'unknown')}"
        task = self._task(session)
        self._experiments[session.start.experiment if session.start else task] = None
        started = session.started
        when = started.strftime("%Y-%m-%dT%H:%M:%S.%fZ") if started else ""
        run = _Run(place, f"{place.replace('/', '_')}_task-{task}", when)
        self._runs.setdefault(run.path(), []).append(run)
        return run

    def _common(self, session: ExportSession) -> dict[str, Any]:
        """The fields that every sidecar of a session has."""
        start, joined = session.start, session.recording
        software = start.software if start else {}
        common = {
            "TaskName": self._task(session),
            "StimulusPresentation": {
                "OperatingSystem": "Linux",
                "SoftwareName": software.get("name", "woz-tui"),
                "SoftwareVersion": software.get("version", "n/a"),
            },
            "Log": {
                "Name": session.name,
                "Session": session.code,
                "Wizard": session.wizard,
                "Experiment": start.experiment if start else "",
                "ExperimentSHA256": start.experiment_sha256 if start else "",
                "DurationSeconds": session.duration / 1_000_000,
                "MonotonicSecondsAtZero": None
                if session.figures.monotonic_us is None
                else session.figures.monotonic_us / 1e6,
                "Damage": session.damage,
                "Redacted": session.redacted,
            },
        }
        if joined is not None:  # its time is that of the session's onsets
            common["Recording"] = {
                **({} if session.redacted else {"Name": joined.name}),
                "Stream": joined.stream,
                "SessionStartSeconds": joined.offset / 1e6,
            }
        return common

    def _task(self, session: ExportSession) -> str:
        """The label of the task: the first file of the session's experiment."""
        name = next(iter(self._names.files[self._names.of_session(session.figures)]), "")
        return letters(PurePath(name).stem, "experiment")

    def finish(self, summaries: list[SessionSummary]) -> None:
        """Writes the files that describe the dataset as a whole."""
        scans: dict[str, list[list[str]]] = {}
        for runs in self._runs.values():
            for number, run in enumerate(runs, start=1):
                alone = len(runs) == 1
                if alone:  # no number has to tell its files apart
                    written = self._folder.path / run.path(number)
                    for path in written.parent.glob(f"{written.name}_*"):
                        path.rename(path.with_name(path.name.replace(f"_run-{number}_", "_", 1)))
                stem = PurePath(run.path(0 if alone else number)).name
                if run.started:
                    rows = [[f"beh/{stem}_{kind}.tsv", run.started] for kind in run.kinds]
                    scans.setdefault(run.place, []).extend(rows)
        for place, rows in scans.items():
            name = f"{place}/{place.replace('/', '_')}_scans.tsv"
            write_table(self._folder, name, ["filename", "acq_time"], rows)
        if self._conditions:
            rows = [
                [f"sub-{label}", bids_cell(", ".join(found))]
                for label, found in self._conditions.items()
            ]
            write_table(self._folder, "participants.tsv", ["participant_id", "conditions"], rows)
            meaning = "Conditions in which the participant was, in order."
            write_json(self._folder, "participants.json", {"conditions": {"Description": meaning}})
        names = ", ".join(PurePath(name).stem for name in self._experiments if name)
        description = {
            "Name": f"Wizard-of-Oz sessions: {names or 'no experiment'}",
            "BIDSVersion": VERSION,
            "DatasetType": "raw",
            "GeneratedBy": [{"Name": "woz-tui", "Version": __version__}],
        }
        write_json(self._folder, "dataset_description.json", description)
        super().finish(summaries)


def _of_nobody(
    events: Sequence[ExportEvent], codes: Sequence[str]
) -> tuple[list[ExportEvent], Counter[str]]:
    """What happened before the first code was set (drivers connect, sensors begin), which counts
    nowhere and makes no person of its own; and how many others there are under which code.
    """
    before = [*takewhile(lambda event: event.participant not in codes, events)]
    setup = [replace(event, counted=False) for event in before if not event.participant]
    others = Counter(event.participant for event in events if event.participant not in codes)
    others[""] -= len(setup)
    return setup, +others


def _moved_us(session: ExportSession) -> int:
    """What is added to the session's times."""
    return session.recording.offset if session.recording is not None else 0


# -- files -----------------------------------------------------------------------------------------


#: What stands where there is no value.
NONE = "n/a"
_KINDS = {
    "action": "an action of the robot, from the request to its end",
    "command": "one verb sent to one driver, from the request to its end",
    "engagement": "a state of the engagement machine",
    "speech": "a sentence of the visitor",
    "echo": "the robot's own voice, as a microphone heard it",
    "trial": "a trial",
    "phase": "a phase of the experiment",
    "break": "a break between trials",
    "stop": "the emergency stop, from press to release; of driving alone, to its confirmation",
    "difference": "a robot's setting differed from the requested value; the text has both values",
    "conflict": "settings of a robot that conflicted with each other, or with the wizard's actions",
    "marker": "a moment that the wizard marked",
    "code": "what a coder (the source) set while watching a replay: the label is its tier",
    "note": "a sentence that the wizard typed",
    "mistake": "the wizard labelled an action or a single command a mistake",
    **{how.kind: how.meaning for how in exported_episodes().values()},
}
_MOMENTS = {
    str(kind.__struct_config__.tag): (kind.__doc__ or "").strip().partition("\n\n")[0]
    for kind in message_kinds()
}
_UNKNOWN = "a line of the log that this version does not know"
#: BIDS has its own name for this one, and wants the first three columns first.
_RENAMED = {"kind": "trial_type"}
_OF_EVENTS = (
    *("onset", "duration", "kind", "label", "panel", "action", "verb", "driver", "source"),
    *("outcome", "latency", "mistake", "edited", "condition", "trial", "phase", "counted"),
    *("text", "run", "seq"),
)


def write_events(
    folder: OutputFolder,
    stem: str,
    session: ExportSession,
    events: Iterable[ExportEvent],
    common: Mapping[str, Any],
) -> None:
    """Writes `<stem>_events.tsv` and its sidecar."""
    moved = _moved_us(session)
    events = [
        replace(
            each,
            begin=each.begin + moved,
            end=None if each.end is None else each.end + moved,
        )
        for each in events
    ]
    columns = _columns(EVENTS, _OF_EVENTS)
    rows = (
        [bids_cell(_event_cell(session, event, of), text=of.type == "string") for of in columns]
        for event in events
    )
    names = [_RENAMED.get(column.name, column.name) for column in columns]
    write_table(folder, f"{stem}_events.tsv", names, rows)
    meanings: dict[str, Any] = {
        name: _meaning(column) for name, column in zip(names, columns, strict=True)
    }
    del meanings["onset"], meanings["duration"]  # BIDS' own
    meanings["trial_type"] = {
        "Description": "What happened; of moments, the kind of the log's line.",
        "Levels": {
            # Of moments, what the log's format says of the line.
            kind: _KINDS.get(kind) or _MOMENTS.get(kind, _UNKNOWN)
            for kind in dict.fromkeys(each.kind for each in events)
        },
    }
    write_json(folder, f"{stem}_events.json", {**common, **meanings})


def write_behaviour(
    folder: OutputFolder,
    stem: str,
    session: ExportSession,
    behaviour: BehaviourTable,
    found: Sequence[Any],
    *,
    common: Mapping[str, Any],
) -> None:
    """Writes `<stem>_beh.tsv` and its sidecar."""
    columns = _columns(behaviour.table, behaviour.columns)
    moved = _moved_us(session)
    levels = behaviour.levels(session.figures, found)
    shown = [replace(each, t=each.t + moved) for each in found]
    rows = (
        [bids_cell(of.cell(session.figures, each), text=of.type == "string") for of in columns]
        for each in shown
    )
    write_table(folder, f"{stem}_beh.tsv", [column.name for column in columns], rows)
    meanings: dict[str, Any] = {column.name: _meaning(column) for column in columns}
    for name, of in levels.items():
        meanings[name]["Levels"] = of
    write_json(folder, f"{stem}_beh.json", {**common, **meanings})


def write_table(
    folder: OutputFolder, name: str, columns: Iterable[str], rows: Iterable[Iterable[str]]
) -> None:
    """Writes a file of tab-separated cells with a row of names."""
    with folder.text(name) as file:
        file.write("\t".join(columns) + "\n")
        for row in rows:
            file.write("\t".join(row) + "\n")


def write_json(folder: OutputFolder, name: str, content: Mapping[str, Any]) -> None:
    folder.write(name, json.dumps(content, indent=2, ensure_ascii=False) + "\n")


def _columns(table: TableDefinition[Any], names: Iterable[str]) -> list[Column[Any]]:
    of_table = {column.name: column for column in table.columns}
    return [of_table[name] for name in names]


def _event_cell(session: ExportSession, event: ExportEvent, column: Column[Any]) -> Cell:
    if column.name == "duration" and event.end is None:
        return 0  # as BIDS has it of moments
    return column.cell(session.figures, event)


def _meaning(column: Column[Any]) -> dict[str, str]:
    units = {"Units": column.unit} if column.unit else {}
    return {"Description": column.meaning, **units}


def bids_cell(value: Cell, *, text: bool = True) -> str:
    """A value as BIDS has it: no quoting, and nothing begins or ends in a blank."""
    return cell(one_line(value).strip() if isinstance(value, str) else value, text=text) or NONE


# -- values of sensors -----------------------------------------------------------------------------


RATE_HZ = 50
_STEP_US = 1_000_000 // RATE_HZ
#: A damaged time may lie years ahead; nobody pauses a session for so long.
_LONGEST_GAP_US = 3600 * 1_000_000
#: Rows are written for so long, however near to each other such times lie.
_LONGEST_US = 48 * _LONGEST_GAP_US


def write_physio(
    folder: OutputFolder,
    stem: str,
    source: LogSource,
    common: Mapping[str, Any],
    began_s: float = 0.0,
) -> list[str]:
    """`<stem>_physio.tsv.gz` and its sidecar, read in two passes so that memory stays flat.

    Sensors have each their own rate and pauses; BIDS wants one rate and columns without names. So
    every row has each sensor's latest value at that time. The CSV export has the exact samples.

    Returns what could not be written, in sentences.
    """
    units = _units(source)
    if not units:
        return ["the log has no values of sensors"]
    sensors = sorted(units)
    resampled = _Resampled(sensors)
    with (
        folder.binary(f"{stem}_physio.tsv.gz") as file,
        gzip.GzipFile("", "wb", fileobj=file, mtime=0) as table,
    ):
        for row in resampled.rows(source):
            table.write(row)
    described = {
        sensor: {
            "Description": f"{sensor}: the latest value at each time",
            **({"Units": units[sensor]} if units[sensor] else {}),
        }
        for sensor in sensors
    }
    rates = {"SamplingFrequency": RATE_HZ, "StartTime": began_s, "PhysioType": "generic"}
    write_json(folder, f"{stem}_physio.json", {**common, **rates, "Columns": sensors, **described})
    return resampled.notes


def _units(source: LogSource) -> dict[str, str]:
    """Unit of each sensor that has numbers."""
    units: dict[str, str] = {}
    for reading in source.samples(Damage()):
        if reading.value is not None:
            units[reading.sensor] = reading.unit or units.get(reading.sensor, "")
    return units


class _Resampled:
    def __init__(self, sensors: list[str]) -> None:
        self._latest = dict.fromkeys(sensors, NONE)
        self.notes: list[str] = []

    def rows(self, source: LogSource) -> Iterator[bytes]:
        due, last = 0, 0
        for reading in source.samples(Damage()):
            if reading.t - last > _LONGEST_GAP_US:
                self.notes.append("values after a gap of more than an hour were left out")
                break
            if reading.t > _LONGEST_US:
                self.notes.append("values after the second day were left out")
                break
            last = max(last, reading.t)
            while due < reading.t:
                yield self._row()
                due += _STEP_US
            if reading.sensor in self._latest:
                value = reading.value
                self._latest[reading.sensor] = NONE if value is None else repr(value)
        yield self._row()

    def _row(self) -> bytes:
        return ("\t".join(self._latest.values()) + "\n").encode()
