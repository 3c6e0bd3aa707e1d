"""A study from the first key to the deposit: played in terminals, bundled, validated, read back."""

from __future__ import annotations

import csv
import importlib.util
import io
import subprocess
import sys

import frictionless
import pytest

from tests.e2e import played_study, recount
from tests.e2e.lab import Lab
from tests.export.test_bids import validated
from tests.fakes.terminal import ROOT

pytestmark = [pytest.mark.real_clock, pytest.mark.timeout(600)]


def woz(lab: Lab, *words: str) -> None:
    ran = lab.woz(*words)
    said = ran.communicate()
    assert ran.returncode == 0, said


def test_a_study_is_played_deposited_and_read_back(lab: Lab) -> None:
    people = {each.code: each for each in played_study.play(lab, ["P01"])}
    recordings, osf = str(lab.recordings), lab.folder / "osf"
    woz(lab, "bundle", recordings, "--out", str(osf))
    woz(lab, "export", recordings, "--to", "csv", "--out", str(lab.folder / "csv"))
    assert frictionless.Package(str(osf / "datapackage.json")).validate().valid
    validated(osf / "documentation" / "bids")

    # Counted once more from the logs as JSON: all tables and pictures have the same.
    figures = osf / "results" / "figures"
    assert [*recount.differences(lab.recordings, lab.folder / "csv", figures)] == []

    # What was answered in the terminals is in the deposit, but for people's words.
    [table] = osf.glob("data/*description-answers_data.csv")
    with table.open(encoding="utf-8", newline="") as file:
        rows = {(row["participant"], row["condition"]): row for row in csv.DictReader(file)}
    compared = 0
    for who in people.values():
        for (questionnaire, condition, item), answer in who.answers.items():
            column = f"{questionnaire}.{item}".replace(".", "_").replace("-", "_")
            if "value" in answer:
                assert rows[who.code, condition][column] == str(answer["value"]), column
                compared += 1
    assert compared > 40
    said = b"".join(path.read_bytes() for path in osf.rglob("*.*") if path.is_file())
    for words in played_study.WORDS:
        assert words.encode() not in said

    if importlib.util.find_spec("pandas") is not None:
        page = (ROOT / "docs" / "how-to" / "bundle.md").read_text(encoding="utf-8")
        script = page.split("```python\n")[1].split("```")[0]
        ran = subprocess.run(
            [sys.executable, "-c", script, str(osf)], capture_output=True, text=True, check=True
        )
        for condition, score, count, mean, _ in csv.reader(io.StringIO(ran.stdout)):
            if score == "tlx_workload":
                with (figures / "tlx.workload.csv").open(newline="") as file:
                    of = {row["condition"]: row for row in csv.DictReader(file)}[condition]
                values = [float(value) for value in of["values"].split()]
                assert count == of["n"]
                assert float(mean) == pytest.approx(sum(values) / len(values), abs=1e-3)
