"""Values of sensors as BIDS has them: columns without names at one rate, compressed.

Sensors of a session have each their own rate and pauses; BIDS wants one. So every row has each
sensor's latest value at that time. The exact samples are in the CSV export.
"""

from __future__ import annotations

import gzip
from collections.abc import Iterator, Mapping
from typing import Any

from woz_tui.core.messages import Reading
from woz_tui.export.bids_files import NONE, write_json
from woz_tui.export.folder import Folder
from woz_tui.export.sources import Source
from woz_tui.record.log import Damage

RATE_HZ = 50
_STEP_US = 1_000_000 // RATE_HZ
#: A damaged time may lie years ahead; nobody pauses a session for so long.
_LONGEST_GAP_US = 3600 * 1_000_000
#: Rows are written for so long, however near to each other such times lie.
_LONGEST_US = 48 * _LONGEST_GAP_US


def write_physio(folder: Folder, stem: str, source: Source, common: Mapping[str, Any]) -> list[str]:
    """`<stem>_physio.tsv.gz` and its sidecar, read in two passes so that memory stays flat.

    Returns what could not be written, in sentences.
    """
    units = _units(source)
    if not units:
        return ["no sensor's values are in the log"]
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
    rates = {"SamplingFrequency": RATE_HZ, "StartTime": 0, "PhysioType": "generic"}
    write_json(folder, f"{stem}_physio.json", {**common, **rates, "Columns": sensors, **described})
    return resampled.notes


def _units(source: Source) -> dict[str, str]:
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

    def rows(self, source: Source) -> Iterator[bytes]:
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
            self._take(reading)
        yield self._row()

    def _take(self, reading: Reading) -> None:
        if reading.sensor in self._latest:
            self._latest[reading.sensor] = NONE if reading.value is None else repr(reading.value)

    def _row(self) -> bytes:
        return ("\t".join(self._latest.values()) + "\n").encode()
