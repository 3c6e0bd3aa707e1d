"""The driver: from the panel's bytes to what is asked of the session, and back to its lights."""

from __future__ import annotations

import asyncio
from collections.abc import Iterable, Mapping
from typing import Any

from woz_drivers.midi import doctor
from woz_drivers.midi.control_requests import PanelButton, PanelKnob
from woz_drivers.midi.devices import MidiPort
from woz_drivers.midi.learning import MapLearning, begin_learning, map_text
from woz_drivers.midi.panel_layouts import LAYOUTS, MidiSignal, PanelControl, PanelModel
from woz_drivers.midi.resolved_map import MappedControl, controls_by_signal, mapped_controls
from woz_drivers.midi.settings import MidiSettings
from woz_drivers.midi.wire import CC, NOTE, MidiDecoder, MidiMessage, control_change, note_on
from woz_tui.drivers.contract import (
    Ask,
    DeviceLostError,
    DriverContext,
    DriverFacts,
    Finding,
    Health,
    Job,
    PassiveDriver,
    Probe,
    RejectedError,
    Scope,
    Verb,
)
from woz_tui.motion.body_feeds import STATE, BodyState
from woz_tui.protocol.messages import ControlsMoved, Json

#: How often the robot's state is looked at, and how often what moved is shown, in seconds.
LOOK_S = 0.05
TAKE_OVER = "take-over"


class MidiPanel(PassiveDriver):
    """One panel in front of one robot; see `docs/how-to/midi.md`.

    The panel moves nothing by itself: what it asks for is carried out, logged and refused as if a
    key had been pressed. Pulling its cable changes nothing at the robot.
    """

    Settings = MidiSettings
    summary = "a MIDI panel of knobs, sliders and buttons"
    facts = DriverFacts(
        needs="a MIDI panel",
        page="docs/how-to/midi.md",
    )
    settings: MidiSettings

    def __init__(self, name: str, settings: MidiSettings, context: DriverContext) -> None:
        super().__init__(name, settings, context)
        self._controls = mapped_controls(settings)
        self._by_signal = controls_by_signal(self._controls)
        layout = LAYOUTS[settings.panel.layout]
        self._layout = layout
        self._with_lights = settings.lights
        self._lights = PanelLights(layout, (it.control for it in self._controls))
        active = [it for it in self._controls if not it.free]
        self._feeds = {it.on: context.feed(STATE, of=it.on) for it in active}
        self._knobs = {
            it.name: PanelKnob(it, self._ask, self._now_us) for it in active if not it.pressed
        }
        self._buttons = {it.name: PanelButton(it, self._ask) for it in active if it.pressed}
        self._decoder = MidiDecoder()
        self._port = MidiPort(
            settings.device or settings.panel.device or layout.device,
            context.folder,
            on_open=self._opened,
            on_bytes=self._received,
            on_trouble=self._lost,
        )
        self._watch: asyncio.Task[None] | None = None
        self._moved: dict[str, int] = {}
        self._shown: tuple[dict[str, int | None], list[str]] = ({}, [])
        self._shown_us = -1_000_000
        self._stopped = False
        self._hinted = False

    # -- what the class tells ------------------------------------------------------------------

    @classmethod
    def verbs(cls, settings: Any) -> tuple[Verb, ...]:
        """It takes the hand's values over at once, where the hand shall win."""
        return (Verb(TAKE_OVER, "set the robot to the present values of the panel"),)

    @classmethod
    def outline(cls, settings: Any) -> dict[str, Json]:
        """The panel as the console draws it."""
        return {
            "kind": "panel",
            "name": settings.panel.title,
            "controls": [_drawn(it) for it in mapped_controls(settings)],
        }

    @classmethod
    def asks(cls, settings: Any) -> tuple[tuple[str, Ask], ...]:
        """Everything its controls may ask for, each with the path of the setting that says so."""
        panel: MidiSettings = settings
        return tuple(
            (panel.said_at(it.name), ask) for it in mapped_controls(panel) for ask in it.asks()
        )

    @classmethod
    def lesson(cls, device: str, settings: Any, *, keep: bool) -> MapLearning:
        """Listen to a panel to learn its controls: `woz midi learn`. Raises `DriverError`."""
        return begin_learning(device, settings, keep=keep)

    @classmethod
    def map_file(cls, settings: Any) -> str:
        """The map as a file would say it."""
        return map_text(settings.panel)

    @classmethod
    def table(cls, settings: Any) -> tuple[tuple[str, str, str], ...]:
        """For `woz midi show`: each control, what it sends, what it does."""
        return tuple(
            (it.name, str(it.control.signal), it.label) for it in mapped_controls(settings)
        )

    @classmethod
    async def examine(cls, probe: Probe) -> list[Finding]:
        """Which devices there are, whether this one may be used, what its map leaves free."""
        return doctor.examine(probe.name, probe.settings, probe.folder)

    # -- the bus -------------------------------------------------------------------------------

    async def open(self) -> None:
        """Begin to look for the panel."""
        self.context.health(Health.CONNECTING, "looking for the panel")
        self._port.start()
        self._watch = asyncio.create_task(self._keep_looking())

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Take over."""
        if job.verb != TAKE_OVER:
            raise RejectedError(f"{self.name} is a panel; it cannot {job.verb}")
        taken = [name for name, knob in self._knobs.items() if knob.waiting]
        for name in taken:
            self._knobs[name].jump()
        self._compare_and_show()
        return {"controls": ", ".join(taken)}

    async def stop(self, scope: Scope) -> None:
        """Nothing moves here; the stop's own light goes on."""
        if scope is Scope.ALL:
            self._stopped = True
            self._compare_and_show()

    async def resume(self) -> None:
        """The stop was released."""
        self._stopped = False
        self._compare_and_show()

    async def close(self) -> None:
        """Lights off, let go of the panel."""
        if self._watch is not None:
            self._watch.cancel()
            await asyncio.gather(self._watch, return_exceptions=True)
        lights = self._lights.bytes_for(()) + self._layout.end if self._with_lights else b""
        await self._port.close(lights)

    # -- the panel -----------------------------------------------------------------------------

    def _opened(self) -> None:
        self._decoder = MidiDecoder()
        self._lights.forget()
        self.context.health(Health.CONNECTED, self._port.path)
        if self._with_lights:
            self._port.write(self._layout.begin)
        self._compare_and_show()

    def _lost(self, error: DeviceLostError) -> None:
        for knob in self._knobs.values():
            knob.pickup.forget()
        for button in self._buttons.values():
            button.let_go()
        self.context.health(Health.LOST, error.what, error.remedy)
        self._compare_and_show()

    def _received(self, data: bytes) -> None:
        for message in self._decoder.feed(data):
            self._handle(message)
        if self._now_us() - self._shown_us >= LOOK_S * 1_000_000:
            self._compare_and_show()

    def _handle(self, message: MidiMessage) -> None:
        signal = MidiSignal(message.kind, message.number, message.channel)
        it = self._by_signal.get(signal) or self._by_signal.get(
            MidiSignal(message.kind, message.number)
        )
        if it is None:
            return
        self._moved[it.name] = message.value
        state = self._state(it.on)
        if it.name in self._buttons:
            self._buttons[it.name].pressed(message.value, state)
        elif it.name in self._knobs:
            knob = self._knobs[it.name]
            knob.moved(message.value, state)
            if knob.waiting:
                self._explain_waiting(it, state)

    def _ask(self, ask: Ask, done: Any) -> None:
        self.context.ask(ask, done)

    def _now_us(self) -> int:
        return self.context.clock.now_us()

    def _state(self, on: str) -> BodyState | None:
        feed = self._feeds.get(on)
        value = feed.latest().value if feed is not None else None
        return value if isinstance(value, BodyState) else None

    def _explain_waiting(self, it: MappedControl, state: BodyState | None) -> None:
        """Once: why the first control that is touched moves nothing."""
        if self._hinted:
            return
        self._hinted = True
        if state is None:
            self.context.notice(
                "info", f"{it.name} moves nothing: {it.on!r} does not tell where it stands"
            )
            return
        self.context.notice(
            "info",
            f"{it.name} does not move {it.label} yet, which stands elsewhere",
            "turn it past the mark; from there on the robot follows",
        )

    # -- showing -------------------------------------------------------------------------------

    async def _keep_looking(self) -> None:
        while True:
            await asyncio.sleep(LOOK_S)
            self._compare_and_show()

    def _compare_and_show(self) -> None:
        """Compare the hands with the robot, switch lights, show what is new."""
        for knob in self._knobs.values():
            knob.compare(self._state(knob.fitted.on))
        lit = [name for name, button in self._buttons.items() if self._lit(button)]
        if self._with_lights and self._port.ready:
            self._port.write(self._lights.bytes_for(lit))
        waiting = {
            name: knob.target(self._state(knob.fitted.on))
            for name, knob in self._knobs.items()
            if knob.waiting
        }
        if not self._moved and (waiting, lit) == self._shown:
            return
        if self._now_us() - self._shown_us < LOOK_S * 1_000_000:
            return
        moved, self._moved = self._moved, {}
        self._shown, self._shown_us = (waiting, lit), self._now_us()
        targets = {name: value for name, value in waiting.items() if value is not None}
        self.context.show(
            ControlsMoved(values=moved, waiting=list(waiting), targets=targets, lit=lit)
        )

    def _lit(self, button: PanelButton) -> bool:
        if button.fitted.mapped.stop == "all":
            return self._stopped
        return button.on(self._state(button.fitted.on))


def _drawn(it: MappedControl) -> dict[str, Json]:
    control = it.control
    return {
        "name": control.name,
        "kind": control.kind,
        "column": control.column,
        "row": control.row,
        "label": it.label,
        "takes_over": it.soft,
    }


# -- lights ---------------------------------------------------------------------------------------
# The lights of buttons: which shall be on, and the bytes that make it so.

_ON, _OFF = 127, 0


class PanelLights:
    """What the panel's lights show, as far as it was told; only changes are sent."""

    def __init__(self, layout: PanelModel, controls: Iterable[PanelControl]) -> None:
        self._layout = layout
        self._lamps = {
            control.name: control
            for control in controls
            if control.lamp and control.signal.kind in (CC, NOTE)
        }
        self._shown: dict[str, bool] = {}

    def forget(self) -> None:
        """A panel that was just plugged in: nobody knows what it shows."""
        self._shown.clear()

    def bytes_for(self, lit: Iterable[str]) -> bytes:
        """The bytes after which exactly the lamps `lit` are on; they count as sent."""
        names = set(lit)
        out = bytearray()
        for name, control in self._lamps.items():
            on = name in names
            if self._shown.get(name) is not on:
                self._shown[name] = on
                out += self._switch(control, on)
        return bytes(out)

    def _switch(self, control: PanelControl, on: bool) -> bytes:
        signal = control.signal
        channel = self._layout.lamp_channel or signal.channel or 1
        make = note_on if signal.kind == NOTE else control_change
        return make(channel, signal.number, _ON if on else _OFF)
