"""What `woz hands` says to a session of what lies in the hands, and what it hears back.

Nothing here waits or opens anything: lines go out through a function and come in through another
one, and `tick` is called many times a second.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Protocol

import msgspec

from woz_tui.console.drawing.number_text import time_left
from woz_tui.console.link.message_feed import Incoming
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol.requests import (
    PROTOCOL,
    AskControls,
    AskStop,
    Hello,
    PanelsChanged,
    Pulse,
    Reply,
    Request,
    Welcome,
)
from woz_tui.protocol.welcome import STALE_S
from woz_tui.system.clock import Clock, boot_id
from woz_tui.system.text_cleaning import clean, with_remedy

#: What such a panel can be for.
HANDS = "a gamepad, Stream Deck, 6-D mouse, Wii Remote or motion sensor"
#: Lines about a panel that may be unanswered; then only the newest state of its sticks is kept.
UNANSWERED = 4
#: The shortest time between two places of a stick, in microseconds.
STICK_US = 25_000
#: States of a device that wait to be sent: presses in their order. More are no fingers.
WAITING = 32
#: How often keys with displays are drawn anew, in microseconds.
FACES_US = 100_000
#: What is held is said again after this share of the panel's `hold`.
BEAT_SHARE = 0.25


class PluggedInDevice(Protocol):
    """What hands play with (`woz_drivers.hands`), which this package must not import."""

    kind: str
    name: str
    path: str
    held: dict[str, float]
    on_change: Callable[[], None]
    on_gone: Callable[[], None]

    def show(self, faces: Mapping[str, Any]) -> None: ...


class _Control(msgspec.Struct, frozen=True):
    """A control of a panel, from its outline."""

    name: str
    label: str = ""
    action: str = ""
    key: str = ""
    stop: str = ""
    release: bool = False
    script: bool = False


class HandPanel(msgspec.Struct, frozen=True):
    """A panel of the type `hands`, from its outline in the welcome."""

    device: str
    hold: float
    controls: list[_Control]


@dataclass
class Hand:
    """A device in front of a panel, and the states of it that have not been sent."""

    device: PluggedInDevice
    panel: str = ""
    #: States that were not sent yet, and when it was in them (`Clock.boot_us`).
    waiting: list[tuple[dict[str, float], int]] = field(default_factory=list)
    unanswered: dict[int, int] = field(default_factory=dict)
    sent: dict[str, float] = field(default_factory=dict)
    sent_us: int = 0
    refused: str = ""
    faces: dict[str, Any] = field(default_factory=dict)


class HandClient:
    """One connection's worth of a session; devices stay over connections.

    Args:
        clock: Time.
        say: Tells the wizard a line.
        panel_of: Part of a device's name, or its path -> the panel that it is for; empty: any.
        take_over: Whether panels are taken from other clients.
    """

    def __init__(
        self,
        clock: Clock,
        say: Callable[[str], None],
        *,
        panel_of: Mapping[str, str] | None = None,
        take_over: bool = False,
    ) -> None:
        self.state = ConsoleState()
        #: Those of the type `hands`, by driver, in the robot file's order.
        self.panels: dict[str, HandPanel] = {}
        self.hands: list[Hand] = []
        self.welcomed = False
        #: The session has refused the hello, and has said why.
        self.turned_away = False
        self._clock = clock
        self._say = say
        self._panel_of = panel_of or {}
        self._take_over = take_over
        self._write: Callable[[bytes], None] | None = None
        self._ref = 0
        self._pulse = 0
        self._pulse_us = 0
        self._stamps = False
        self._slow = False
        self._faces_us = 0
        #: Runs and commands of these hands -> what was asked for.
        self._requested: dict[str, str] = {}

    # -- the connection ------------------------------------------------------------------------

    def connect(self, write: Callable[[bytes], None]) -> None:
        """A session can be reached; `write` sends it a line."""
        self._write = write
        self.welcomed = False
        self._ask(
            Hello(role="program", name="hands", protocol=PROTOCOL, stream="actions", sees="wizard")
        )

    def disconnect(self) -> None:
        """The session cannot be reached any more: nothing of what is held counts there."""
        self._write = None
        self.welcomed = False
        for hand in self.hands:
            hand.waiting.clear()
            hand.unanswered.clear()
            hand.sent = {}
            hand.panel = ""
            self._show(hand, {})

    @property
    def ended(self) -> bool:
        """Whether the session is over."""
        return bool(self.state.ended)

    def receive(self, line: bytes) -> None:
        """A line of the session."""
        try:
            message = codec.decode_incoming(line)
        except codec.WireError as error:
            self._say(f"the session sent a line that is no message: {error}")
            return
        now_us = self._clock.boot_us()
        self.state.apply([message], now_us)
        match message:
            case Welcome():
                self._pulse, self._pulse_us = message.t, now_us
                self._stamps = bool(message.boot_id) and message.boot_id == boot_id()
                self._welcome(message)
            case Pulse():
                self._pulse, self._pulse_us = message.t, now_us
            case PanelsChanged():
                self._faces_us = 0
            case Reply():
                self._reply(message)
            case _:
                self._hear(message)

    def _welcome(self, welcome: Welcome) -> None:
        self.welcomed = True
        self.panels = {}
        for driver, outline in welcome.settings.outlines.items():
            if isinstance(outline, dict) and "device" in outline:
                with contextlib.suppress(msgspec.ValidationError):
                    self.panels[driver] = msgspec.convert(outline, HandPanel)
        self._requested.clear()
        if not self.panels:
            self._say(
                f"{clean(welcome.title)}: no panel for {HANDS} is in its robot"
                " file; add one: `pad: {type: hands, controls: {south: {action: Hello}}}`"
                " (docs/how-to/hands.md)"
            )
        for hand in self.hands:
            self._attach(hand)

    def _reply(self, reply: Reply) -> None:
        hand = next((each for each in self.hands if reply.ref in each.unanswered), None)
        if hand is None:
            if not reply.ok and reply.ref:
                self._say(clean(with_remedy(reply.reason, reply.hint)))
                self.turned_away |= not self.welcomed
            return
        del hand.unanswered[reply.ref]
        sentence = "" if reply.ok else clean(with_remedy(reply.reason, reply.hint))
        if sentence and sentence != hand.refused:
            self._say(f"{hand.panel}: {sentence}")
        hand.refused = sentence
        self._flush(hand)

    def _hear(self, message: Incoming) -> None:
        """Tell why something that these hands asked for was not done."""
        match message:
            case m.ActionRequested(source=source, console=console, run=run, action=action):
                self._remember(source, console, run, action)
            case m.Command(source=source, run="", command=command, verb=verb):
                self._remember(source, "", command, verb)
            case m.ActionRefused(run=run) | m.ActionFailed(run=run):
                self._explain(run, message.reason)
            case m.Refused(command=command) | m.Failed(command=command):
                self._explain(command, message.reason)
            case m.End(command=command):
                self._requested.pop(command, None)
            case m.ActionEnd(run=run):
                self._requested.pop(run, None)

    def _remember(self, source: str, panel: str, run: str, what: str) -> None:
        kinds = {hand.device.kind for hand in self.hands if panel in ("", hand.panel)}
        if source in kinds:
            self._requested[run] = what

    def _explain(self, run: str, reason: str) -> None:
        what = self._requested.pop(run, "")
        if what:
            self._say(f"{clean(what)}: {clean(reason)}")

    # -- devices -------------------------------------------------------------------------------

    def add(self, device: PluggedInDevice) -> None:
        """A device has been plugged in."""
        hand = Hand(device)
        self.hands.append(hand)
        device.on_change = partial(self._changed, hand)
        device.on_gone = partial(self._remove, hand)
        if self.welcomed:
            self._attach(hand)

    def _remove(self, hand: Hand) -> None:
        self.hands.remove(hand)
        self._say(f"{hand.device.name} was unplugged")
        if hand.panel:
            self._ask(self._controls(hand, {}, self._clock.boot_us(), device=""))

    def _attach(self, hand: Hand) -> None:
        device = hand.device
        hand.panel = self._panel_for(device)
        if not hand.panel:
            panels = ", ".join(self.panels) or "none"
            self._say(f"{device.name} ({device.kind}) has no panel here; there are: {panels}")
            return
        panel = self.panels[hand.panel]
        used = ", ".join(f"{one.name} {one.label}" for one in panel.controls if one.label)
        self._say(f"{device.name} is {hand.panel}: {clean(used)}")
        self._queue(hand, dict(device.held))

    def _panel_for(self, device: PluggedInDevice) -> str:
        """The panel that was named for it, or the first of its kind that has no device yet."""
        taken = {hand.panel for hand in self.hands}
        for named, panel in self._panel_of.items():
            if panel and (named == device.path or named.casefold() in device.name.casefold()):
                return panel if panel in self.panels and panel not in taken else ""
        kept = taken.union(self._panel_of.values())
        for name, hand_panel in self.panels.items():
            if hand_panel.device == device.kind and name not in kept:
                return name
        return ""

    # -- out -----------------------------------------------------------------------------------

    def _changed(self, hand: Hand) -> None:
        """A control of the device has moved."""
        if not hand.panel or self._write is None:
            return
        held = dict(hand.device.held)
        before = hand.waiting[-1][0] if hand.waiting else hand.sent
        panel = self.panels[hand.panel]
        stops = [one.name for one in panel.controls if one.stop == "all"]
        if any(name in held and name not in before for name in stops):
            self._ask(AskStop(source=hand.device.kind))
        self._queue(hand, held)

    def _queue(self, hand: Hand, held: dict[str, float]) -> None:
        """Keep a state to be sent: of sticks that only move on, the newest replaces the last."""
        if hand.waiting and hand.waiting[-1][0].keys() == held.keys():
            hand.waiting.pop()
        elif len(hand.waiting) >= WAITING:
            hand.waiting.clear()
        hand.waiting.append((held, self._clock.boot_us()))
        self._flush(hand)

    def _flush(self, hand: Hand) -> None:
        now_us = self._clock.boot_us()
        while hand.waiting and len(hand.unanswered) < UNANSWERED:
            held, moved_us = hand.waiting[0]
            only_moved = held.keys() == hand.sent.keys() and held != hand.sent
            if only_moved and now_us - hand.sent_us < STICK_US:
                return  # the next tick sends it, or what it is then
            hand.waiting.pop(0)
            ref = self._ask(self._controls(hand, held, moved_us, device=hand.device.name))
            hand.unanswered[ref] = now_us
            hand.sent, hand.sent_us = held, now_us

    def _controls(
        self, hand: Hand, held: dict[str, float], moved_us: int, *, device: str
    ) -> AskControls:
        return AskControls(
            panel=hand.panel,
            values=held,
            device=device,
            take_over=self._take_over,
            pulse=self._pulse,
            since_us=moved_us - self._pulse_us,
        )

    def _ask(self, request: Request) -> int:
        self._ref += 1
        if self._write is not None:
            sent_us = self._clock.boot_us() if self._stamps else 0
            line = msgspec.structs.replace(request, ref=self._ref, sent_us=sent_us)
            self._write(codec.encode(line))
        return self._ref

    def tick(self) -> None:
        """Say again what is held, send what waits, draw keys."""
        if not self.welcomed:
            return
        now_us = self._clock.boot_us()
        for hand in self.hands:
            if hand.panel:
                held, waits = hand.device.held, bool(hand.waiting)
                every_us = self.panels[hand.panel].hold * BEAT_SHARE * 1_000_000
                if held and not waits and now_us - hand.sent_us >= every_us:
                    hand.waiting.append((dict(held), now_us))
                self._flush(hand)
        self._watch_line(now_us)
        if now_us - self._faces_us >= FACES_US:
            self._faces_us = now_us
            for hand in self.hands:
                self._show(hand, self._faces(hand))

    def _watch_line(self, now_us: int) -> None:
        """Say when the line stalls; presses that are too old by then are not sent any more."""
        stale_us = (self.state.settings.stale_after or STALE_S) * 1_000_000
        oldest = min((at for hand in self.hands for at in hand.unanswered.values()), default=now_us)
        slow = now_us - oldest > stale_us
        if slow and not self._slow:
            self._say("the session does not answer; what is held counts as let go there")
        elif self._slow and not slow:
            self._say("the session answers again; let go of the controls, then go on")
        self._slow = slow
        if slow:
            for hand in self.hands:
                hand.waiting = hand.waiting[-1:]

    # -- keys with displays --------------------------------------------------------------------

    def _show(self, hand: Hand, faces: dict[str, Any]) -> None:
        if faces != hand.faces:
            hand.faces = faces
            hand.device.show(faces)

    def _faces(self, hand: Hand) -> dict[str, tuple[str, str, str]]:
        """What the keys of a device show: label, state, what is below it."""
        panel = self.panels.get(hand.panel)
        if panel is None:
            return {}
        stopped = self.state.session.stop is not None
        now = self.state.now(self._clock.boot_us())
        actions = {
            action.name: (shown, action) for shown in self.state.panels for action in shown.actions
        }
        by_key = {action.key: name for name, (_, action) in actions.items() if action.key}
        faces = {}
        for one in panel.controls:
            if not one.label:
                continue
            found = actions.get(one.action or by_key.get(one.key, ""))
            if one.stop == "all":
                faces[one.name] = (one.label, "stopped" if stopped else "stop", "")
            elif found is None:
                faces[one.name] = (one.label, "ready", "")
            else:
                _, action = found
                view = self.state.button_view(*found, now)
                label = action.label if one.label in (action.name, one.key) else one.label
                left = f"{time_left(view.left_us)} s" if view.left_us is not None else ""
                faces[one.name] = (label, view.state.value, left)
        return faces
