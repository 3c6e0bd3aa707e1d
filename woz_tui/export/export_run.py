"""Exports sessions: reads each and hands it to the exporter of the format."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import replace
from pathlib import Path

from woz_tui.export.bids import BidsExporter
from woz_tui.export.csv_files import CsvExporter
from woz_tui.export.eaf import EafExporter
from woz_tui.export.event_model import NO_FIGURES
from woz_tui.export.exporter import Exporter, ExportOptions, SessionSummary
from woz_tui.export.jsonl import JsonlExporter
from woz_tui.export.log_sources import (
    ExportError,
    LogSource,
    UniqueNames,
    read_session,
)
from woz_tui.export.other_recording import joined
from woz_tui.export.output_folder import new_folder
from woz_tui.export.textgrid import TextGridExporter
from woz_tui.feature import pieces

#: Name after `--to` -> what writes it; features have more.
FORMATS: Mapping[str, type[Exporter]] = {
    "csv": CsvExporter,
    "eaf": EafExporter,
    "bids": BidsExporter,
    "textgrid": TextGridExporter,
    "jsonl": JsonlExporter,
}


def formats() -> dict[str, type[Exporter]]:
    """All formats by name, those of features too."""
    known = dict(FORMATS)
    for each in pieces("exporters", dict).values():
        known |= each
    return known


def export(
    sources: Sequence[LogSource], to: str, out: Path, options: ExportOptions, *, force: bool = False
) -> Iterator[SessionSummary]:
    """Export the sessions of `sources` into the new folder `out`, one after the other.

    Yields what there is to tell of each. `out` is there when the last was taken.

    Raises:
        ExportError: Nothing can be exported so, or `out` is in the way.
        OSError: A disk is full or gone; `out` is then as it was.
    """
    _refuse(sources, to, options)
    _keep_sources(sources, out)
    names = UniqueNames()
    summaries: list[SessionSummary] = []
    with (
        new_folder(out, force=force) as folder,
        closing(formats()[to](folder, options)) as exporter,
    ):
        for source in sources:
            session = read_session(source, redact=options.redact, private=options.private)
            session.name = names.unique(session.name)
            session.figures = replace(session.figures, stem=session.name)
            notes: list[str] = []
            if options.recording is not None:
                session.recording = joined(options.recording, session, source)
                notes += session.recording.notes
            notes += exporter.add(session, source)
            count = len(session.events)
            summaries.append(SessionSummary(session, notes, session.participants, count))
            # They would fill the memory over hundreds of sessions.
            session.events, session.figures = [], NO_FIGURES
            yield summaries[-1]
        exporter.finish(summaries)


def _keep_sources(sources: Sequence[LogSource], out: Path) -> None:
    """Refuses an output folder that holds logs to be exported: replacing it would delete them."""
    for source in sources:
        for path in source.files.paths:
            if path.resolve().is_relative_to(out.resolve()):
                raise ExportError(f"{path.name} lies in {out} itself", "name another with --out")


def _refuse(sources: Sequence[LogSource], to: str, options: ExportOptions) -> None:
    if options.recording is not None and not formats()[to].takes_recording:
        able = " or ".join(name for name, each in formats().items() if each.takes_recording)
        raise ExportError(f"--with needs --to {able}", "leave it out")
    if options.recording is not None and len(sources) > 1:
        raise ExportError(
            f"--with needs exactly one session; these are {len(sources)}", "export them one by one"
        )
    if options.media is None:
        return
    if to != "eaf":
        raise ExportError("--media needs --to eaf", "leave it out")
    if options.redact:
        raise ExportError(
            "--redact-text leaves sound and pictures out", "leave out --media or --redact-text"
        )
    if len(sources) > 1:
        raise ExportError(
            f"--media needs exactly one session; these are {len(sources)}", "export them one by one"
        )
    if not options.media.is_file():
        raise ExportError(f"{options.media}: there is no such file", "check the name")
