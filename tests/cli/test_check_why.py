"""`woz check --why`: what the gate says of a file before anybody has begun."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.cli.test_check import checked
from tests.config.reading import ROBOT, panel

SPEECH = panel(
    "{key: h, label: Hello, say: Hi}", "{key: n, label: Never, say: x, locked: true}", head=ROBOT
)
POSE = "actions: [{key: p, label: Pose, pose: {pan: 10}}]"
LOCKED = f"{SPEECH}  - {{title: Movement, covers: [pose], locked: true, {POSE}}}\n"
PHASES = f"""{SPEECH}  - {{title: Movement, {POSE}}}
phases:
  - {{name: opening, title: Opening, panels: [P], lock_others: true}}
  - {{name: moving, panels: [Movement]}}
profiles:
  child: {{panels: [P]}}
"""
#: The file itself locks what the phase would lock, too.
BOTH = PHASES.replace(f"Movement, {POSE}", f"Movement, locked: true, {POSE}")
PARTS = f"{SPEECH}    for: voice\n  - {{title: Movement, for: body, {POSE}}}\n"


@pytest.fixture(autouse=True)
def _a_wide_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "160")
    monkeypatch.delenv("FORCE_COLOR", raising=False)


@pytest.mark.parametrize(
    ("file", "key", "answers"),
    [
        (LOCKED, "h", ["at the beginning: yes"]),
        (
            LOCKED,
            "Never",
            ["at the beginning: no: 'Never' is locked; the experiment file locks it"],
        ),
        (
            LOCKED,
            "p",
            ["at the beginning: no: the panel 'Movement' is locked; find 'Unlock Movement'"],
        ),
        (
            LOCKED,
            "pose",
            [
                "at the beginning: no: the panel 'Movement' is locked, and with it 'pose';"
                " find 'Unlock Movement'"
            ],
        ),
        (
            BOTH,
            "p",
            [
                f"{when}: no: the panel 'Movement' is locked; find 'Unlock Movement'"
                for when in ("at the beginning", "in the phase moving", "with the profile child")
            ],
        ),
        (
            PHASES,
            "ctrl+n",
            ["at the beginning: yes", "in the phase moving: yes", "with the profile child: yes"],
        ),
        (
            PHASES,
            "p",
            [
                "at the beginning: no: the panel 'Movement' is locked in the phase Opening;"
                " find 'Unlock Movement'",
                "in the phase moving: yes",
                "with the profile child: no: the panel 'Movement' is locked in the phase Opening;"
                " find 'Unlock Movement'",
            ],
        ),
        (
            PHASES,
            "pose",
            [
                "at the beginning: yes",
                "in the phase moving: yes",
                "with the profile child: no: 'pose' is not in the profile child",
            ],
        ),
        (
            PARTS,
            "Hello",
            [
                "at the beginning, as voice: yes",
                "at the beginning, as body: no: the panel 'P' is played by voice (voice)",
            ],
        ),
    ],
)
def test_it_tells_whether_it_may_be_played_and_why_not(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], file: str, key: str, answers: list[str]
) -> None:
    assert checked(tmp_path, file, "--why", key) == 0
    _, *told, last = capsys.readouterr().out.splitlines()
    assert [line.strip() for line in told] == answers
    rest = "age, approval, moment, running, driving, lane, consent, slot"
    assert last == f"only a session knows: {rest}"


def test_programs_get_codes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert checked(tmp_path, LOCKED, "--why", "p", "--format", "json") == 0
    told = json.loads(capsys.readouterr().out)
    [found] = told["found"]
    assert found["what"] == "Pose (p, panel Movement)"
    assert found["answers"] == [
        {
            "when": "at the beginning",
            "ok": False,
            "code": "locked",
            "reason": "the panel 'Movement' is locked",
            "hint": "find 'Unlock Movement'",
        }
    ]
    assert "driving" in told["not_looked_at"]


def test_what_means_nothing_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert checked(tmp_path, LOCKED, "--why", "f9") == 1
    assert "'f9' is no key of an action" in capsys.readouterr().err
