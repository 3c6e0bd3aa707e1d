"""What a tag sets off: it fits the version, and no action can be exchanged for another."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from tools import ROOT
from tools.release_notes import ReleaseError, notes
from woz_tui import __version__

CHANGES = """# Changes

## 0.2.0 - 2027-01-31

- One thing ([page](page.md), [site](https://example.org)).

## 0.1.0 - 2026-11-29

- Another thing.
"""
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))


def test_the_notes_are_the_newest_changes_without_links_into_the_repository() -> None:
    told = "- One thing (page, [site](https://example.org))."
    assert notes("v0.2.0", "0.2.0", CHANGES) == told


@pytest.mark.parametrize(
    ("tag", "version", "why"),
    [
        ("v0.2.1", "0.2.0", "the tag v0.2.1 is not v0.2.0"),
        ("v0.1.0", "0.1.0", "CHANGELOG.md begins with '0.2.0 - 2027-01-31'"),
        ("v0.2", "0.2", "give it 0.2 and the day"),
    ],
)
def test_what_does_not_fit_together_is_no_release(tag: str, version: str, why: str) -> None:
    with pytest.raises(ReleaseError, match=re.escape(why)):
        notes(tag, version, CHANGES)


def test_this_version_could_be_tagged_if_it_is_one() -> None:
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    if "dev" not in __version__:
        assert "### " in notes(f"v{__version__}", __version__, changes)


def test_a_tag_of_another_version_ends_the_workflow_before_anything_is_built(
    tmp_path: Path,
) -> None:
    """The step as GitHub runs it: `bash -e`, which does not see what fails in front of a pipe."""
    steps = yaml.safe_load((ROOT / ".github/workflows/release.yml").read_text())["jobs"]["build"]
    [command] = [step["run"] for step in steps["steps"] if "release_notes" in step.get("run", "")]
    done = subprocess.run(
        ["bash", "-e", "-c", command.replace(".venv/bin/python", sys.executable)],
        cwd=ROOT,
        env=os.environ | {"GITHUB_REF_NAME": "v9.9.9", "RUNNER_TEMP": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert "the tag v9.9.9 is not" in done.stderr
    assert done.returncode != 0


@pytest.mark.parametrize("path", WORKFLOWS, ids=[path.name for path in WORKFLOWS])
def test_actions_are_named_by_their_commit_and_say_which_version_it_is(path: Path) -> None:
    """A tag of somebody else's repository can be moved."""
    used = re.findall(r"uses: (.*)$", path.read_text(), flags=re.MULTILINE)
    assert used
    assert [each for each in used if not re.search(r"@[0-9a-f]{40}  # v\d+\.\d+\.\d+$", each)] == []


@pytest.mark.parametrize("path", WORKFLOWS, ids=[path.name for path in WORKFLOWS])
def test_scripts_that_workflows_run_are_there(path: Path) -> None:
    text = path.read_text()
    named = re.findall(r"(?<![\w/])\.ci/\w+", text)
    assert [each for each in named if not (ROOT / each).exists()] == []
