"""What `woz hands` says to a session: the lines, their order, and what it leaves out."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import msgspec

from woz_tui.console.hand_client import UNANSWERED, HandClient
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.action_messages import HAND_DEVICES
from woz_tui.protocol.panels import ActionView, PanelView
from woz_tui.protocol.welcome import WelcomeSettings
from woz_tui.system.clock import ManualClock

PAD = {
    "kind": "panel",
    "device": "gamepad",
    "hold": 0.5,
    "controls": [
        {"name": "south", "label": "Hello", "action": "Hello"},
        {"name": "select", "label": "STOP", "stop": "all"},
    ],
}
DECK = {
    "kind": "panel",
    "device": "stream-deck",
    "hold": 0.5,
    "controls": [
        {"name": "key-1", "label": "Hello", "action": "Hello"},
        {"name": "key-2", "label": "w", "key": "w"},
        {"name": "key-3", "label": "STOP", "stop": "all"},
        {"name": "key-4"},
    ],
}
PANELS = [
    PanelView(
        title="P",
        actions=[
            ActionView(name="Hello", label="Hello!", key="h"),
            ActionView(name="Who", label="Who?", key="w", locked=True),
        ],
    )
]


class Pad:
    """A device in somebody's hands."""

    def __init__(self, kind: str = "gamepad", name: str = "a pad") -> None:
        self.kind = kind
        self.name = name
        self.path = f"/dev/input/{name}"
        self.held: dict[str, float] = {}
        self.on_change: Callable[[], None] = lambda: None
        self.on_gone: Callable[[], None] = lambda: None
        self.shown: list[Mapping[str, Any]] = []

    def show(self, faces: Mapping[str, Any]) -> None:
        self.shown.append(dict(faces))

    def hold(self, **values: float) -> None:
        """All that is not at rest now."""
        self.held = {name.replace("_", "-"): value for name, value in values.items()}
        self.on_change()


class Line:
    """A client, the lines it sends, and a session that answers when the test says so."""

    def __init__(self, outlines: dict[str, Any] | None = None, **options: Any) -> None:
        self.clock = ManualClock()
        self.clock.advance(100)
        self.said: list[str] = []
        self.client = HandClient(self.clock, self.said.append, **options)
        self.sent: list[r.Request] = []
        self.client.connect(lambda line: self.sent.append(codec.decode_request(line)))
        [hello] = self.take()
        assert isinstance(hello, r.Hello)
        assert (hello.role, hello.sees) == ("program", "wizard"), "its keys lie before the wizard"
        self.welcome(outlines or {"pad": PAD, "deck": DECK})

    def welcome(self, outlines: dict[str, Any], t: int = 7_000_000) -> None:
        self.hear(
            r.Welcome(
                protocol=1, console="con2", role="program", seq=1, t=t, title="it", log="",
                panels=PANELS, script=[], verbs={}, variables=[], conditions=[], keyboard="us",
                drivers=[], settings=WelcomeSettings(outlines=outlines, stale_after=1.5),
            )
        )  # fmt: skip

    def hear(self, message: msgspec.Struct) -> None:
        self.client.receive(codec.encode(message))

    def take(self) -> list[r.Request]:
        """What was sent since the last time."""
        sent = list(self.sent)
        self.sent.clear()
        return sent

    def controls(self) -> list[dict[str, float]]:
        """The same, as states of controls; each is answered."""
        taken = [each for each in self.take() if isinstance(each, r.AskControls)]
        for each in taken:
            self.hear(r.Reply(ref=each.ref, ok=True))
        return [each.values for each in taken]

    def plugged(self, pad: Pad) -> Pad:
        """Plug it in."""
        self.client.add(pad)
        self.controls()
        return pad


def test_a_device_is_named_to_its_panel_with_what_it_holds_already() -> None:
    line = Line()
    pad = Pad()
    pad.held = {"south": 1.0}
    line.client.add(pad)
    [asked] = line.take()
    assert isinstance(asked, r.AskControls)
    assert (asked.panel, asked.device, asked.values) == ("pad", "a pad", {"south": 1.0})
    assert "south Hello" in line.said[-1]


def test_presses_keep_their_order_and_sticks_only_their_newest_place() -> None:
    line = Line()
    pad = line.plugged(Pad())
    for _ in range(UNANSWERED):
        pad.hold(south=1)
        pad.hold()
    unanswered = line.take()
    assert len(unanswered) == UNANSWERED
    for share in (0.2, 0.5, 0.9):
        pad.hold(left_stick_x=share)
    pad.hold(left_stick_x=0.9, south=1)
    pad.hold(left_stick_x=0.8)
    assert line.take() == []
    for each in unanswered:
        line.hear(r.Reply(ref=each.ref, ok=True))
    states = [state for _ in range(9) for state in line.controls()]
    assert states[-3:] == [
        {"left-stick-x": 0.9}, {"left-stick-x": 0.9, "south": 1}, {"left-stick-x": 0.8},
    ]  # fmt: skip


def test_a_moving_stick_is_sent_so_often_and_ends_where_it_stands() -> None:
    line = Line()
    pad = line.plugged(Pad())
    pad.hold(left_stick_x=0.1)
    sent = line.controls()
    for step in range(2, 101):
        line.clock.advance(0.001)
        pad.hold(left_stick_x=step / 100)
        line.client.tick()
        sent += line.controls()
    line.clock.advance(0.03)
    line.client.tick()
    sent += line.controls()
    assert 4 <= len(sent) <= 7
    assert sent[-1] == {"left-stick-x": 1.0}


def test_what_is_held_is_said_again_and_what_rests_is_silent() -> None:
    line = Line()
    pad = line.plugged(Pad())
    pad.hold(left_stick_x=0.5)
    line.take()
    for _ in range(50):
        line.clock.advance(0.02)
        line.client.tick()
        line.controls()
    pad.hold(left_stick_x=0.5)
    line.controls()
    line.clock.advance(0.13)
    line.client.tick()
    assert line.controls() == [{"left-stick-x": 0.5}]
    pad.hold()
    assert line.controls() == [{}]
    line.clock.advance(10)
    line.client.tick()
    assert line.controls() == []


def test_a_line_says_how_old_the_hand_is_by_the_last_pulse() -> None:
    line = Line()
    pad = line.plugged(Pad())
    line.hear(r.Pulse(t=9_000_000))
    line.clock.advance(0.3)
    pad.hold(south=1)
    [asked] = line.take()
    assert isinstance(asked, r.AskControls)
    assert (asked.pulse, asked.since_us) == (9_000_000, 300_000)


def test_the_stop_waits_for_no_answer() -> None:
    line = Line()
    pad = line.plugged(Pad())
    for _ in range(10):
        pad.hold(south=1)
        pad.hold()
    line.take()
    pad.hold(select=1)
    [stop] = line.take()
    assert isinstance(stop, r.AskStop)
    assert stop.source == "gamepad"
    pad.hold(select=1, south=1)
    assert line.take() == []


def test_a_stalled_line_is_told_and_old_presses_stay_here() -> None:
    line = Line()
    pad = line.plugged(Pad())
    for _ in range(10):
        pad.hold(south=1)
        pad.hold()
    unanswered = line.take()
    line.clock.advance(2)
    line.client.tick()
    told = [text for text in line.said if "does not answer" in text]
    assert len(told) == 1
    for each in unanswered:
        line.hear(r.Reply(ref=each.ref, ok=True))
    assert line.controls() == [{}]
    line.client.tick()
    assert "answers again" in line.said[-1]


def test_refusals_are_told_once() -> None:
    line = Line()
    pad = line.plugged(Pad())
    for _ in range(3):
        pad.hold(south=1)
        for each in line.take():
            line.hear(r.Reply(ref=each.ref, ok=False, reason="in the hands of con1", hint="wait"))
        pad.hold(south=1, east=1)
    assert [text for text in line.said if "con1" in text] == ["pad: in the hands of con1 (wait)"]


def test_what_was_not_done_is_told_with_its_reason() -> None:
    line = Line()
    line.plugged(Pad())
    line.hear(
        m.ActionRequested(run="a1", action="Hello", source="gamepad", key="south", console="pad")
    )
    line.hear(m.ActionRefused(run="a1", action="Hello", reason="'Hello' is locked"))
    assert line.said[-1] == "Hello: 'Hello' is locked"
    line.hear(m.Command(command="c1", verb="drive", args={}, source="gamepad", key="left-stick"))
    line.hear(m.Refused(command="c1", code="unwatched", reason="no wizard's console is attached"))
    assert line.said[-1] == "drive: no wizard's console is attached"
    before = len(line.said)
    line.hear(m.ActionRequested(run="a2", action="Hello", source="key", key="h"))
    line.hear(m.ActionRefused(run="a2", action="Hello", reason="'Hello' is locked"))
    assert len(line.said) == before, "the console's own presses are the console's"


def test_an_unplugged_device_gives_its_panel_back() -> None:
    line = Line()
    pad = line.plugged(Pad())
    pad.hold(south=1)
    line.take()
    pad.held.clear()
    pad.on_gone()
    [asked] = line.take()
    assert isinstance(asked, r.AskControls)
    assert (asked.device, asked.values) == ("", {})
    line.plugged(Pad(name="another"))
    assert "another is pad" in line.said[-1]


def test_two_gamepads_get_two_panels_and_a_third_is_told() -> None:
    line = Line({"pad": PAD, "pad2": PAD})
    for name in ("first", "second", "third"):
        line.plugged(Pad(name=name))
    assert [hand.panel for hand in line.client.hands] == ["pad", "pad2", ""]
    assert "no panel" in line.said[-1]


def test_a_device_can_be_named_for_a_panel() -> None:
    line = Line({"pad": PAD, "pad2": PAD}, panel_of={"xbox": "pad2"})
    line.plugged(Pad(name="Sony"))
    line.plugged(Pad(name="Xbox"))
    assert [hand.panel for hand in line.client.hands] == ["pad", "pad2"]


def test_a_session_without_a_panel_says_what_to_do() -> None:
    line = Line({"arm": {"kind": "body"}, "odd": {"device": 3}})
    assert "docs/how-to/hands.md" in line.said[-1]


def test_a_session_that_is_back_is_told_what_lies_under_the_hand() -> None:
    line = Line()
    pad = line.plugged(Pad())
    pad.hold(south=1)
    line.take()
    line.client.disconnect()
    pad.hold(south=1, east=1)
    assert line.take() == []
    line.client.connect(lambda data: line.sent.append(codec.decode_request(data)))
    line.take()
    line.welcome({"pad": PAD})
    assert line.controls() == [{"south": 1, "east": 1}]


def test_keys_show_label_state_and_time_left() -> None:
    line = Line()
    deck = line.plugged(Pad("stream-deck"))
    line.client.tick()
    assert deck.shown[-1] == {
        "key-1": ("Hello!", "ready", ""),
        "key-2": ("Who?", "locked", ""),
        "key-3": ("STOP", "stop", ""),
    }
    t = 8_000_000
    line.hear(m.ActionRequested(run="a1", action="Hello", source="key", t=t, seq=2))
    line.hear(m.Command(command="c1", run="a1", verb="say", args={}, source="key", t=t, seq=3))
    line.hear(m.Dispatched(command="c1", latency_us=100, t=t, seq=4))
    line.hear(m.Progress(command="c1", expected_us=4_000_000, t=t, seq=5))
    line.clock.advance(1.0)
    line.client.tick()
    assert deck.shown[-1]["key-1"] == ("Hello!", "running", "3.0 s")
    line.hear(m.StopPressed(source="key", t=t + 10, seq=6))
    line.clock.advance(0.2)
    line.client.tick()
    assert deck.shown[-1]["key-3"] == ("STOP", "stopped", "")
    shown = len(deck.shown)
    line.client.disconnect()
    assert deck.shown[shown:] == [{}], "dark: nobody knows how it stands"


def test_lines_that_are_none_are_told_and_passed_over() -> None:
    line = Line()
    pad = line.plugged(Pad())
    for bad in (b"", b"\xff", b"[]", b"{", b'{"kind":"later"}', b'{"kind":"pulse"}'):
        line.client.receive(bad + b"\n")
    pad.hold(south=1)
    assert line.controls() == [{"south": 1}]


def test_without_a_panel_it_says_for_which_devices_one_could_be() -> None:
    line = Line({"face": {"kind": "body"}})
    [said] = line.said
    words = {
        "gamepad": "gamepad",
        "stream-deck": "Stream Deck",
        "spacemouse": "6-D mouse",
        "wii-remote": "Wii Remote",
        "imu": "motion sensor",
    }
    assert [words[device] in said for device in HAND_DEVICES] == [True] * len(words)
    assert "docs/how-to/hands.md" in said
