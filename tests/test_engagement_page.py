"""The page about engagement: its diagram and its table come from the table in the program."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path
from xml.etree import ElementTree

import pytest

from tools import DOCS
from tools import engagement_diagram as diagram
from woz_tui import cli
from woz_tui.sensing.state_machine import EDGES, State


def test_every_edge_is_told_and_nothing_else() -> None:
    told = {key: len(words) for key, words in diagram.CONDITIONS.items()}
    assert told == Counter(f"{edge.source} {edge.outcome}" for edge in EDGES)


def test_every_state_and_every_edge_is_drawn() -> None:
    svg = ElementTree.fromstring(diagram.svg())
    words = Counter(text.text for text in svg.iter("{http://www.w3.org/2000/svg}text"))
    assert all(words[state] == 1 for state in State)
    for edge in EDGES:
        label = f"{edge.letter}  {edge.outcome}" if edge.letter else edge.outcome
        assert words[label] >= 1
    lines = len(re.findall(r"marker-end", diagram.svg()))
    drawn = {(edge.source, "left" if edge.unnamed else edge.target) for edge in EDGES}
    assert lines == len(drawn), "whatever a visitor who has left leads to is one arrow"


def test_the_pages_lines_of_samples_come_out_as_it_says(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = (DOCS / "how-to" / "engagement-again.md").read_text("utf-8")
    rows = text.partition("<<END\n")[2].partition("END\n")[0]
    told = text.partition("```json\n")[2].partition("```")[0]
    file = tmp_path / "visit.jsonl"
    file.write_text(rows, encoding="utf-8")
    assert cli.main(["engagement", str(file)]) == 0
    assert capsys.readouterr().out == told
    assert len(told.splitlines()) == 6
