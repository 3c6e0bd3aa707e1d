"""Exports sessions: reads each and hands it to the exporter of the format."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from dataclasses import replace
from pathlib import Path

from woz_tui.export.bids import BidsExporter
from woz_tui.export.csv_files import CsvExporter
from woz_tui.export.eaf import EafExporter
from woz_tui.export.event_model import NO_FIGURES, Session
from woz_tui.export.exporter import Exporter, Options, Told
from woz_tui.export.jsonl import JsonlExporter
from woz_tui.export.log_sources import ExportError, Names, Source, found, read
from woz_tui.export.textgrid import TextGridExporter
from woz_tui.export.whole_folder import Folder, new_folder

FORMATS: dict[str, Callable[[Folder, Options], Exporter]] = {
    "csv": CsvExporter,
    "eaf": EafExporter,
    "bids": BidsExporter,
    "textgrid": TextGridExporter,
    "jsonl": JsonlExporter,
}


def export(
    given: Sequence[Path], to: str, out: Path, options: Options, *, force: bool = False
) -> Iterator[Told]:
    """Export the sessions that `given` names into the new folder `out`, one after the other.

    Yields what there is to tell of each. `out` is there when the last was taken.

    Raises:
        ExportError: Nothing can be exported so, or `out` is in the way.
        OSError: A disk is full or gone; `out` is then as it was.
    """
    sources = found(given)
    _refuse(sources, to, options)
    _keep_sources(sources, out)
    names = Names()
    told: list[Told] = []
    with (
        new_folder(out, force=force) as folder,
        closing(FORMATS[to](folder, options)) as exporter,
    ):
        for source in sources:
            session = read(source, redact=options.redact)
            session.name = names.apart(session.name)
            session.figures = replace(session.figures, stem=session.name)
            told.append(_told(session, exporter.add(session, source)))
            yield told[-1]
        exporter.finish(told)


def _told(session: Session, notes: list[str]) -> Told:
    """Keeps no events: those of hundreds of sessions would fill the memory."""
    told = Told(session, notes, session.participants, len(session.events))
    session.events, session.figures = [], NO_FIGURES
    return told


def _keep_sources(sources: Sequence[Source], out: Path) -> None:
    """Replacing a folder must not delete the logs from which it is made."""
    for source in sources:
        for path in source.files.paths:
            if path.resolve().is_relative_to(out.resolve()):
                raise ExportError(f"{path.name} lies in {out} itself", "name another with --out")


def _refuse(sources: Sequence[Source], to: str, options: Options) -> None:
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
