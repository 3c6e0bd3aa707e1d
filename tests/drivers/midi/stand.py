"""A panel on a pseudo-terminal, the driver on it, and a session that remembers what it is asked."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import asynccontextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

from woz_drivers.midi import MidiPanel
from woz_drivers.midi.settings import MidiSettings

from tests.drivers.heard import until
from tests.fakes.midi_panel import MidiPanelFake
from woz_tui.drivers.contract import Ask, Health
from woz_tui.motion.body_feeds import STATE, BodyState
from woz_tui.motion.body_verbs import CONTROLS
from woz_tui.protocol.messages import ControlsMoved, Json
from woz_tui.system.clock import Clock, RealClock
from woz_tui.testing import RecordingContext

JOINTS = ("pitch", "middle", "top")

Told = Callable[[bool, str], None]


class Desk(RecordingContext):
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

    def said(self) -> list[tuple[str, str, Mapping[str, Json]]]:
        return [(ask.what, ask.name, ask.args) for ask in self.asks]

    def turned(self, control: str) -> list[Json]:
        """The places to which a control of the body has been turned."""
        return [
            ask.args["value"]
            for ask in self.asks
            if ask.name == "control" and ask.args["control"] == control
        ]

    def moved(self) -> list[ControlsMoved]:
        return [shown for shown in self.shown if isinstance(shown, ControlsMoved)]

    def values(self) -> dict[str, int]:
        """The panel as the console shows it now."""
        return {name: value for shown in self.moved() for name, value in shown.values.items()}

    @property
    def lit(self) -> list[str]:
        """The buttons that the console shows as on."""
        return self.moved()[-1].lit if self.moved() else []

    @property
    def connected(self) -> bool:
        return bool(self.healths) and self.healths[-1][0] is Health.CONNECTED


class Stand:
    """The panel, the driver and the desk."""

    def __init__(self, panel: MidiPanelFake, driver: MidiPanel, desk: Desk) -> None:
        self.panel = panel
        self.driver = driver
        self.desk = desk

    async def asked(self, count: int) -> None:
        """Return when so many asks have come."""
        await until(lambda: len(self.desk.asks) >= count)

    async def seen(self, **values: int) -> None:
        """Return when the console shows these values (`knob_1` is knob-1)."""
        wanted = {name.replace("_", "-"): value for name, value in values.items()}
        await until(lambda: wanted.items() <= self.desk.values().items())

    async def connected(self) -> None:
        await until(lambda: self.desk.connected)


@asynccontextmanager
async def stand(folder: Path, **settings: Any) -> AsyncIterator[Stand]:
    """A driver that has found its panel."""
    panel = MidiPanelFake(folder / "midiC1D0")
    desk = Desk(folder)
    made = MidiSettings(**{"device": str(panel.port), **settings})
    assert made.problems() == []
    driver = MidiPanel("panel", made, desk)
    await driver.open()
    it = Stand(panel, driver, desk)
    try:
        await it.connected()
        yield it
    finally:
        await driver.close()
        panel.unplug()
