"""The driver on a pseudo-terminal: what is asked for, shown and lit."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest
from woz_drivers.control_requests import RequestQueue
from woz_drivers.midi import MidiPanel
from woz_drivers.midi.panel_maps import ControlMapping, PanelMap
from woz_drivers.midi.settings import MidiSettings

from tests.drivers.heard import until
from tests.drivers.midi.stand import Desk, stand
from woz_tui.drivers.contract import Ask, Health, RejectedError, Scope
from woz_tui.testing import PlainJob


@pytest.mark.toolkit("G7")
async def test_the_first_touch_of_a_slider_at_its_end_asks_for_nothing(tmp_path: Path) -> None:
    async with stand(tmp_path) as it:
        it.panel.turn(16, 127)
        await it.seen(knob_1=127)
        assert it.desk.asks == []
        assert it.desk.moved()[-1].waiting == ["knob-1"]
        assert it.desk.moved()[-1].targets == {"knob-1": 64}
        [(level, text, remedy)] = it.desk.notices
        assert (level, remedy) == (
            "info",
            "turn it past the mark; from there on the robot follows",
        )
        assert "knob-1 does not move pitch" in text
        it.panel.turn(16, 100, 63, 20)
        await it.asked(2)
        assert it.desk.turned("pitch") == [round(63 / 128, 4), round(20 / 128, 4)]
        await until(lambda: it.desk.moved()[-1].waiting == [])
        assert len(it.desk.notices) == 1


async def test_a_pedal_that_sends_programs_stops_the_robot_every_time(tmp_path: Path) -> None:
    pedal = PanelMap(controls={"pedal": ControlMapping(program=4, kind="button", stop="all")})
    async with stand(tmp_path, map=pedal) as it:
        for times in (1, 2, 3):
            it.panel.send(bytes((0xC0, 4)))
            await it.asked(times)
        assert {ask.what for ask in it.desk.asks} == {"stop"}


@pytest.mark.toolkit("G7")
async def test_a_value_changed_by_a_key_must_be_picked_up_again(tmp_path: Path) -> None:
    async with stand(tmp_path) as it:
        it.panel.turn(16, 64, 80)
        await it.asked(2)
        it.desk.state_is(controls={"pitch": 0.1})
        await until(lambda: it.desk.moved()[-1].waiting == ["knob-1"])
        it.panel.turn(16, 81, 82)
        await it.seen(knob_1=82)
        assert len(it.desk.asks) == 2
        it.panel.turn(16, 5)
        await it.asked(3)


async def test_take_over_lets_the_robot_jump_to_the_hand(tmp_path: Path) -> None:
    async with stand(tmp_path) as it:
        it.panel.turn(16, 127)
        it.panel.turn(18, 0)
        await it.seen(knob_1=127, knob_3=0)
        sent = await it.driver.perform(PlainJob("take-over"))
        assert sent == {"controls": "knob-1, knob-3"}
        assert (it.desk.turned("pitch"), it.desk.turned("smoothing")) == ([1.0], [0.0])
        with pytest.raises(RejectedError):
            await it.driver.perform(PlainJob("nod"))


@pytest.mark.toolkit("K3")
async def test_one_ask_at_a_time_and_the_last_value_is_not_lost(tmp_path: Path) -> None:
    async with stand(tmp_path, take_over="jump") as it:
        it.desk.slow = True
        for number in (16, 17, 18, 19):
            it.panel.turn(number, *range(100))
        await it.seen(knob_1=99, knob_2=99, knob_3=99, knob_4=99)
        assert len(it.desk.asks) == 4
        while it.desk.open:
            it.desk.answer()
        last = round(0.5 + 35 / 126, 4)
        for control in ("pitch", "tempo", "smoothing", "compression"):
            assert it.desk.turned(control)[-1] == last
            assert it.desk.turned(control) == sorted(it.desk.turned(control), key=str)


def test_order_is_kept_and_an_answer_counts_once() -> None:
    asked: list[tuple[Ask, Callable[[bool, str], None]]] = []
    line = RequestQueue(lambda ask, done: asked.append((ask, done)), 1)
    answers: list[bool] = []
    line.on_answer = lambda ask, carried: answers.append(carried)
    for name in ("first", "overtaken", "last"):
        line.send(Ask("mark", name))
    asked[0][1](True, "")
    asked[0][1](True, "")
    assert [ask.name for ask, _ in asked] == ["first", "last"]
    assert [line.under_way] == [1]
    asked[1][1](False, "no")
    assert (line.under_way, answers) == (0, [False])


async def test_refused_it_waits_for_the_hand_to_come_by_again(tmp_path: Path) -> None:
    async with stand(tmp_path) as it:
        it.desk.refuses = "the demo is playing"
        it.panel.turn(16, 64, 80)
        await until(lambda: bool(it.desk.moved()) and it.desk.moved()[-1].waiting == ["knob-1"])
        it.desk.refuses = ""
        before = len(it.desk.asks)
        it.panel.turn(16, 90)
        await it.seen(knob_1=90)
        assert len(it.desk.asks) == before


@pytest.mark.toolkit("K1")
async def test_unplugged_in_mid_use_and_put_back(tmp_path: Path) -> None:
    async with stand(tmp_path) as it:
        # Cut off in the middle of a press that would have it nod.
        it.panel.send(bytes((0xB0, 16, 64, 34)))
        await it.asked(1)
        it.panel.unplug()
        await until(lambda: it.desk.healths[-1][0] is Health.LOST)
        assert (
            "plug it in again" in it.desk.healths[-1][2]
            or "plug the panel in" in (it.desk.healths[-1][2])
        )
        assert len(it.desk.asks) == 1, "the robot holds its pose"
        it.panel.plug()
        await it.connected()
        it.panel.send(bytes((127,)))  # the rest of it means nothing now
        it.panel.turn(16, 127)
        await it.seen(knob_1=127)
        assert len(it.desk.asks) == 1, "after a replug the value must be picked up again"
        it.panel.turn(16, 64, 65)
        await it.asked(3)


@pytest.mark.toolkit("K1")
async def test_unknown_messages_and_free_controls_do_nothing(tmp_path: Path) -> None:
    async with stand(tmp_path, map="thesis") as it:
        it.panel.send(bytes.fromhex("f0 42 40 10 7f f7 c0 05 e0 00 40 90 3c 7f fe f8 f2 10 7f"))
        for number in (*range(20, 23), 32, 33, 37, 48, 49, 53, 64, 65, 63, 127):
            it.panel.turn(number, 127, 0)
        it.panel.press(60)
        it.panel.turn(16, 64)
        await it.asked(1)
        assert it.desk.said() == [("verb", "control", {"control": "pitch", "value": 0.5})]


@pytest.mark.toolkit("K2")
async def test_the_console_gets_a_picture_and_its_values(tmp_path: Path) -> None:
    drawn = MidiPanel.outline(MidiSettings(map="thesis"))
    assert drawn["kind"] == "panel"
    controls = drawn["controls"]
    assert isinstance(controls, list)
    places = {(it["column"], it["row"]) for it in controls if isinstance(it, dict)}
    assert len(places) == len(controls) == 51
    assert {
        "name": "slider-3",
        "kind": "slider",
        "column": 6,
        "row": 5,
        "label": "zoom",
        "takes_over": True,
    } in controls
    async with stand(tmp_path) as it:
        it.panel.turn(0, 1, 2, 3, 90)
        it.panel.turn(32, 127)
        await it.seen(slider_1=90, button_1=127)
        it.panel.turn(32, 0)
        await it.seen(button_1=0)


@pytest.mark.toolkit("K2")
async def test_the_lights_of_buttons_follow_the_robot(tmp_path: Path) -> None:
    async with stand(tmp_path) as it:
        it.desk.state_is(emotion="happy", mode="demo", move="nod")
        await until(lambda: it.panel.lamps() == {39, 36, 34})
        assert it.panel.hear().startswith(bytes.fromhex("f0 42 40 00 01 13 00 00 00 01 f7"))
        await until(lambda: it.desk.moved()[-1].lit == ["button-3", "button-5", "button-8"])
        it.desk.state_is(emotion="sad", mode="normal", move="")
        await until(lambda: it.panel.lamps() == {70})
        await it.driver.stop(Scope.ALL)
        await until(lambda: it.panel.lamps() == {70, 42})
        await it.driver.resume()
        await until(lambda: it.panel.lamps() == {70})
        it.panel.unplug()
        await until(lambda: it.desk.healths[-1][0] is Health.LOST)
        it.panel.plug()
        await until(lambda: it.panel.lamps() == {70})
        await it.driver.close()
        assert it.panel.lamps() == set()
        assert it.panel.hear().endswith(bytes.fromhex("f0 42 40 00 01 13 00 00 00 00 f7"))


async def test_a_panel_that_takes_no_bytes_blocks_nobody(tmp_path: Path) -> None:
    async with stand(tmp_path) as it:
        for turn in range(3000):  # nobody reads at the other end: its buffer runs full
            it.desk.state_is(emotion=("happy", "sad")[turn % 2])
            await it.driver.resume()  # looks at once; by the clock it would take minutes
        it.panel.turn(16, 64)
        await it.asked(1)
        await until(lambda: it.panel.lamps() == {70})


async def test_a_panel_that_took_no_bytes_is_found_again_after_a_replug(tmp_path: Path) -> None:
    async with stand(tmp_path) as it:
        for turn in range(3000):
            it.desk.state_is(emotion=("happy", "sad")[turn % 2])
            await it.driver.resume()
        for _ in range(2):
            it.panel.unplug()
            await until(lambda: it.desk.healths[-1][0] is Health.LOST)
            it.panel.plug()
            await it.connected()
            await until(lambda: it.panel.lamps() == {70})
        it.panel.turn(16, 64)
        await it.asked(1)


@pytest.mark.toolkit("K1")
async def test_a_button_that_was_held_when_the_cable_was_pulled_is_let_go(tmp_path: Path) -> None:
    panel = PanelMap(controls={"held": ControlMapping(note=61, mode="demo", press="momentary")})
    async with stand(tmp_path, map=panel) as it:
        it.panel.send(bytes.fromhex("90 3d 64"))
        await it.asked(1)
        it.panel.unplug()
        await it.asked(2)
        assert [ask.args for ask in it.desk.asks] == [{"mode": "demo"}, {"mode": "normal"}]
        it.panel.plug()
        await it.connected()
        it.panel.send(bytes.fromhex("90 3d 64"))
        await it.asked(3)


@pytest.mark.parametrize("kind", ["fifo", "file"])
async def test_bytes_from_a_fifo_and_from_a_recording(tmp_path: Path, kind: str) -> None:
    path = tmp_path / "bytes"
    if kind == "fifo":
        os.mkfifo(path)
    else:
        path.write_bytes(b"")
    desk = Desk(tmp_path)
    driver = MidiPanel("panel", MidiSettings(device="./bytes"), desk)
    await driver.open()
    await until(lambda: desk.connected)
    with path.open("ab", buffering=0) as file:
        file.write(bytes.fromhex("b0 10 40 22 7f"))
        await until(lambda: len(desk.asks) == 2)
    if kind == "fifo":
        await until(lambda: desk.healths[-1][0] is Health.LOST)
    await driver.close()


@pytest.mark.parametrize("path", ["/dev/null", "."])
async def test_what_is_no_device_is_told(tmp_path: Path, path: str) -> None:
    desk = Desk(tmp_path)
    driver = MidiPanel("panel", MidiSettings(device=f"./{path}" if path == "." else path), desk)
    await driver.open()
    await until(lambda: desk.healths[-1][0] is Health.LOST)
    assert "is no MIDI device" in desk.healths[-1][1]
    await driver.close()


async def test_presses_of_pads_momentary_and_toggling_buttons(tmp_path: Path) -> None:
    panel = PanelMap(
        controls={
            "pad": ControlMapping(note=60, play="nod"),
            "held": ControlMapping(note=61, mode="demo", press="momentary"),
            "switch": ControlMapping(cc=80, emotion="happy", press="toggle"),
            "breath": ControlMapping(
                cc=81, verb="breathing", args={"on": True}, back={"on": False}, press="toggle"
            ),
            "loud": ControlMapping(
                bend=True, verb="volume", argument="level", range=(0.2, 1.0), on="voice"
            ),
            "half": ControlMapping(
                cc=82, control="zoom", range=(0.0, 0.5), reversed=True, kind="slider"
            ),
        }
    )
    async with stand(tmp_path, map=panel) as it:
        it.panel.send(bytes.fromhex("90 3c 01 3c 00 3d 64 3d 00"))
        await it.asked(3)
        assert it.desk.said() == [
            ("verb", "play", {"move": "nod"}),
            ("verb", "mode", {"mode": "demo"}),
            ("verb", "mode", {"mode": "normal"}),
        ]
        assert it.desk.asks[0].when_busy == "replace"
        it.desk.asks.clear()
        it.panel.press(80)
        await it.asked(1)
        it.desk.state_is(emotion="happy")
        it.panel.press(80)
        it.panel.press(81)
        it.panel.press(81)
        await it.asked(4)
        assert [ask.args for ask in it.desk.asks] == [
            {"emotion": "happy"},
            {"emotion": "neutral"},
            {"on": True},
            {"on": False},
        ]
        it.desk.asks.clear()
        it.panel.send(bytes.fromhex("e0 7f 7f"))
        it.panel.turn(82, 0, 127)
        await it.asked(3)
        assert it.desk.said() == [
            ("verb", "volume", {"level": 1.0}),
            ("verb", "control", {"control": "zoom", "value": 0.5}),
            ("verb", "control", {"control": "zoom", "value": 0.0}),
        ]
        assert it.desk.asks[0].on == "voice"


TORQUE = ControlMapping(
    cc=83, verb="torque", args={"on": True}, back={"on": False}, press="toggle", on="servos"
)


async def test_a_toggling_button_goes_back_where_nobody_tells_what_is_on(tmp_path: Path) -> None:
    panel = PanelMap(
        controls={
            "power": TORQUE,
            "faces": ControlMapping(cc=84, mode="tracking", press="toggle", on="robot"),
            "dance": ControlMapping(cc=85, play="bow", press="toggle", on="robot"),
        }
    )
    async with stand(tmp_path, map=panel) as it:
        it.panel.press(83)
        it.panel.press(84)
        await until(lambda: it.desk.lit == ["power", "faces"])
        it.panel.press(83)
        it.panel.press(84)
        await until(lambda: it.desk.lit == [])
        it.desk.slow = True
        it.panel.press(85)
        await until(lambda: it.desk.lit == ["dance"])
        it.desk.answer()
        await until(lambda: it.desk.lit == [])
        it.panel.press(85)
        await it.asked(6)
        assert [ask.args for ask in it.desk.asks] == [
            {"on": True},
            {"mode": "tracking"},
            {"on": False},
            {"mode": "normal"},
            {"move": "bow"},
            {"move": "bow"},
        ]


async def test_a_press_that_was_refused_switches_nothing_on(tmp_path: Path) -> None:
    async with stand(tmp_path, map=PanelMap(controls={"power": TORQUE})) as it:
        it.desk.refuses = "stop pressed"
        it.panel.press(83)
        await it.asked(1)
        it.desk.refuses = ""
        it.panel.press(83)
        await until(lambda: it.desk.lit == ["power"])
        it.desk.refuses = "stop pressed"
        it.panel.press(83)
        await it.asked(3)
        it.desk.refuses = ""
        it.panel.press(83)
        await until(lambda: it.desk.lit == [])
        assert [ask.args["on"] for ask in it.desk.asks] == [True, True, False, False]
