"""The driver on a pseudo-terminal: what is asked for, shown and lit."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest
from woz_drivers.midi import MidiPanel, doctor
from woz_drivers.midi.panel_maps import ControlMapping, PanelMap
from woz_drivers.midi.settings import MidiSettings
from woz_drivers.panels.control_requests import RequestQueue

from tests.drivers.midi.panel_rig import PanelContext, connected_panel
from tests.drivers.published_messages import until
from woz_tui.drivers.contract import Ask, Health, Probe, RejectedError, Scope
from woz_tui.testing import PlainJob


@pytest.mark.toolkit("G7")
async def test_the_first_touch_of_a_slider_at_its_end_asks_for_nothing(tmp_path: Path) -> None:
    async with connected_panel(tmp_path) as rig:
        rig.panel.turn(16, 127)
        await rig.wait_until_shown(knob_1=127)
        assert rig.context.asks == []
        assert rig.context.control_messages()[-1].waiting == ["knob-1"]
        assert rig.context.control_messages()[-1].targets == {"knob-1": 64}
        [(level, text, remedy)] = rig.context.notices
        assert (level, remedy) == (
            "info",
            "turn it past the mark; from there on the robot follows",
        )
        assert "knob-1 does not move pitch" in text
        rig.panel.turn(16, 100, 63, 20)
        await rig.wait_for_requests(2)
        assert rig.context.turned_to("pitch") == [round(63 / 128, 4), round(20 / 128, 4)]
        await until(lambda: rig.context.control_messages()[-1].waiting == [])
        assert len(rig.context.notices) == 1


async def test_a_pedal_that_sends_programs_stops_the_robot_every_time(tmp_path: Path) -> None:
    pedal = PanelMap(controls={"pedal": ControlMapping(program=4, kind="button", stop="all")})
    async with connected_panel(tmp_path, map=pedal) as rig:
        for times in (1, 2, 3):
            rig.panel.send(bytes((0xC0, 4)))
            await rig.wait_for_requests(times)
        assert {ask.what for ask in rig.context.asks} == {"stop"}


@pytest.mark.toolkit("G7")
async def test_a_value_changed_by_a_key_must_be_picked_up_again(tmp_path: Path) -> None:
    async with connected_panel(tmp_path) as rig:
        rig.panel.turn(16, 64, 80)
        await rig.wait_for_requests(2)
        rig.context.state_is(controls={"pitch": 0.1})
        await until(lambda: rig.context.control_messages()[-1].waiting == ["knob-1"])
        rig.panel.turn(16, 81, 82)
        await rig.wait_until_shown(knob_1=82)
        assert len(rig.context.asks) == 2
        rig.panel.turn(16, 5)
        await rig.wait_for_requests(3)


async def test_take_over_lets_the_robot_jump_to_the_hand(tmp_path: Path) -> None:
    async with connected_panel(tmp_path) as rig:
        rig.panel.turn(16, 127)
        rig.panel.turn(18, 0)
        await rig.wait_until_shown(knob_1=127, knob_3=0)
        sent = await rig.driver.perform(PlainJob("take-over"))
        assert sent == {"controls": "knob-1, knob-3"}
        assert (rig.context.turned_to("pitch"), rig.context.turned_to("smoothing")) == (
            [1.0],
            [0.0],
        )
        with pytest.raises(RejectedError):
            await rig.driver.perform(PlainJob("nod"))


@pytest.mark.toolkit("K3")
async def test_one_ask_at_a_time_and_the_last_value_is_not_lost(tmp_path: Path) -> None:
    async with connected_panel(tmp_path, take_over="jump") as rig:
        rig.context.slow = True
        for number in (16, 17, 18, 19):
            rig.panel.turn(number, *range(100))
        await rig.wait_until_shown(knob_1=99, knob_2=99, knob_3=99, knob_4=99)
        assert len(rig.context.asks) == 4
        while rig.context.open:
            rig.context.answer()
        last = round(0.5 + 35 / 126, 4)
        for control in ("pitch", "tempo", "smoothing", "compression"):
            assert rig.context.turned_to(control)[-1] == last
            assert rig.context.turned_to(control) == sorted(rig.context.turned_to(control), key=str)


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
    async with connected_panel(tmp_path) as rig:
        rig.context.refuses = "the demo is playing"
        rig.panel.turn(16, 64, 80)
        await until(
            lambda: (
                bool(rig.context.control_messages())
                and rig.context.control_messages()[-1].waiting == ["knob-1"]
            )
        )
        rig.context.refuses = ""
        before = len(rig.context.asks)
        rig.panel.turn(16, 90)
        await rig.wait_until_shown(knob_1=90)
        assert len(rig.context.asks) == before


@pytest.mark.toolkit("K1")
async def test_unplugged_in_mid_use_and_put_back(tmp_path: Path) -> None:
    async with connected_panel(tmp_path) as rig:
        # Cut off in the middle of a press that would have it nod.
        rig.panel.send(bytes((0xB0, 16, 64, 34)))
        await rig.wait_for_requests(1)
        rig.panel.unplug()
        await until(lambda: rig.context.healths[-1][0] is Health.LOST)
        assert (
            "plug it in again" in rig.context.healths[-1][2]
            or "plug the panel in" in (rig.context.healths[-1][2])
        )
        assert len(rig.context.asks) == 1, "the robot holds its pose"
        rig.panel.plug()
        await rig.wait_connected()
        rig.panel.send(bytes((127,)))  # the rest of it means nothing now
        rig.panel.turn(16, 127)
        await rig.wait_until_shown(knob_1=127)
        assert len(rig.context.asks) == 1, "after a replug the value must be picked up again"
        rig.panel.turn(16, 64, 65)
        await rig.wait_for_requests(3)


@pytest.mark.toolkit("K1")
@pytest.mark.parametrize(
    ("sent", "kind"),
    [(b"\xe0\x00\x08\xe0\x00\x10", "pitch bends"), (b"\x90\x5e\x7f\x90\x5e\x00", "notes")],
)
async def test_doctor_and_session_name_a_panel_in_a_mode_for_music_programs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, sent: bytes, kind: str
) -> None:
    async with connected_panel(tmp_path) as rig:
        rig.panel.send(sent)
        await until(lambda: rig.context.healths[-1][0] is Health.FAULTED)
        _, detail, remedy = rig.context.healths[-1]
        assert f"it sends {kind}, as a nanokontrol2 does in a mode for a music program" in detail
        assert "SET MARKER and CYCLE" in remedy
        rig.panel.send(sent)
        rig.panel.turn(16, 127)  # knobs send the same numbers in these modes
        await rig.wait_until_shown(knob_1=127)
        assert [state for state, *_ in rig.context.healths].count(Health.FAULTED) == 1
        rig.panel.unplug()
        await until(lambda: rig.context.healths[-1][0] is Health.LOST)
        rig.panel.plug()
        await until(lambda: rig.context.healths[-1][0] is Health.CONNECTED)

    monkeypatch.setattr(doctor, "_LISTEN_S", 0.0)
    recording = tmp_path / "recording"
    recording.write_bytes(sent)
    settings = MidiSettings(device=str(recording))
    *_, finding = await MidiPanel.examine(Probe("panel", settings, tmp_path))
    assert (finding.level, finding.remedy) == ("error", remedy)
    assert finding.text.removeprefix(str(recording)) == detail.removeprefix(str(rig.panel.port))


async def test_a_map_may_read_a_panel_in_such_a_mode(tmp_path: Path) -> None:
    play = ControlMapping(note=0x5E, kind="button", stop="all")
    panel = PanelMap(layout="nanokontrol2", controls={"play": play})
    async with connected_panel(tmp_path, map=panel) as rig:
        rig.panel.send(b"\x90\x5e\x7f\x90\x5e\x00")
        await rig.wait_for_requests(1)
        assert Health.FAULTED not in [state for state, *_ in rig.context.healths]


async def test_the_doctor_names_the_controls_that_moved(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(doctor, "_LISTEN_S", 0.0)
    (tmp_path / "recording").write_bytes(b"\xb0\x10\x40\x29\x7f\x29\x00")
    settings = MidiSettings(device="./recording")
    *_, finding = await MidiPanel.examine(Probe("panel", settings, tmp_path))
    assert (finding.level, finding.text.endswith("sent knob-1, play")) == ("ok", True)


async def test_unknown_messages_and_free_controls_do_nothing(tmp_path: Path) -> None:
    async with connected_panel(tmp_path, map="thesis") as rig:
        rig.panel.send(bytes.fromhex("f0 42 40 10 7f f7 c0 05 e0 00 40 90 3c 7f fe f8 f2 10 7f"))
        for number in (*range(20, 23), 32, 33, 37, 48, 49, 53, 64, 65, 63, 127):
            rig.panel.turn(number, 127, 0)
        rig.panel.press(60)
        rig.panel.turn(16, 64)
        await rig.wait_for_requests(1)
        assert rig.context.requests_seen() == [
            ("verb", "control", {"control": "pitch", "value": 0.5})
        ]


@pytest.mark.toolkit("K2")
async def test_the_console_gets_a_picture_and_its_values(tmp_path: Path) -> None:
    drawn = MidiPanel.offer(MidiSettings(map="thesis")).outline
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
    async with connected_panel(tmp_path) as rig:
        rig.panel.turn(0, 1, 2, 3, 90)
        rig.panel.turn(32, 127)
        await rig.wait_until_shown(slider_1=90, button_1=127)
        rig.panel.turn(32, 0)
        await rig.wait_until_shown(button_1=0)


@pytest.mark.toolkit("K2")
async def test_the_lights_of_buttons_follow_the_robot(tmp_path: Path) -> None:
    async with connected_panel(tmp_path) as rig:
        rig.context.state_is(emotion="happy", mode="demo", move="nod")
        await until(lambda: rig.panel.lamps() == {39, 36, 34})
        assert rig.panel.hear().startswith(bytes.fromhex("f0 42 40 00 01 13 00 00 00 01 f7"))
        await until(
            lambda: rig.context.control_messages()[-1].lit == ["button-3", "button-5", "button-8"]
        )
        rig.context.state_is(emotion="sad", mode="normal", move="")
        await until(lambda: rig.panel.lamps() == {70})
        await rig.driver.stop(Scope.ALL)
        await until(lambda: rig.panel.lamps() == {70, 42})
        await rig.driver.resume()
        await until(lambda: rig.panel.lamps() == {70})
        rig.panel.unplug()
        await until(lambda: rig.context.healths[-1][0] is Health.LOST)
        rig.panel.plug()
        await until(lambda: rig.panel.lamps() == {70})
        await rig.driver.close()
        assert rig.panel.lamps() == set()
        assert rig.panel.hear().endswith(bytes.fromhex("f0 42 40 00 01 13 00 00 00 00 f7"))


async def test_a_panel_that_takes_no_bytes_blocks_nobody(tmp_path: Path) -> None:
    async with connected_panel(tmp_path) as rig:
        for turn in range(3000):  # nobody reads at the other end: its buffer runs full
            rig.context.state_is(emotion=("happy", "sad")[turn % 2])
            await rig.driver.resume()  # looks at once; by the clock it would take minutes
        rig.panel.turn(16, 64)
        await rig.wait_for_requests(1)
        await until(lambda: rig.panel.lamps() == {70})


async def test_a_panel_that_took_no_bytes_is_found_again_after_a_replug(tmp_path: Path) -> None:
    async with connected_panel(tmp_path) as rig:
        for turn in range(3000):
            rig.context.state_is(emotion=("happy", "sad")[turn % 2])
            await rig.driver.resume()
        for _ in range(2):
            rig.panel.unplug()
            await until(lambda: rig.context.healths[-1][0] is Health.LOST)
            rig.panel.plug()
            await rig.wait_connected()
            await until(lambda: rig.panel.lamps() == {70})
        rig.panel.turn(16, 64)
        await rig.wait_for_requests(1)


@pytest.mark.toolkit("K1")
async def test_a_button_that_was_held_when_the_cable_was_pulled_is_let_go(tmp_path: Path) -> None:
    panel = PanelMap(controls={"held": ControlMapping(note=61, mode="demo", press="momentary")})
    async with connected_panel(tmp_path, map=panel) as rig:
        rig.panel.send(bytes.fromhex("90 3d 64"))
        await rig.wait_for_requests(1)
        rig.panel.unplug()
        await rig.wait_for_requests(2)
        assert [ask.args for ask in rig.context.asks] == [{"mode": "demo"}, {"mode": "normal"}]
        rig.panel.plug()
        await rig.wait_connected()
        rig.panel.send(bytes.fromhex("90 3d 64"))
        await rig.wait_for_requests(3)


@pytest.mark.parametrize("kind", ["fifo", "file"])
async def test_bytes_from_a_fifo_and_from_a_recording(tmp_path: Path, kind: str) -> None:
    path = tmp_path / "bytes"
    if kind == "fifo":
        os.mkfifo(path)
    else:
        path.write_bytes(b"")
    context = PanelContext(tmp_path)
    driver = MidiPanel("panel", MidiSettings(device="./bytes"), context)
    await driver.open()
    await until(lambda: context.connected)
    with path.open("ab", buffering=0) as file:
        file.write(bytes.fromhex("b0 10 40 22 7f"))
        await until(lambda: len(context.asks) == 2)
    if kind == "fifo":
        await until(lambda: context.healths[-1][0] is Health.LOST)
    await driver.close()


@pytest.mark.parametrize("path", ["/dev/null", "."])
async def test_what_is_no_device_is_told(tmp_path: Path, path: str) -> None:
    context = PanelContext(tmp_path)
    driver = MidiPanel("panel", MidiSettings(device=f"./{path}" if path == "." else path), context)
    await driver.open()
    await until(lambda: context.healths[-1][0] is Health.LOST)
    assert "is no MIDI device" in context.healths[-1][1]
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
    async with connected_panel(tmp_path, map=panel) as rig:
        rig.panel.send(bytes.fromhex("90 3c 01 3c 00 3d 64 3d 00"))
        await rig.wait_for_requests(3)
        assert rig.context.requests_seen() == [
            ("verb", "play", {"move": "nod"}),
            ("verb", "mode", {"mode": "demo"}),
            ("verb", "mode", {"mode": "normal"}),
        ]
        assert rig.context.asks[0].when_busy == "replace"
        rig.context.asks.clear()
        rig.panel.press(80)
        await rig.wait_for_requests(1)
        rig.context.state_is(emotion="happy")
        rig.panel.press(80)
        rig.panel.press(81)
        rig.panel.press(81)
        await rig.wait_for_requests(4)
        assert [ask.args for ask in rig.context.asks] == [
            {"emotion": "happy"},
            {"emotion": "neutral"},
            {"on": True},
            {"on": False},
        ]
        rig.context.asks.clear()
        rig.panel.send(bytes.fromhex("e0 7f 7f"))
        rig.panel.turn(82, 0, 127)
        await rig.wait_for_requests(3)
        assert rig.context.requests_seen() == [
            ("verb", "volume", {"level": 1.0}),
            ("verb", "control", {"control": "zoom", "value": 0.5}),
            ("verb", "control", {"control": "zoom", "value": 0.0}),
        ]
        assert rig.context.asks[0].on == "voice"


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
    async with connected_panel(tmp_path, map=panel) as rig:
        rig.panel.press(83)
        rig.panel.press(84)
        await until(lambda: rig.context.lit_buttons == ["power", "faces"])
        rig.panel.press(83)
        rig.panel.press(84)
        await until(lambda: rig.context.lit_buttons == [])
        rig.context.slow = True
        rig.panel.press(85)
        await until(lambda: rig.context.lit_buttons == ["dance"])
        rig.context.answer()
        await until(lambda: rig.context.lit_buttons == [])
        rig.panel.press(85)
        await rig.wait_for_requests(6)
        assert [ask.args for ask in rig.context.asks] == [
            {"on": True},
            {"mode": "tracking"},
            {"on": False},
            {"mode": "normal"},
            {"move": "bow"},
            {"move": "bow"},
        ]


async def test_a_press_that_was_refused_switches_nothing_on(tmp_path: Path) -> None:
    async with connected_panel(tmp_path, map=PanelMap(controls={"power": TORQUE})) as rig:
        rig.context.refuses = "stop pressed"
        rig.panel.press(83)
        await rig.wait_for_requests(1)
        rig.context.refuses = ""
        rig.panel.press(83)
        await until(lambda: rig.context.lit_buttons == ["power"])
        rig.context.refuses = "stop pressed"
        rig.panel.press(83)
        await rig.wait_for_requests(3)
        rig.context.refuses = ""
        rig.panel.press(83)
        await until(lambda: rig.context.lit_buttons == [])
        assert [ask.args["on"] for ask in rig.context.asks] == [True, True, False, False]
