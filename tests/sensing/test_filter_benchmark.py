"""The benchmark of the filters: what it prints and draws."""

from __future__ import annotations

import json
from pathlib import Path
from xml.etree import ElementTree

import pytest

from benchmarks.engagement_filters import main


def bench(capsys: pytest.CaptureFixture[str], *options: str) -> tuple[int, str, str]:
    code = main(["--runs", "2", *options])
    said = capsys.readouterr()
    return code, said.out, said.err


def test_the_tables_fit_on_eighty_columns(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    monkeypatch.setenv("NO_COLOR", "1")
    code, out, _ = bench(capsys, "--seed", "3")
    assert code == 0
    assert max(map(len, out.splitlines())) <= 80
    assert "…" not in out
    assert "\x1b" not in out
    for title in ("Table 1", "Stable for 30 s", "Delay until", "circumstances", "goals"):
        assert title in out
    assert bench(capsys, "--seed", "3")[1] == out


def test_figures_for_programs(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = bench(capsys, "--json", "--rate", "5", "--samples", "6")
    found = json.loads(out)
    assert code == 0
    assert (found["runs"], found["rate"], found["seed"]) == (2, 5.0, 2022)
    keys = [each["filter"] for each in found["filters"]]
    assert keys[0] == "none"
    assert {"published", "median", "joint", "experiment"} <= set(keys)
    assert {goal["what"] for goal in found["goals"]} >= {"staying", "nobody", "turning away"}


def test_bursts_of_errors_as_a_table_and_for_programs(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    monkeypatch.setenv("NO_COLOR", "1")
    code, out, _ = bench(capsys, "--bursts", "5", "--runs", "1")
    assert code == 0
    assert max(map(len, out.splitlines())) <= 80
    assert "5 % of the time" in out
    code, out, _ = bench(capsys, "--bursts", "5", "--runs", "1", "--json")
    found = json.loads(out)
    assert (code, found["wrong"]) == (0, 0.05)
    assert {line["seconds"] for line in found["bursts"]} >= {0.0, 0.5, 2.0}
    assert {line["filter"] for line in found["bursts"]} == {"none", "published", "joint"}


def test_the_plot_is_a_picture(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = tmp_path / "delay.svg"
    assert bench(capsys, "--plot", str(file))[0] == 0
    svg = ElementTree.fromstring(file.read_text("utf-8"))
    words = [text.text for text in svg.iter("{http://www.w3.org/2000/svg}text")]
    assert {"Arriving", "Leaving", "Turning away", "joint filter"} <= set(words)
    box = [float(number) for number in svg.attrib["viewBox"].split()]
    for circle in svg.iter("{http://www.w3.org/2000/svg}circle"):
        assert 0 <= float(circle.attrib["cx"]) <= box[2]
        assert 0 <= float(circle.attrib["cy"]) <= box[3]


def test_a_plot_that_cannot_be_written_is_told_at_once(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    code, out, err = bench(capsys, "--plot", str(tmp_path / "nowhere" / "delay.svg"))
    assert (code, out) == (1, "")
    assert "nowhere" in err


def test_a_plot_of_bursts_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(["--bursts", "5", "--plot", "x.svg"])
    assert stopped.value.code == 2
    assert "--bursts" in capsys.readouterr().err


@pytest.mark.parametrize("runs", ["0", "-1", "x", "1000001"])
def test_a_number_of_runs_that_is_none(capsys: pytest.CaptureFixture[str], runs: str) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(["--runs", runs])
    assert stopped.value.code == 2
    assert "whole number" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--social-distance", "0.5"], "1 to 2.1 m, not 0.5 m"),
        (["--social-distance", "3"], "1 to 2.1 m, not 3 m"),
        (["--signs", "presence,gaze"], "--signs presence,gaze,distance"),
        (["--samples", "30"], "30 places is not full after 6 s at 3 Hz"),
        (["--rate", "2"], "15 places is not full after 6 s at 2 Hz"),
    ],
)
def test_what_the_scenes_cannot_measure_is_refused(
    capsys: pytest.CaptureFixture[str], words: list[str], told: str
) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(["--runs", "1", *words])
    assert stopped.value.code == 2
    said = capsys.readouterr()
    assert (said.out, told in said.err) == ("", True)
