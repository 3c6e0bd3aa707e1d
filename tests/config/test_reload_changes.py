"""What changed between two readings, in words."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.config.reading import HEAD, ROBOT, panel, read_experiment
from woz_tui.config.reload_changes import compare

BASE = panel("{key: a, label: A, say: Hi}", "{key: b, label: B, say: Ho}") + "language: en\n"


@dataclass(frozen=True)
class Edit:
    """A change of the text and what it is called."""

    old: str
    new: str
    said: list[str]


@pytest.mark.parametrize(
    "edit",
    [
        Edit("title: T", "title: U", ["title is 'U', it was 'T'"]),
        Edit("key: a", "key: x", ["action 'A': key x, was a"]),
        Edit("key: a, ", "", ["action 'A': key none, was a"]),
        Edit("say: Hi", "say: Hello", ["action 'A': says: Hi -> Hello"]),
        Edit("say: Hi", "say: Hi, when_busy: refuse", ["action 'A': when busy 'refuse'"]),
        Edit("say: Hi", "say: Hi, locked: on", ["action 'A': locked"]),
        Edit("say: Hi", "say: Hi, help: me", ["action 'A': help changed"]),
        Edit("label: A,", "label: Z, name: A,", ["action 'A': label 'Z'"]),
        Edit("label: B,", "label: B, name: C,", []),
        Edit("title: P", "title: P\n    locked: on", ["panel 'P' is locked"]),
        Edit("language:", "keyboard: de\nlanguage:", ["keyboard changed"]),
        Edit("language:", "conditions: [x, y]\nlanguage:", ["conditions are x, y"]),
        Edit("language:", "variables: {x: y}\nlanguage:", ["variable 'x' is new"]),
        Edit("language:", "session: {deadline: 3}\nlanguage:", ["session changed"]),
        Edit("language:", "participants: {pattern: x}\nlanguage:", ["participant pattern changed"]),
        Edit("language:", "design: {order: fixed}\nlanguage:", ["design is new"]),
        Edit(
            "language:",
            "perception: {hide: [face]}\nlanguage:",
            ["perception: hide face, it was nothing"],
        ),
        Edit("language:", "preflight: [Shut]\nlanguage:", ["preflight 'Shut' is new"]),
        Edit(
            "language:",
            "questionnaires: [{name: q, items: [a]}]\nlanguage:",
            ["questionnaire 'q' is new"],
        ),
        Edit("language:", "# a comment\nlanguage:", []),
        Edit("title: T", "\n\ntitle: T", []),
    ],
)
def test_one_edit(tmp_path: Path, edit: Edit) -> None:
    assert edit.old in BASE
    old = read_experiment(tmp_path, BASE)
    text = BASE.replace(edit.old, edit.new)
    if "name: C" in text:
        edit = Edit("", "", ["action 'B' was removed", "action 'C' is new"])
    new = read_experiment(tmp_path, text)
    assert list(compare(old, new).changes) == edit.said
    assert not compare(old, new).drivers


def test_nothing_changed(tmp_path: Path) -> None:
    assert (
        list(compare(read_experiment(tmp_path, BASE), read_experiment(tmp_path, BASE)).changes)
        == []
    )


def test_repairs_that_only_moved_down_have_not_changed(tmp_path: Path) -> None:
    """Their lines in the file are no difference."""
    repairs = 'repairs:\n  filler: "Hm."\n'
    text = panel("{label: Hello, say: Hello!}")
    old, new = (read_experiment(tmp_path, f"{text}{gap}{repairs}") for gap in ("", "\n\n"))
    assert compare(old, new).changes == ()
    other = read_experiment(tmp_path, f"{text}{repairs}".replace("Hm.", "Well."))
    assert compare(old, other).changes == ("repair 'filler' changed",)


def test_panels_and_actions_come_go_and_change_places(tmp_path: Path) -> None:
    old = read_experiment(tmp_path, BASE + "# \n")
    more = BASE.replace("language:", "  - {title: Q, actions: [{label: D, say: D}]}\nlanguage:")
    new = read_experiment(tmp_path, more)
    assert list(compare(old, new).changes) == ["panel 'Q' is new", "action 'D' is new"]
    assert list(compare(new, old).changes) == ["panel 'Q' was removed", "action 'D' was removed"]
    lines = BASE.splitlines(keepends=True)
    lines[5], lines[6] = lines[6], lines[5]
    swapped = read_experiment(tmp_path, "".join(lines))
    assert list(compare(old, swapped).changes) == ["panel 'P' has its actions in another order"]


def test_drivers_that_changed_forbid_a_reload(tmp_path: Path) -> None:
    action = "{label: A, note: x}"
    old = read_experiment(tmp_path, panel(action, head=ROBOT))
    other = read_experiment(tmp_path, panel(action, head=ROBOT.replace("id: 1", "id: 7")))
    assert compare(old, other).drivers == ("driver 'head' has other settings: joints",)
    simulated = read_experiment(tmp_path, panel(action, head=HEAD))
    difference = compare(old, simulated)
    assert difference.drivers == (
        "driver 'head' was removed",
        "driver 'voice' was removed",
        "driver 'robot' is new",
    )
    assert compare(old, simulated).drivers
    kind = read_experiment(tmp_path, panel(action, head=ROBOT.replace("voice: {type: voice}", "voice: {type: simulated}")))  # fmt: skip # noqa: E501
    assert compare(old, kind).drivers == ("driver 'voice' is of type simulated, it was voice",)


MODEL = """engagement:
  threshold: 0.5
  gaze: {samples: 8}
  timeouts: {lost: 1}
  on_enter: {Wait: {say: Bye}, PersonDetected: [A, {say: Near}], RobotThinks: B}
"""


@pytest.mark.parametrize(
    "edit",
    [
        Edit("threshold: 0.5", "threshold: 0.6", ["engagement: threshold 0.6, it was 0.5"]),
        Edit("  threshold: 0.5\n", "", []),
        Edit("samples: 8", "samples: 9", ["engagement: gaze.samples 9, it was 8"]),
        Edit("{samples: 8}", "{}", ["engagement: gaze.samples not set, it was 8"]),
        Edit("lost: 1", "lost: 1 s", []),
        Edit("{lost: 1}", "{listening: null}", [
            "engagement: timeouts.lost 0, it was 1",
            "engagement: timeouts.listening not set, it was 60",
        ]),
        Edit("gaze:", "signs: [gaze]\n  gaze:", [
            "engagement: signs gaze, it was presence, gaze, distance"
        ]),
        Edit("gaze:", "attention: {look: on}\n  gaze:", [
            "engagement: attention.look on, it was off"
        ]),
        Edit("say: Bye", "say: Good bye", ["effect 'on Wait' does something else"]),
        Edit("Wait: {say: Bye}", "Wait: [{say: Bye}]", []),
        Edit(
            "Wait:", "Handshake:", ["effect 'on Wait' was removed", "effect 'on Handshake' is new"]
        ),
        Edit("[A, {", "[{", ["on PersonDetected plays nothing, it was A"]),
        Edit("Thinks: B", "Thinks: [B, A]", ["on RobotThinks plays B, A, it was B"]),
        Edit("engagement:", "\n\nengagement:", []),
        Edit(MODEL, "", ["engagement is removed"]),
    ],
)  # fmt: skip
def test_one_edit_of_the_engagement_model(tmp_path: Path, edit: Edit) -> None:
    """A running session takes all of them over."""
    assert edit.old in MODEL
    old = read_experiment(tmp_path, BASE + MODEL)
    new = read_experiment(tmp_path, BASE + MODEL.replace(edit.old, edit.new, 1))
    assert list(compare(old, new).changes) == edit.said
    assert not compare(old, new).drivers


def test_an_engagement_model_that_was_not_there(tmp_path: Path) -> None:
    without = read_experiment(tmp_path, BASE)
    assert list(compare(without, read_experiment(tmp_path, BASE + MODEL)).changes) == [
        "engagement is new"
    ]


def test_edits_of_the_study_can_be_taken_over(tmp_path: Path) -> None:
    text = (Path(__file__).parent / "good" / "study.yaml").read_text(encoding="utf-8")
    old = read_experiment(tmp_path, text)
    for before, after in (
        ("trials: 2", "trials: 3"),
        ("cold: Orange", "cold: Apple"),
        ("hide: [distance, face]", "hide: [face]"),
        ("items: [Well]", "items: [Good]"),
        ("cold: Hello.", "cold: Hi."),
    ):
        assert before in text
        text = text.replace(before, after)
    difference = compare(old, read_experiment(tmp_path, text))
    assert not difference.drivers
    assert set(difference.changes) == {
        "variable 'greeting' changed",
        "design: trials 3, it was 2",
        "design: blind warm Lemon, cold Apple, none No, it was warm Lemon, cold Orange, none No",
        "questionnaire 'again' changed",
        "perception: hide face, it was distance, face",
    }
