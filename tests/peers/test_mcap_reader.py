"""An hour as MCAP, read by the JavaScript reader that viewers use."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Iterator
from pathlib import Path

from tests.export.export_runs import export_logs
from tests.export.logs import STEM, Timed, start, visit, write
from tests.peers.places import place
from woz_tui.protocol import messages as m

#: Seconds of the session; readings a second.
LENGTH_S, RATE = 3600, 20


def hour() -> Iterator[Timed]:
    """A visit, and a distance and a joint all the time."""
    yield 0, start()
    yield from visit()[1:]
    for number in range(20 * RATE, LENGTH_S * RATE):
        sensor, unit = ("joint.pan", "°") if number % 2 else ("distance", "m")
        yield number / RATE, m.reading(sensor, number % 90 / 10, unit=unit)


def test_nothing_is_lost_and_every_message_is_json(tmp_path: Path) -> None:
    folder = place("mcap-reader")
    log = write(tmp_path / "recordings", hour())
    export_logs(log, "mcap", tmp_path / "out", samples=True)
    made = tmp_path / "out" / f"{STEM}.mcap"
    read = subprocess.run(
        ["node", str(Path(__file__).with_name("mcap_reader.mjs")), str(folder), str(made)],
        capture_output=True,
        text=True,
        timeout=200,
        check=False,
    )
    assert read.returncode == 0, read.stderr
    counted = json.loads(read.stdout)
    readings = (LENGTH_S - 20) * RATE
    lines = len(log.read_bytes().splitlines())
    samples = len(log.with_name(f"{STEM}.samples.jsonl").read_bytes().splitlines())
    joints, words = readings // 2, counted["messages"] - lines - samples - readings // 2
    assert samples == readings + 3
    assert 0 < words < lines
    assert counted["messages"] == lines + samples + joints + words
    assert counted["attachments"] == [[f"{STEM}.jsonl", log.stat().st_size]]
    assert counted["metadata"]["woz"]["session"] == "S01"
