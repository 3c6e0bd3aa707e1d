"""Passes of puppeteering: recorded in layers, trimmed, saved, and the same when they play again."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from tests.motion.move_file_bodies import EYEPI, FIVE
from woz_tui.motion.body_shape import Personality
from woz_tui.motion.engine import Engine
from woz_tui.motion.engine_io import Tick
from woz_tui.motion.keyframes import KeyFrame, KeyframeMove, LayerSamples, MoveLayer
from woz_tui.motion.move_files import MAIN, read_move
from woz_tui.motion.move_writer import WriteError, move_text, save
from woz_tui.motion.puppeteer import (
    FaceTarget,
    Puppeteer,
    RecordedTake,
    active_span,
    trim_layer,
    with_layer,
    with_muted,
    with_share,
    without_layer,
)
from woz_tui.protocol.messages import Json

STILL = replace(EYEPI, personality=Personality(breathing=0, blink_rate=0), crossfade=0.0)
DT = 0.02
NODS = KeyframeMove(
    "act",
    "nods slowly",
    (MoveLayer(MAIN, (KeyFrame(0.5, {"nod": 10}), KeyFrame(1, {"nod": 0}), KeyFrame(2))),),
)
EMPTY = KeyframeMove("act", "", ())
Inputs = list[tuple[float, str, dict[str, Json]]]
HAND: Inputs = [
    (0.2, "joints", {"joints": {"pitch": 10}}),
    (0.4, "joints", {"joints": {"pitch": 20, "middle": 50}}),
    (0.8, "emotion", {"emotion": "happy", "intensity": 0.7}),
    (1.0, "look", {"x": 0.5, "y": -0.5}),
    (1.2, "joints", {"joints": {"pitch": 0}}),
]


def perform_pass(
    move: KeyframeMove, inputs: Inputs, seconds: float, layer: str = "hand", rate: float = 25
) -> tuple[Puppeteer, list[Tick]]:
    puppeteer = Puppeteer(STILL, move, layer, rate)
    puppeteer.tick(0.0)
    puppeteer.begin()
    waiting, ticks = list(inputs), []
    for index in range(1, round(seconds / DT) + 1):
        while waiting and waiting[0][0] <= (index - 1) * DT + 1e-9:
            _, verb, args = waiting.pop(0)
            puppeteer.apply(verb, args)
        ticks.append(puppeteer.tick(index * DT))
    return puppeteer, ticks


def played_ticks(move: KeyframeMove, seconds: float) -> list[Tick]:
    engine = Engine(STILL, {move.name: move})
    engine.tick(0.0)
    engine.apply("play", {"move": move.name})
    return [engine.tick(index * DT) for index in range(1, round(seconds / DT) + 1)]


def angles(ticks: list[Tick], joint: str) -> list[float]:
    return [tick.wanted[joint] for tick in ticks]


@pytest.mark.toolkit("X2")
def test_a_pass_plays_again_as_the_hand_did_it() -> None:
    puppeteer, live = perform_pass(EMPTY, HAND, 1.6)
    again = played_ticks(puppeteer.recorded(trim=False), 1.6)
    for joint in EYEPI.joints:
        # The hand steps between two samples, which are 40 ms apart; a replay glides.
        for index in (5, 15, 30, 55, 75):
            assert angles(again, joint)[index] == pytest.approx(angles(live, joint)[index])
    assert again[75].emotion == "happy"
    assert again[75].intensity == pytest.approx(0.7)


@pytest.mark.toolkit("X2")
def test_a_second_pass_lies_on_the_first_in_sync() -> None:
    puppeteer, live = perform_pass(NODS, HAND, 1.8)
    both = puppeteer.recorded()
    assert [layer.name for layer in both.layers] == [MAIN, "hand"]
    again = played_ticks(both, 1.8)
    assert angles(again, "top")[24] == angles(live, "top")[24] == pytest.approx(28.65 + 10)
    assert angles(again, "pitch")[15] == angles(live, "pitch")[15] == 10
    assert "top" not in (both.layers[1].samples or LayerSamples(1)).joints, (
        "what plays is not the hand"
    )


@pytest.mark.toolkit("X2")
def test_a_layer_is_redone_without_the_others_being_touched() -> None:
    first = perform_pass(NODS, HAND, 1.8)[0].recorded()
    quieter = with_share(first, "hand", 0.5)
    again: Inputs = [(0.4, "joints", {"joints": {"pitch": -30}})]
    puppeteer, live = perform_pass(quieter, again, 1.0)
    assert angles(live, "pitch")[10] == 0, "the layer that is redone does not play"
    redone = puppeteer.recorded()
    assert redone.layers[0] == NODS.layers[0]
    assert redone.layers[1].share == 0.5
    assert redone.layers[1].samples is not None
    assert min(redone.layers[1].samples.joints["pitch"]) == -30


def test_what_the_layers_show_is_not_the_hand_s_but_what_the_hand_shows_is() -> None:
    sad = with_layer(NODS, MoveLayer("face", (KeyFrame(0.5, emotion="sad", intensity=0.9),)))
    layer = perform_pass(sad, [], 1.5)[0].recorded().layers[-1]
    assert layer.frames == () and layer.samples is None
    layer = perform_pass(sad, [(1, "emotion", {"emotion": "angry"})], 1.5)[0].recorded().layers[-1]
    assert [frame.emotion for frame in layer.frames] == [None, "angry"]


def test_an_input_that_ends_the_layers_is_noticed() -> None:
    assert not perform_pass(NODS, HAND, 2.5)[0].interrupted
    pose: Inputs = [(0.4, "pose", {"joints": {"pitch": 30}, "seconds": 0.4})]
    puppeteer, live = perform_pass(NODS, pose, 1.2)
    assert puppeteer.interrupted
    assert angles(live, "pitch")[-1] == pytest.approx(30)


def test_a_pose_without_other_layers_is_recorded_on_its_way() -> None:
    pose: Inputs = [(0.2, "pose", {"joints": {"pitch": 30}, "seconds": 0.4})]
    layer = perform_pass(EMPTY, pose, 1.0)[0].recorded(trim=False).layers[0]
    assert layer.samples is not None
    values = layer.samples.joints["pitch"]
    assert values[10] == pytest.approx(15, abs=1.6)
    assert all(a <= b for a, b in itertools.pairwise(values))


def test_the_personality_s_pace_does_not_count_in_a_take() -> None:
    quick = replace(STILL, personality=replace(STILL.personality, speed=2, amplitude=3))
    puppeteer = Puppeteer(quick, NODS, "hand", 25)
    puppeteer.tick(0)
    puppeteer.begin()
    ticks = [puppeteer.tick(index * DT) for index in range(1, 26)]
    assert max(angles(ticks, "top")) <= 28.65 + 30
    assert ticks[-1].move == "act"


def test_beats_are_recorded_in_beats() -> None:
    beats = replace(NODS, beats=True)
    tempo = STILL.personality.tempo
    layer = perform_pass(beats, HAND, 1.6)[0].recorded(trim=False).layers[1]
    assert layer.samples is not None
    assert layer.samples.rate == pytest.approx(25 / tempo)
    assert layer.samples.length == pytest.approx(1.6 * tempo, abs=0.1)


# -- samples ------------------------------------------------------------------------------------


@given(st.lists(st.floats(0.001, 0.2), min_size=1, max_size=30), st.floats(1, 100))
def test_samples_do_not_depend_on_when_the_ticks_came(steps: list[float], rate: float) -> None:
    take, place = RecordedTake(rate), 0.0
    take.moment(0, {"a": 0.0}, FaceTarget())
    for step in steps:
        place += step
        take.moment(place, {"a": 7 * place}, FaceTarget())
    values = (take.layer("x").samples or LayerSamples(rate, joints={"a": ()})).joints["a"]
    for index, value in enumerate(values):
        assert value == pytest.approx(7 * index / rate, abs=0.006)
    assert take.length <= place + 1e-9 < take.length + 1 / rate + 1e-6


def test_rest_at_both_ends_is_trimmed() -> None:
    values = (0.0,) * 10 + (1.0, 2.0, 3.0) + (3.0,) * 10
    layer = MoveLayer(
        "x", (KeyFrame(0.52, emotion="sad"),), LayerSamples(25, joints={"top": values})
    )
    start, end = active_span(layer)
    assert (start, end) == (8 / 25, 13 / 25)
    cut = trim_layer(layer, start, end)
    assert cut.samples == LayerSamples(25, joints={"top": (0, 0, 1, 2, 3, 3)})
    assert cut.frames == (KeyFrame(0.2, emotion="sad"),)


def test_what_was_shown_before_a_cut_is_shown_from_the_beginning() -> None:
    frames = (KeyFrame(1, emotion="sad"), KeyFrame(3, emotion="happy"), KeyFrame(9))
    cut = trim_layer(MoveLayer("x", frames), 2, 4)
    assert cut.frames == (KeyFrame(0, emotion="sad"), KeyFrame(1, emotion="happy"))


def test_muting_and_leaving_out() -> None:
    move = with_layer(NODS, MoveLayer("b", (KeyFrame(1, {"pan": 5}),)))
    assert with_muted(move, "b").at(1).roles.get("pan") is None
    assert with_muted(with_muted(move, "b"), "b", False) == move
    assert without_layer(move, "b") == NODS


# -- files --------------------------------------------------------------------------------------


@pytest.mark.toolkit("X2", "X3")
def test_a_saved_move_plays_bit_identically(tmp_path: Path) -> None:
    move = perform_pass(NODS, HAND, 1.8)[0].recorded()
    path = tmp_path / "act.yaml"
    save(move, path, EYEPI)
    loaded = read_move(path, EYEPI)
    assert loaded == move
    assert [t.joints for t in played_ticks(loaded, 2.5)] == [
        t.joints for t in played_ticks(move, 2.5)
    ]
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.toolkit("X3")
def test_a_file_by_hand_keeps_its_meaning_when_a_layer_is_added(tmp_path: Path) -> None:
    path = tmp_path / "greet.yaml"
    path.write_text(
        """
name: greet
about: "it's: yes\\u00e9"
stays: on
frames:
  - {seconds: 0.1, nod: 3, joints: {nod: -1.25}}
  - {seconds: 0.2, easing: hold, lid: 0.1}
  - {at: 0.7, emotion: sad, eyes: {x: 0.25}, sound: ./sub/../gong.wav, volume: 0.3}
layers:
  - {name: "yes: no", relative: false, mix: replace, share: 0.333,
     frames: [{at: 1e-1, neck: 4}]}
"""
    )
    move = read_move(path, FIVE)
    more = with_layer(
        move, MoveLayer("new", samples=LayerSamples(12.5, {"pan": (0.1, -1e-5, 1 / 3)}))
    )
    save(more, path, FIVE)
    assert read_move(path, FIVE) == more
    text = path.read_text()
    assert move_text(read_move(path, FIVE), tmp_path) == text, (
        "writing it once more changes nothing"
    )
    assert 'sound: "sub/../gong.wav"' in text


numbers = st.floats(-90, 90)
frame_lists = st.lists(
    st.builds(
        lambda roles, joints, lid: (roles, joints, lid),
        st.dictionaries(st.sampled_from(["pan", "nod"]), numbers),
        st.dictionaries(st.sampled_from(["neck", "nod"]), numbers),
        st.none() | st.floats(0, 1),
    ),
    min_size=1,
    max_size=8,
)


@given(frame_lists, st.lists(st.floats(0.000001, 3), min_size=8, max_size=8), st.text())
def test_any_move_is_read_as_it_was_written(
    tmp_path_factory: pytest.TempPathFactory,
    rows: list[tuple[dict[str, float], dict[str, float], float | None]],
    times: list[float],
    about: str,
) -> None:
    about = "".join(sign for sign in about if sign.isprintable()) or "x"
    frames, at = [], 0.0
    for (roles, joints, lid), seconds in zip(rows, times, strict=False):
        at = round(at + seconds, 6)
        frames.append(KeyFrame(at, roles, joints, lid=lid))
    move = KeyframeMove("any", about, (MoveLayer(MAIN, tuple(frames)),))
    path = tmp_path_factory.mktemp("moves") / "any.yaml"
    save(move, path, FIVE)
    assert read_move(path, FIVE) == move


def refusal_text(path: Path) -> str:
    with pytest.raises(WriteError) as caught:
        save(NODS, path, EYEPI)
    return caught.value.what


def test_no_other_file_is_overwritten(tmp_path: Path) -> None:
    path = tmp_path / "notes.yaml"
    path.write_text("title: my experiment\n")
    assert "is no move file" in refusal_text(path)
    assert path.read_text() == "title: my experiment\n"
    assert list(tmp_path.iterdir()) == [path]


def test_a_folder_that_is_not_there_is_told(tmp_path: Path) -> None:
    assert "cannot be written" in refusal_text(tmp_path / "nowhere" / "a.yaml")


def test_a_move_that_is_too_long_for_a_file_is_told(tmp_path: Path) -> None:
    values = tuple(index / 8 for index in range(-720, 720)) * 200
    move = KeyframeMove(
        "long", "", (MoveLayer("x", samples=LayerSamples(100, joints={"top": values})),)
    )
    with pytest.raises(WriteError, match="more than 1 MiB"):
        save(move, tmp_path / "long.yaml", EYEPI)
    assert list(tmp_path.iterdir()) == []


def test_layers_of_all_kinds_are_mappings_that_yaml_reads_too(tmp_path: Path) -> None:
    move = perform_pass(NODS, HAND, 1.8)[0].recorded()
    read: Mapping[str, object] = yaml.safe_load(move_text(move, tmp_path))
    assert list(read) == ["name", "about", "frames", "layers"]
