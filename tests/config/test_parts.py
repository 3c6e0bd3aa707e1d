"""`for` of a panel: parts for several wizards."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.config.reading import HEAD, errors, read
from woz_tui.config.experiment import Experiment
from woz_tui.config.reload_changes import compare


def parted(tmp_path: Path, *of: str) -> Experiment:
    """Panels with these entries `for`; an empty one has none."""
    return read(tmp_path, text(*of))


def text(*of: str) -> str:
    panels = "".join(
        f"  - title: P{n}\n{f'    for: {each}' if each else ''}\n"
        f"    actions: [{{key: {n}, label: L{n}, say: Hi}}]\n"
        for n, each in enumerate(of)
    )
    return f"{HEAD}panels:\n{panels}"


def test_one_part_or_several(tmp_path: Path) -> None:
    made = parted(tmp_path, "voice", "[voice, left arm]", "")
    assert [panel.parts for panel in made.panels] == [("voice",), ("voice", "left arm"), ()]
    assert made.parts == ["voice", "left arm"]
    assert not made.warnings


@pytest.mark.parametrize(("of", "word"), [("''", "empty"), ("[a, a]", "twice"), ("{a: b}", "part")])
def test_what_is_no_part_is_an_error(tmp_path: Path, of: str, word: str) -> None:
    (error,) = errors(tmp_path, text(of))
    assert "panels[0].for" in error
    assert word in error


@pytest.mark.parametrize(
    ("one", "other", "warned"),
    [
        ("voice", "vioce", True),
        ("voice", "Voice", True),
        ("voice", "voicee", True),
        ("robot 1", "robot 2", False),
        ("arm", "arm2", False),
        ("left", "right", False),
    ],
)
def test_a_slip_of_a_finger_is_told(tmp_path: Path, one: str, other: str, warned: bool) -> None:
    warnings = [str(each) for each in parted(tmp_path, one, other).warnings]
    assert bool(warnings) == warned
    assert all(f"'{other}'" in each and "'P0'" in each for each in warnings)


def test_a_reload_tells_of_another_part(tmp_path: Path) -> None:
    difference = compare(parted(tmp_path, "voice", ""), parted(tmp_path, "body", ""))
    assert list(difference.changes) == ["panel 'P0' is for body"]
