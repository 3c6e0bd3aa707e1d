"""All tables as CSV, those of single lines too."""

from __future__ import annotations

from collections.abc import Iterable

import msgspec

from woz_tui.analysis.csv_package import DICTIONARY, GUARDED, TableFiles
from woz_tui.analysis.feature_report import reports
from woz_tui.analysis.spreadsheets import PLAIN, SPREADSHEETS
from woz_tui.analysis.tables import EVENTS, SAMPLES
from woz_tui.export.event_model import ExportSession
from woz_tui.export.exporter import Exporter, ExportOptions, SessionSummary
from woz_tui.export.log_sources import LogSource, nameless
from woz_tui.export.output_folder import OutputFolder
from woz_tui.export.redaction import PLACEHOLDER
from woz_tui.log.log_reader import Damage
from woz_tui.protocol.messages import Reading

_FEATURES = "".join(f"- {line}\n" for each in reports() for line in each.about)
_ABOUT = f"""## Files

- `events.csv`: everything that happened, one row each; the table to begin with
- `trials.csv`, `phases.csv`, `conditions.csv`: trials, phases, and the figures of each condition
- `cues.csv`, `actions.csv`, `latencies.csv`: answers to cues, actions and commands counted
- `engagement.csv`, `episodes.csv`: states of the engagement machine, by trial and as they were
- `settings.csv`: settings of robots, and where they differed from the requested values
- `wizards.csv`: what each of several wizards played
{_FEATURES}- `sessions.csv`: the sessions, and what is wrong with their logs
- `samples.csv`: values of the sensors (only with `--samples`)
- `{DICTIONARY}`: what each column means, its type and unit

The column `log` ties them together. CSV as in RFC 4180: UTF-8, commas, a dot in decimals (with
`--spreadsheet`: what that language has, see `{DICTIONARY}`), CR LF at the end of a row. An empty
cell: there is no such value. {GUARDED}"""


class CsvExporter(Exporter):
    """Writes all sessions into the same tables."""

    meaning = "tidy tables with a data dictionary"
    about = _ABOUT
    takes_samples = True

    def __init__(self, folder: OutputFolder, options: ExportOptions) -> None:
        super().__init__(folder, options)
        samples = [SAMPLES] if options.samples else []
        csv_format = SPREADSHEETS.get(options.spreadsheet, PLAIN)
        self._tables = TableFiles(folder.text, [EVENTS, *samples], csv_format)

    def add(self, session: ExportSession, source: LogSource) -> list[str]:
        """Writes one session."""
        notes = self._tables.add(session.figures)
        self._tables.write(EVENTS, session.figures, session.events)
        if not self._options.samples:
            return notes
        damage = Damage()
        self._tables.write(SAMPLES, session.figures, self._samples(source, damage))
        return [*notes, *(nameless(damage) if self._options.redact else damage).sentences()]

    def _samples(self, source: LogSource, damage: Damage) -> Iterable[Reading]:
        for reading in source.samples(damage):
            private = reading.text and self._options.redact
            yield msgspec.structs.replace(reading, text=PLACEHOLDER) if private else reading

    def finish(self, summaries: list[SessionSummary]) -> None:
        """Writes the data dictionary and the README."""
        self._tables.finish()
        super().finish(summaries)

    def close(self) -> None:
        """Close the files; also after an error."""
        self._tables.close()
