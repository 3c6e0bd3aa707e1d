"""Which tests `make quick` chooses, and that it ends in time."""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import Literal

import pytest

from tools import quick_tests

FILES = {
    "woz_tui/bus/lane.py": "",
    "drivers/woz_drivers/midi/ports.py": "",
    "tests/bus/test_lane.py": "",
    "tests/bus/test_others.py": "",
    "tests/bus/stage.py": "",
    "tests/host/test_far_off.py": "from woz_tui.bus.lane import Lane\n",
    "tests/host/test_staged.py": "from tests.bus.stage import Stage\n",
    "tests/drivers/midi/test_panel.py": "",
    "tests/drivers/test_midi_rate.py": "",
    "tests/drivers/test_other.py": "",
    "tests/test_docs.py": "",
}


@pytest.fixture
def root(tmp_path: Path) -> Path:
    for name, text in FILES.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    return tmp_path


@pytest.mark.parametrize(
    ("path", "near", "far"),
    [
        (
            "woz_tui/bus/lane.py",
            {"tests/bus/test_lane.py", "tests/host/test_far_off.py"},
            {"tests/bus/test_lane.py", "tests/bus/test_others.py"},
        ),
        (
            "drivers/woz_drivers/midi/ports.py",
            set[str](),
            {"tests/drivers/midi/test_panel.py", "tests/drivers/test_midi_rate.py"},
        ),
        ("tests/bus/stage.py", {"tests/host/test_staged.py"}, set[str]()),
        ("tests/bus/test_others.py", {"tests/bus/test_others.py"}, set[str]()),
        ("docs/how-to/body.md", {"tests/test_docs.py"}, set[str]()),
        ("Makefile", set[str](), set[str]()),
    ],
)
def test_tests_belong_to_what_they_name_and_to_its_room(
    root: Path, path: str, near: set[str], far: set[str]
) -> None:
    found = quick_tests.belonging([path], root)
    assert (set(found[0]), set(found[1])) == (near, far)


def test_changed_is_what_differs_from_main_committed_or_not(root: Path) -> None:
    def git(*words: str) -> None:
        who = ("-c", "user.name=A", "-c", "user.email=a@example.org")
        subprocess.run(["git", *who, *words], cwd=root, check=True, capture_output=True)

    git("init", "-q", "-b", "main")
    git("add", "-A")
    git("commit", "-q", "-m", "all")
    assert quick_tests.changed(root) == []
    git("checkout", "-q", "-b", "branch")
    (root / "tests/test_docs.py").write_text("# committed\n")
    git("commit", "-q", "-a", "-m", "one")
    (root / "woz_tui/bus/lane.py").write_text("# not committed\n")
    (root / "new.py").write_text("")
    (root / "tests/bus/stage.py").unlink()
    assert quick_tests.changed(root) == ["new.py", "tests/test_docs.py", "woz_tui/bus/lane.py"]


@pytest.mark.parametrize(("outcome", "code"), [("passed", 0), ("failed", 1)])
def test_it_ends_in_time_and_fails_if_a_test_did(
    outcome: Literal["passed", "failed"], code: int
) -> None:
    limit = quick_tests.TimeLimit(-1.0)
    report = pytest.TestReport("tests/a.py::test", ("", 0, ""), {}, outcome, None, "call")
    with pytest.raises(pytest.exit.Exception) as raised:
        limit.pytest_runtest_logreport(report)
    assert raised.value.returncode == code
    assert limit.begun == {"tests/a.py"}
