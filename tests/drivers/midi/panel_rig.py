"""A panel on a pseudo-terminal, the driver on it, and a session that remembers what it is asked."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import asynccontextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

from woz_drivers.midi import MidiPanel
from woz_drivers.midi.settings import MidiSettings

from tests.drivers.published_messages import until
from tests.fakes.midi_panel import MidiPanelFake
from woz_tui.drivers.contract import Ask, Health
from woz_tui.motion.body_feeds import STATE, BodyState
from woz_tui.motion.body_verbs import CONTROLS
from woz_tui.protocol.messages import ControlsMoved, Json
from woz_tui.system.clock import Clock, RealClock
from woz_tui.testing import RecordingContext

JOINTS = ("pitch", "middle", "top")

Told = Callable[[bool, str], None]


class PanelContext(RecordingContext):
    """Answers at once, or with `slow` when the test says so; a body that does what is asked."""

    def __init__(self, folder: Path, clock: Clock | None = None) -> None:
        super().__init__(folder, clock or RealClock())
        self.slow = False
        self.refuses = ""
        self.open: list[tuple[Ask, Told]] = []
        self.body = BodyState(
            controls=dict.fromkeys((*JOINTS, *CONTROLS), 0.5),
            mode="normal",
            emotion="neutral",
            move="",
            personality="",
        )
        self.state_is()

    def state_is(self, **changed: Any) -> None:
        """The body's state, changed by somebody else than the panel."""
        controls = changed.pop("controls", {})
        self.body = replace(self.body, **changed, controls={**self.body.controls, **controls})
        self.feed(STATE, of="body").put(self.body)

    def ask(self, ask: Ask, done: Told | None = None) -> None:
        self.asks.append(ask)
        assert done is not None
        self.open.append((ask, done))
        if not self.slow:
            self.answer()

    def answer(self) -> None:
        """Carry out the oldest ask."""
        ask, done = self.open.pop(0)
        if ask.name == "control" and not self.refuses:
            name, value = ask.args["control"], ask.args["value"]
            self.state_is(controls={name: value})
        done(not self.refuses, self.refuses)

    def requests_seen(self) -> list[tuple[str, str, Mapping[str, Json]]]:
        return [(ask.what, ask.name, ask.args) for ask in self.asks]

    def turned_to(self, control: str) -> list[Json]:
        """The places to which a control of the body has been turned."""
        return [
            ask.args["value"]
            for ask in self.asks
            if ask.name == "control" and ask.args["control"] == control
        ]

    def control_messages(self) -> list[ControlsMoved]:
        return [shown for shown in self.shown if isinstance(shown, ControlsMoved)]

    def values(self) -> dict[str, int]:
        """The panel as the console shows it now."""
        return {
            name: value
            for controls_moved in self.control_messages()
            for name, value in controls_moved.values.items()
        }

    @property
    def lit_buttons(self) -> list[str]:
        """The buttons that the console shows as on."""
        return self.control_messages()[-1].lit if self.control_messages() else []

    @property
    def connected(self) -> bool:
        return bool(self.healths) and self.healths[-1][0] is Health.CONNECTED


class PanelRig:
    """The panel, the driver and the desk."""

    def __init__(self, panel: MidiPanelFake, driver: MidiPanel, context: PanelContext) -> None:
        self.panel = panel
        self.driver = driver
        self.context = context

    async def wait_for_requests(self, count: int) -> None:
        """Return when so many asks have come."""
        await until(lambda: len(self.context.asks) >= count)

    async def wait_until_shown(self, **values: int) -> None:
        """Return when the console shows these values (`knob_1` is knob-1)."""
        wanted = {name.replace("_", "-"): value for name, value in values.items()}
        await until(lambda: wanted.items() <= self.context.values().items())

    async def wait_connected(self) -> None:
        await until(lambda: self.context.connected)


@asynccontextmanager
async def connected_panel(folder: Path, **settings: Any) -> AsyncIterator[PanelRig]:
    """A driver that has found its panel."""
    panel = MidiPanelFake(folder / "midiC1D0")
    context = PanelContext(folder)
    midi_settings = MidiSettings(**{"device": str(panel.port), **settings})
    assert midi_settings.problems() == []
    driver = MidiPanel("panel", midi_settings, context)
    await driver.open()
    rig = PanelRig(panel, driver, context)
    try:
        await rig.wait_connected()
        yield rig
    finally:
        await driver.close()
        panel.unplug()
