"""The text that a tree is written as: what other programs and people read in it."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from tests.config.woz4u.reading import converted_text, read_experiment
from woz_tui.config.file_position import FilePosition
from woz_tui.config.file_text import SourceFile
from woz_tui.config.problems import ProblemReport
from woz_tui.config.woz4u import made_nodes
from woz_tui.config.woz4u.yaml_writer import yaml_text
from woz_tui.config.yaml_nodes import ListNode, MappingNode, Node, parse_yaml

HERE = FilePosition("x", 1, 1)
TEXTS = [
    *("Yes", "no", "on", "y", "null", "~", "true", "12:30", "007", "1e3", "0x1F", "1_000", ".5"),
    *("-", "- a", "a: b", "x # y", "'", '"', "it's \"so\"", "\\vct=50\\", 'a\\b "c"', "\\\n"),
    *('\\"\n\t', "", " a ", "a\u00a0b", "a\u2028b", "\x85", "日本 🤖 é", "[a]", "{a: b}"),
    *("*a", "&a", "!a", "%a", "@a", "`a", "|", ">", "? a", "=", "<<", "#a", "2001-01-01"),
    *("a" * 2000, "a,b", "a:", "a,", "+1"),
]  # fmt: skip


@pytest.mark.parametrize("text", TEXTS)
def test_text_is_read_as_text_by_every_reader_of_yaml(text: str) -> None:
    table = made_nodes.table(
        [
            ("alone", HERE, made_nodes.node(text, HERE)),
            (
                "many",
                HERE,
                ListNode(HERE, [made_nodes.node(text, HERE), made_nodes.node("b", HERE)]),
            ),
            ("deep", HERE, nested(text)),
        ],
        HERE,
    )
    out = yaml_text(table, {})
    inner = {"c": {"d": {"e": {"f": text}}}}
    assert yaml.safe_load(out) == {"alone": text, "many": [text, "b"], "deep": inner}
    report = ProblemReport()
    again = parse_yaml(SourceFile("x", Path("x"), b"", out), report)
    assert report.errors == []
    assert isinstance(again, MappingNode)
    assert getattr(again.entries["alone"], "text", None) == text


def nested(text: str) -> Node:
    """The text in mappings deep enough to stand on one line."""
    node: Node = made_nodes.node(text, HERE)
    for name in "fedc":
        node = made_nodes.table([(name, HERE, node)], HERE)
    return node


def test_numbers_and_flags_are_numbers_and_flags() -> None:
    table = made_nodes.table(
        [
            ("whole", HERE, made_nodes.node(20.0, HERE)),
            ("part", HERE, made_nodes.node(0.15, HERE)),
            ("small", HERE, made_nodes.node(0.0000004, HERE)),
            ("on", HERE, made_nodes.node(True, HERE)),
        ],
        HERE,
    )
    assert yaml_text(table, {}) == 'whole: 20\npart: 0.15\nsmall: 4e-07\n"on": true\n'


def test_the_layout_of_a_file(tmp_path: Path) -> None:
    text = "gestures: [{title: Wave, gesture: a/Hey_1, tooltip: waves, key_comb: [escape]}]\n"
    path = tmp_path / "config.yaml"
    read_experiment(tmp_path, text, start="pepper_ips: [10.0.0.7]\nvolume: 0.5\n")
    assert converted_text(path).startswith(
        """title: "WoZ4U: config.yaml"

# Addresses to choose from, and what is set on connect. Other settings stay unchanged.
robot:
  name: pepper
  drivers:
    pepper:
      type: pepper
      robots: ["10.0.0.7"]
      voice: {volume: 0.5}

# Step of one arrow key: degrees; drive in metres. Alt: the base, shift: the hip.
steps:
  hip: 11.46

# covers: verbs that cannot be sent by hand while the panel is locked.
panels:
  - title: Gestures
    covers: [play]
    actions:
      - {key: w, label: Wave, help: waves, play: a/Hey_1}  # 'escape' means stop

  - title: Movement
"""
    )
