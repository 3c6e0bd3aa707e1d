"""A BIDS dataset: `beh/*_events.tsv` with sidecars, answers as `*_beh.tsv`, sensors as `*_physio`.

K. J. Gorgolewski et al., "The brain imaging data structure", Scientific Data 3, 2016;
https://bids-specification.readthedocs.io.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import PurePath
from typing import Any

from woz_tui import __version__
from woz_tui.export.bids_files import (
    bids_cell,
    write_answers,
    write_events,
    write_json,
    write_table,
)
from woz_tui.export.bids_physio import write_physio
from woz_tui.export.course import Session
from woz_tui.export.folder import README, Folder
from woz_tui.export.options import Options, Told
from woz_tui.export.readme import readme
from woz_tui.export.sources import Source
from woz_tui.export.text import letters

VERSION = "1.11.1"
_ABOUT = """## Files

A dataset as in the Brain Imaging Data Structure (BIDS), without imaging: events of each session in
`sub-*/ses-*/beh/*_events.tsv`, answers to questionnaires in `*_beh.tsv`, values of sensors in
`*_physio.tsv.gz` (only with `--samples`). The `.json` beside each file says what its columns mean.
Sessions without a participant's code are those of `sub-unknown01` and so on. Tabs and line ends in
texts are shown as ␉ and ␊. Texts that begin with = + - @ ' have one ' more before them, so that no
spreadsheet takes them for a formula."""


@dataclass(slots=True)
class _Run:
    """What one session has of one participant; `stem` begins all its files."""

    place: str
    stem: str
    started: str
    kinds: list[str] = field(default_factory=list)

    def path(self, number: int = 0) -> str:
        """Where the files are, without their suffixes; 0: no number tells runs apart."""
        return f"{self.place}/beh/{self.stem}" + (f"_run-{number}" if number else "")


class BidsExporter:
    """One dataset for all sessions."""

    def __init__(self, folder: Folder, options: Options) -> None:
        self._folder = folder
        self._options = options
        #: A participant's code, or the name of a log without one -> the label of `sub-`.
        self._labels: dict[str, str] = {}
        self._conditions: dict[str, list[str]] = {}
        self._experiments: dict[str, None] = {}
        #: Runs that would be called the same, by what they would be called.
        self._runs: dict[str, list[_Run]] = {}

    def add(self, session: Session, source: Source) -> list[str]:
        """One session: of each participant in it, what happened under their code."""
        codes = session.participants
        if not codes or any(not event.participant for event in session.events):
            codes = [*codes, ""]
        paths = [self._participant(session, code) for code in codes]
        notes = []
        if not session.participants:
            notes.append(f"no participant's code: it is in sub-{self._label(session, '')}")
        if self._options.samples and len(session.participants) > 1:
            notes.append("several participants: values of sensors are nobody's and left out")
        elif self._options.samples:
            notes += write_physio(self._folder, paths[0], source, _common(session))
        return notes

    def _participant(self, session: Session, code: str) -> str:
        events = [event for event in session.events if event.participant == code]
        answers = [answer for answer in session.answers if answer.participant == code]
        label = self._label(session, code)
        known = self._conditions.setdefault(label, [])
        conditions = dict.fromkeys(event.condition for event in events if event.condition)
        known += [each for each in conditions if each not in known]
        run = self._run(session, label)
        path = run.path(len(self._runs[run.path()]))
        write_events(self._folder, path, session, events, _common(session))
        run.kinds.append("events")
        if answers:
            write_answers(self._folder, path, session, answers, _common(session))
            run.kinds.append("beh")
        return path

    def _label(self, session: Session, code: str) -> str:
        key = code or f"log {session.name}"
        if key not in self._labels:
            wanted = letters(code, "") if code else ""
            number = 1
            label = wanted or "unknown01"
            while label in self._labels.values():
                number += 1
                label = f"{wanted}x{number}" if wanted else f"unknown{number:02d}"
            self._labels[key] = label
        return self._labels[key]

    def _run(self, session: Session, label: str) -> _Run:
        place = f"sub-{label}/ses-{letters(session.code, 'unknown')}"
        task = _task(session)
        self._experiments[session.start.experiment if session.start else task] = None
        started = session.started
        when = started.strftime("%Y-%m-%dT%H:%M:%S.%fZ") if started else ""
        run = _Run(place, f"{place.replace('/', '_')}_task-{task}", when)
        self._runs.setdefault(run.path(), []).append(run)
        return run

    def finish(self, told: list[Told]) -> None:
        """What describes the dataset as a whole."""
        scans: dict[str, list[list[str]]] = {}
        for runs in self._runs.values():
            for number, run in enumerate(runs, start=1):
                self._named(run, number, alone=len(runs) == 1)
                stem = PurePath(run.path(0 if len(runs) == 1 else number)).name
                if run.started:
                    rows = [[f"beh/{stem}_{kind}.tsv", run.started] for kind in run.kinds]
                    scans.setdefault(run.place, []).extend(rows)
        for place, rows in scans.items():
            name = f"{place}/{place.replace('/', '_')}_scans.tsv"
            write_table(self._folder, name, ["filename", "acq_time"], rows)
        self._participants()
        write_json(self._folder, "dataset_description.json", self._description())
        self._folder.write(README, readme(told, [_ABOUT], redacted=self._options.redact))

    def _named(self, run: _Run, number: int, *, alone: bool) -> None:
        """A run that is the only one needs no number."""
        if not alone:
            return
        written = self._folder.path / run.path(number)
        for path in written.parent.glob(f"{written.name}_*"):
            path.rename(path.with_name(path.name.replace(f"_run-{number}_", "_", 1)))

    def _participants(self) -> None:
        rows = [
            [f"sub-{label}", bids_cell(", ".join(found))]
            for label, found in self._conditions.items()
        ]
        write_table(self._folder, "participants.tsv", ["participant_id", "conditions"], rows)
        meaning = "Conditions in which the participant was, in order."
        write_json(self._folder, "participants.json", {"conditions": {"Description": meaning}})

    def _description(self) -> dict[str, Any]:
        names = ", ".join(PurePath(name).stem for name in self._experiments if name)
        return {
            "Name": f"Wizard-of-Oz sessions: {names or 'no experiment'}",
            "BIDSVersion": VERSION,
            "DatasetType": "raw",
            "GeneratedBy": [{"Name": "woz-tui", "Version": __version__}],
        }

    def close(self) -> None:
        """Nothing is open."""


def _task(session: Session) -> str:
    name = session.start.experiment if session.start else ""
    return letters(PurePath(name).stem, "experiment")


def _common(session: Session) -> dict[str, Any]:
    """What every sidecar of a session says."""
    start = session.start
    software = start.software if start else {}
    return {
        "TaskName": _task(session),
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
            "Damage": session.damage,
            "Redacted": session.redacted,
        },
    }
