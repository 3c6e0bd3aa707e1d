"""Learning a panel."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from woz_drivers.midi.learning import MapLearning
from woz_drivers.midi.panel_maps import BUILT_IN, ControlMapping, PanelMap
from woz_drivers.midi.resolved_map import mapped_controls, signal_of
from woz_drivers.midi.settings import MidiSettings

from woz_tui.config.annotated_decoder import settings_from_texts

PANEL = PanelMap(
    title="a panel",
    controls={
        "k": ControlMapping(cc=1, control="pitch", range=(0.1, 0.9)),
        "b": ControlMapping(cc=2, play="nod"),
        "s": ControlMapping(cc=3, stop="all"),
    },
)


def knob(number: int, *values: int) -> bytes:
    return b"".join(bytes((0xB0, number, value)) for value in values)


def read_back(lesson: MapLearning, folder: Path) -> PanelMap:
    (folder / "learnt.yaml").write_text(lesson.text(), encoding="utf-8")
    settings: MidiSettings = settings_from_texts(MidiSettings, {"map": "learnt.yaml"}, folder)
    assert settings.problems() == []
    return settings.panel


def test_each_target_gets_the_control_that_was_moved_for_it(tmp_path: Path) -> None:
    lesson = MapLearning(PANEL, "", -1)
    assert lesson.question == "[1/3] move the knob or slider for: pitch"
    assert lesson.add(knob(21, 127, 0)) == "", "a button is no knob"
    assert lesson.add(knob(20, 60, 61, 62)) == "cc-20: pitch"
    assert lesson.question == "[2/3] press the button for: nod"
    assert lesson.add(knob(20, 63, 64, 127)) == "", "the hand is still on the knob"
    assert lesson.add(knob(22, 30, 90, 127)) == "", "a slider on its way is no button"
    assert lesson.add(bytes((0x99, 36, 80))) == "note-36-10: nod"
    assert lesson.add(knob(20, 5, 6, 7, 8, 127)) == ""
    assert lesson.add(bytes((0xC1, 4))) == "program-4-2: STOP"
    assert lesson.over
    assert lesson.count == 3
    panel = read_back(lesson, tmp_path)
    assert [str(signal_of(control)) for control in mapped_controls(MidiSettings(map=panel))] == [
        *("cc 20, channel 1", "note 36, channel 10", "program 4, channel 2"),
    ]
    assert panel.controls["cc-20"].range == (0.1, 0.9)


def test_how_hard_a_pad_is_held_answers_no_question() -> None:
    lesson = MapLearning(PANEL, "", -1)
    for held in (20, 40, 60, 80):
        assert lesson.add(bytes((0xD9, held))) == ""
        assert lesson.add(bytes((0xA9, 36, held))) == ""
    assert lesson.question == "[1/3] move the knob or slider for: pitch"


def test_skip_and_back(tmp_path: Path) -> None:
    lesson = MapLearning(PANEL, "", -1)
    lesson.back()
    lesson.skip()
    assert lesson.add(knob(9, 0, 127)) == "cc-9: nod"
    lesson.back()
    assert lesson.question == "[2/3] press the button for: nod"
    assert lesson.count == 0
    assert lesson.add(knob(10, 127)) == "cc-10: nod"
    lesson.skip()
    assert lesson.over
    assert set(read_back(lesson, tmp_path).controls) == {"cc-10"}


def test_a_control_cannot_be_taken_twice() -> None:
    lesson = MapLearning(PANEL, "", -1)
    lesson.add(knob(20, 1, 2, 3))
    lesson.add(knob(9, 127))
    assert lesson.question.startswith("[3/3]")
    assert lesson.add(knob(20, 0, 127)) == (
        "cc-20 is used for pitch already; use another one, or press b to go back"
    )
    assert lesson.question.startswith("[3/3]")


@pytest.mark.parametrize("name", BUILT_IN)
def test_a_known_panel_keeps_its_names_and_its_lights(name: str, tmp_path: Path) -> None:
    lesson = MapLearning(BUILT_IN[name], "nanoKONTROL2", -1)
    wanted = [control for control in mapped_controls(MidiSettings(map=name)) if not control.free]
    for control in wanted:
        number = signal_of(control).number
        said = lesson.add(knob(number, 127, 0) if control.pressed else knob(number, 1, 2, 3))
        assert said == f"{control.name}: {control.label}"
    panel = read_back(lesson, tmp_path)
    assert panel.layout == "nanokontrol2"
    assert panel.controls == BUILT_IN[name].controls


def test_learning_again_keeps_what_is_skipped(tmp_path: Path) -> None:
    lesson = MapLearning(PANEL, "", -1, keep=True)
    lesson.skip()
    lesson.add(knob(50, 127))
    panel = read_back(lesson, tmp_path)
    assert panel.controls["k"] == PANEL.controls["k"]
    assert panel.controls["s"] == PANEL.controls["s"]
    assert panel.controls["cc-50"].play == "nod"


@given(st.lists(st.one_of(st.binary(max_size=12), st.sampled_from(["skip", "back"])), max_size=30))
def test_whatever_is_done_the_file_can_be_read(acts: list[bytes | str]) -> None:
    lesson = MapLearning(PANEL, "", -1)
    for act in acts:
        if isinstance(act, bytes):
            lesson.add(act)
        elif act == "back":
            lesson.back()
        elif not lesson.over:
            lesson.skip()
    assert lesson.text().startswith("title: a panel\n")
    assert lesson.count <= 3
