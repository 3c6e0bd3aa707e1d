"""`woz export --with`: the events of a session on the time of an EEG recorded beside it."""

from __future__ import annotations

import csv
import json
import sys
from pathlib import Path

import pytest

from tests.export.export_runs import export_logs
from tests.export.logs import start, write
from tests.export.test_bids import validated
from tests.features.lsl.laboratory import (
    needs_library,
    own_network,
    recorded,
    recording,
    running,
    sending,
)
from tests.features.lsl.test_sent_streams import act, end
from tests.features.lsl.test_taken_streams import EYES, found, lab, send, source
from woz_tui.cli import main
from woz_tui.export.log_sources import ExportError
from woz_tui.export.other_recording import OtherRecording
from woz_tui.features.lsl.section import TakenEntry
from woz_tui.protocol import messages as m

#: An amplifier without a head: 50 values a second.
EEG = """
import time, pylsl
outlet = pylsl.StreamOutlet(pylsl.StreamInfo("amp", "EEG", 1, 50, pylsl.cf_double64, "its-source"))
print("there", flush=True)
while True:
    time.sleep(0.02)
    outlet.push_sample([0.0])
"""


async def recorded_study(folder: Path) -> tuple[Path, Path]:
    """A log, and the recording of the session beside an EEG and an eye tracker."""
    env, file = own_network(folder), folder / "lab.xdf"
    async with lab(folder, TakenEntry("eyes")) as rig, sending(rig, env) as program:
        async with (
            running(sys.executable, "-c", EEG, env=env) as amp,
            running(*source(*EYES), env=env) as eyes,
        ):
            assert await amp.begins("there")
            await found(rig)
            async with recording(rig, file, env, "amp", "eyes"):
                await act(rig, 5)
                await send(eyes, "fixation")
                await rig.until(lambda: len(rig.of(m.Marker)) == 6)
                await end(rig, program)
        return rig.recorder.path, file


def onsets(out: Path) -> dict[str, float]:
    """Of the markers, by what they say."""
    (events,) = out.rglob("*_events.tsv")
    with events.open(newline="") as file:
        rows = [*csv.DictReader(file, delimiter="\t", quoting=csv.QUOTE_NONE)]
    return {row["text"]: float(row["onset"]) for row in rows if row["trial_type"] == "marker"}


@pytest.mark.real_clock
@needs_library
async def test_onsets_are_in_the_time_of_the_eeg(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log, file = await recorded_study(tmp_path)
    out = tmp_path / "out"
    assert main(["export", str(log), "--to", "bids", "--out", str(out), "--with", str(file)]) == 0
    said = capsys.readouterr().err
    assert "their times differ from the log by 0.0 µs at the most" in said
    assert "lacks" not in said
    assert "onset 0 is the first value of the stream amp (EEG)" in said
    streams = recorded(file)
    markers = streams["woz-markers"]
    first = streams["amp"].stamps[0]
    marked = [t for t, w in zip(markers.stamps, markers.values, strict=True) if w == "mark"]
    at = onsets(out)
    # What the eye tracker sent has the moment of its own stamp, as near as LSL measures the clock.
    assert at.pop("fixation") == pytest.approx(streams["eyes"].stamps[0] - first, abs=0.001)
    assert sorted(at) == [f"secret {number}" for number in range(5)]
    assert [*at.values()] == pytest.approx([stamp - first for stamp in marked], abs=10e-6)
    (about,) = out.rglob("*_events.json")
    assert json.loads(about.read_text())["Recording"]["Stream"] == "amp"
    validated(out)
    # The log of another session is not in it.
    other = write(tmp_path / "others", [(0, start()), (1, m.Marker(text="x"))])
    with pytest.raises(ExportError, match="has no line of the session S01"):
        export_logs(other, "bids", tmp_path / "x", recording=OtherRecording(file))
    with pytest.raises(ExportError, match="no other stream 'heart' with values"):
        export_logs(log, "bids", tmp_path / "x", recording=OtherRecording(file, "heart"))


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (["--to", "csv", "--with", "x.xdf"], "--with needs --to bids"),
        (["--to", "bids", "--with", "x.xdf"], "there is no such file"),
        (["--to", "bids", "--with", "x.edf"], "is of no known kind"),
        (["--to", "bids", "--stream", "amp"], "--stream needs --with"),
    ],
)
def test_what_cannot_be_joined_is_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], given: list[str], said: str
) -> None:
    log = write(tmp_path / "recordings", [(0, start()), (1, m.Marker(text="x"))])
    assert main(["export", str(log), "--out", str(tmp_path / "out"), *given]) == 1
    assert said in capsys.readouterr().err


def test_a_file_that_is_no_recording_is_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = write(tmp_path / "recordings", [(0, start()), (1, m.Marker(text="x"))])
    file = tmp_path / "lab.xdf"
    for content in (b"", b"not an XDF", b"XDF:"):
        file.write_bytes(content)
        command = ["export", str(log), "--to", "bids", "--out", str(tmp_path / "out")]
        assert main([*command, "--with", str(file)]) == 1
        assert "lab.xdf" in capsys.readouterr().err
