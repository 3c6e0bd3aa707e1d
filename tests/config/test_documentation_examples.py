"""The pieces of experiment files that pages show load; researchers copy exactly these."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from textwrap import dedent, indent
from typing import Any

import pytest
import yaml

from woz_tui.config.experiment_file import TOP_LEVEL
from woz_tui.config.file_position import ExperimentError, Problem
from woz_tui.config.loading import load
from woz_tui.drivers.plugins import installed

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
#: What a file has that a page shows a piece of, unless the piece has it itself.
REST = {
    "title": "title: Guide",
    "robot": "robot: simulated",
    "conditions": "conditions: [warm, sober]",
    "panels": "panels: [{title: Speech, actions: [{key: h, label: Hello, say: Hello}]}]",
}
#: What a piece may name that the rest of its file would have.
ELSEWHERE = re.compile(
    r"there is no (action|panel|condition|questionnaire) '|'(Gestures|photo)' is n"
)
#: Pieces that do not load by themselves, by page and first line.
NOT_ALONE = {
    ("camera.md", "- {key: f, label: Film"): "needs a camera",
    ("engagement-sound.md", "- {key: z, label: Learn the room"): "needs a microphone",
    ("instruments.md", "questionnaires:"): "its files are copied; tests of instruments load them",
    ("ros.md", "sensors:"): "settings of a driver, which tests/drivers/ros loads",
    ("several-computers.md", "title:"): "tests/e2e/test_several_computers.py loads it",
    ("several-wizards.md", "panels:"): "its actions are dots",
    ("speech-programs.md", "- {key: h, label: Hello"): "needs a voice with languages",
    ("pepper.md", "- {key: t, label: Be lively"): "needs a Pepper",
    ("puppeteer.md", "title:"): "tests/test_puppeteer_guide.py loads it",
    ("puppeteer.md", "profiles:"): "tests/test_puppeteer_guide.py loads it",
}


def pieces() -> Iterator[Any]:
    """Whole files, keys of the top level, and actions of a panel."""
    for page in PAGES:
        for block in blocks(page):
            if any(page.name == name and block.startswith(begin) for name, begin in NOT_ALONE):
                continue
            content, piece = yaml.safe_load(block), block
            if isinstance(content, list) and all("key" in each for each in content):
                actions = indent(block, "      ")
                content, piece = {"panels": []}, f"panels:\n  - title: P\n    actions:\n{actions}"
            if not isinstance(content, dict) or not content.keys() <= {*TOP_LEVEL}:
                continue  # of a robot file, or of another one
            rest = [line for key, line in REST.items() if key not in content]
            if page.name == "interview.md":
                rest = [line.replace("warm, sober", "neutral, empathic") for line in rest]
            begin = block.partition("\n")[0]
            yield pytest.param("\n".join([*rest, piece]), id=f"{page.name} {begin}")


def blocks(page: Path) -> list[str]:
    text = page.read_text(encoding="utf-8")
    return [*map(dedent, re.findall(r"^```yaml\n(.*?)^```", text, re.MULTILINE | re.DOTALL))]


PIECES = [*pieces()]


def test_many_pieces_are_found_and_none_is_left_out_in_vain() -> None:
    names = [str(piece.id) for piece in PIECES]
    for name in ("README.md", "interview.md", "conditions.md", "engagement.md"):
        assert [each for each in names if each.startswith(name)]
    for name, begin in NOT_ALONE:
        [page] = [page for page in PAGES if page.name == name]
        assert [block for block in blocks(page) if block.startswith(begin)]


@pytest.mark.parametrize("piece", PIECES)
def test_what_a_page_shows_loads(tmp_path: Path, piece: str) -> None:
    path = tmp_path / "guide.yaml"
    path.write_text(piece, encoding="utf-8")
    problems: list[Problem] = []
    try:
        load(path, installed())
    except ExperimentError as error:
        problems = error.problems
    assert [str(problem) for problem in problems if not ELSEWHERE.search(str(problem))] == []
