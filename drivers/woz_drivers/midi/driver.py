"""The driver: from the panel's bytes to what is asked of the session, and back to its lights."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from woz_drivers.midi import doctor
from woz_drivers.midi.devices import MidiPort
from woz_drivers.midi.learning import MapLearning, begin_learning, map_text
from woz_drivers.midi.panel_layouts import LAYOUTS, PanelModel
from woz_drivers.midi.resolved_map import PanelSignals, mapped_controls, signal_of
from woz_drivers.midi.settings import MidiSettings
from woz_drivers.midi.wire import (
    CC,
    NOTE,
    PROGRAM,
    MidiDecoder,
    MidiMessage,
    control_change,
    note_on,
)
from woz_drivers.panels.control_functions import MappedControl
from woz_drivers.panels.control_panel import LOOK_S, ControlPanel, drawn_control
from woz_tui.drivers.contract import (
    DeviceLostError,
    DriverContext,
    DriverFacts,
    Finding,
    Health,
    Offer,
    Probe,
)


class MidiPanel(ControlPanel):
    """One panel in front of one robot; see `docs/how-to/midi.md`.

    Pulling its cable changes nothing at the robot.
    """

    Settings = MidiSettings
    summary = "a MIDI panel of knobs, sliders and buttons"
    facts = DriverFacts(
        needs="a MIDI panel",
        page="docs/how-to/midi.md",
    )
    settings: MidiSettings

    def __init__(self, name: str, settings: MidiSettings, context: DriverContext) -> None:
        controls = mapped_controls(settings)
        super().__init__(name, settings, context, controls)
        self._signals = PanelSignals(settings, controls)
        layout = LAYOUTS[settings.panel.layout]
        self._layout = layout
        self._with_lights = settings.lights
        self._lights = PanelLights(layout, controls)
        self._decoder = MidiDecoder()
        self._port = MidiPort(
            settings.device or settings.panel.device or layout.device,
            context.folder,
            on_open=self._opened,
            on_bytes=self._received,
            on_trouble=self._lost,
        )

    # -- what the class tells ------------------------------------------------------------------

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        """As other panels; it is drawn as the outline says."""
        panel: MidiSettings = settings
        mapped = mapped_controls(panel)
        return replace(
            super().offer(settings),
            outline={
                "kind": "panel",
                "name": panel.panel.title,
                "controls": [drawn_control(it) for it in mapped],
            },
            asks=tuple((panel.said_at(it.name), ask) for it in mapped for ask in it.asks()),
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
        return tuple((it.name, str(signal_of(it)), it.label) for it in mapped_controls(settings))

    @classmethod
    async def examine(cls, probe: Probe) -> list[Finding]:
        """Which devices there are, whether this one may be used, what its map leaves free."""
        name, settings, folder = probe.name, probe.settings, probe.folder
        return [
            *doctor.examine(name, settings, folder),
            *await doctor.listen(name, settings, folder),
        ]

    # -- the bus -------------------------------------------------------------------------------

    async def open(self) -> None:
        """Begin to look for the panel."""
        self.context.health(Health.CONNECTING, "looking for the panel")
        self._port.start()
        self._begin_looking()

    async def close(self) -> None:
        """Lights off, let go of the panel."""
        await self._end_looking()
        lights = self._lights.bytes_for(()) + self._layout.end if self._with_lights else b""
        await self._port.close(lights)

    # -- the panel -----------------------------------------------------------------------------

    def _opened(self) -> None:
        self._decoder = MidiDecoder()
        self._signals.other_mode = ""  # whoever changes the mode plugs it in anew
        self._lights.forget()
        self.context.health(Health.CONNECTED, self._port.path)
        if self._with_lights:
            self._port.write(self._layout.begin)
        self._compare_and_show()

    def _lost(self, error: DeviceLostError) -> None:
        self._let_go()
        self.context.health(Health.LOST, error.what, error.remedy)
        self._compare_and_show()

    def _received(self, data: bytes) -> None:
        for message in self._decoder.feed(data):
            self._handle(message)
        if self._now_us() - self._shown_us >= LOOK_S * 1_000_000:
            self._compare_and_show()

    def _handle(self, message: MidiMessage) -> None:
        told, it = self._signals.other_mode, self._signals.control_of(message)
        if not told and self._signals.other_mode:
            what = f"{self._port.path}: {self._signals.other_mode}"
            self.context.health(Health.FAULTED, what, self._signals.own_mode)
        if it is not None:
            self._turned(it.name, message.value)
            if message.kind == PROGRAM and it.pressed:  # nothing comes when it is let go
                self._turned(it.name, 0)

    def _switch_lights(self, lit: list[str]) -> None:
        if self._with_lights and self._port.ready:
            self._port.write(self._lights.bytes_for(lit))


# -- lights ---------------------------------------------------------------------------------------
# The lights of buttons: which shall be on, and the bytes that make it so.

_ON, _OFF = 127, 0


class PanelLights:
    """What the panel's lights show, as far as it was told; only changes are sent."""

    def __init__(self, layout: PanelModel, controls: Iterable[MappedControl]) -> None:
        self._layout = layout
        self._lamps = {
            it.name: signal_of(it)
            for it in controls
            if it.control.lamp and signal_of(it).kind in (CC, NOTE)
        }
        self._shown: dict[str, bool] = {}

    def forget(self) -> None:
        """A panel that was just plugged in: nobody knows what it shows."""
        self._shown.clear()

    def bytes_for(self, lit: Iterable[str]) -> bytes:
        """The bytes after which exactly the lamps `lit` are on; they count as sent."""
        names = set(lit)
        out = bytearray()
        for name, signal in self._lamps.items():
            on = name in names
            if self._shown.get(name) is not on:
                self._shown[name] = on
                channel = self._layout.lamp_channel or signal.channel or 1
                make = note_on if signal.kind == NOTE else control_change
                out += make(channel, signal.number, _ON if on else _OFF)
        return bytes(out)
