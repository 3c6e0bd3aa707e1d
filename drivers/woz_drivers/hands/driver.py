"""The driver: from what hands do at a device to what is asked of the session."""

from __future__ import annotations

import asyncio
import difflib
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from woz_drivers.hands import doctor
from woz_drivers.hands.axis_groups import (
    AxisGroup,
    RateGroup,
    StickGroup,
    function_of,
    panel_value,
)
from woz_drivers.hands.device_models import STICKS
from woz_drivers.hands.device_watch import DeviceWatch
from woz_drivers.hands.settings import HandsSettings, mapped_controls
from woz_drivers.panels.control_functions import MappedControl
from woz_drivers.panels.control_panel import ControlPanel, drawn_control
from woz_tui.drivers.contract import (
    Ask,
    DriverContext,
    DriverFacts,
    Finding,
    HandInput,
    Health,
    Offer,
    Probe,
    RejectedError,
    Scope,
)
from woz_tui.protocol.messages import Json

#: A trigger that is pulled further counts as a button that is held.
PULLED = 0.5
#: A trigger that is pulled no further is at rest.
TRIGGER_REST = 0.05


class HandsPanel(ControlPanel):
    """A device in a hand, in front of one robot; see `docs/how-to/hands.md`.

    Whatever is held when the hand is lost (unplugged, cut off, silent for longer than `hold`), the
    stop is pressed or the line was too slow, counts as let go; it counts again once it has been at
    rest.
    """

    Settings = HandsSettings
    summary = "a gamepad, Stream Deck, 6-D mouse, Wii Remote or motion sensor, here or elsewhere"
    facts = DriverFacts(
        needs="such a device where woz hands runs",
        page="docs/how-to/hands.md",
    )
    settings: HandsSettings

    def __init__(self, name: str, settings: HandsSettings, context: DriverContext) -> None:
        controls = mapped_controls(settings)
        super().__init__(name, settings, context, controls)
        #: Whose hand it is, and what lies under it.
        self._client = ""
        self._device = ""
        #: Controls that are not at rest, and those of them that do not count before they were.
        self._held: dict[str, float] = {}
        self._spent: set[str] = set()
        self._heard_us = 0
        self._age_us = 0
        groups: dict[tuple[str, ...], list[MappedControl]] = {}
        for it in controls:
            if not it.pressed and not it.free and not self._is_knob(it):
                function = function_of(it)
                kind = "rate" if function.rate else str(function.every)
                same = (function.verb, function.control, it.on, function.hold, kind)
                groups.setdefault(same, []).append(it)
        self._groups = [self._group(axes) for axes in groups.values()]

    def _group(self, axes: list[MappedControl]) -> AxisGroup:
        asking, now_us, refused = self._ask, self._now_us, self._tell_refusal
        if function_of(axes[0]).rate:
            return RateGroup(axes, asking, now_us, refused, self._present)
        return StickGroup(axes, asking, now_us, refused)

    # -- what the class tells ------------------------------------------------------------------

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        """As other panels; there is something to take over if it has controls that could be. `woz
        hands` reads the outline, too.
        """
        kept: HandsSettings = settings
        mapped = mapped_controls(kept)
        held = {function_of(it).hold for it in mapped}
        used = {it.name for it in mapped if not it.free}
        offered = super().offer(settings)
        return replace(
            offered,
            verbs=offered.verbs if any(it.soft for it in mapped) else (),
            outline={
                "kind": "panel",
                "name": kept.device,
                "device": kept.device,
                "hold": kept.hold,
                "controls": [
                    _outlined(it, holds=it.name in held) for it in mapped if it.name in used | held
                ],
            },
            asks=tuple((f"controls.{it.name}", ask) for it in mapped for ask in it.asks()),
        )

    @classmethod
    def watch(cls, wanted: list[str]) -> DeviceWatch:
        """The devices of this computer, for `woz hands`; `wanted`: paths or parts of names."""
        return DeviceWatch(wanted)

    @classmethod
    async def examine(cls, probe: Probe) -> list[Finding]:
        """Which devices are plugged in here, and what the map leaves free."""
        return doctor.examine(probe.name, probe.settings)

    # -- the bus -------------------------------------------------------------------------------

    async def open(self) -> None:
        """Wait for a hand; without one nothing is missing at the robot."""
        self.context.health(Health.CONNECTED, self._waits)
        self._begin_looking()

    async def stop(self, scope: Scope) -> None:
        """Whatever is held counts no more, but for buttons that only have to be let go."""
        self._spend()
        await super().stop(scope)

    async def close(self) -> None:
        """Hear of no hand any more."""
        await self._end_looking()

    @property
    def _waits(self) -> str:
        return f"no {self.settings.device}: start woz hands where it is plugged in"

    # -- hands ---------------------------------------------------------------------------------

    def take_hand(self, hand: HandInput) -> None:
        """Take what a hand does. Raises `RejectedError`."""
        self._check(hand)
        values = {name: value for name, value in hand.values.items() if self._is_away(name, value)}
        if hand.client != self._client:
            if self._client:
                self._lose(f"{hand.client} has taken it over")
            self._client, self._device = hand.client, ""
            # Whoever plugs in with a finger on a button has not pressed it.
            self._spent = set(values)
        if hand.device is not None and hand.device != self._device:
            self._rename(hand.device)
            self._spent |= set(values)
        if hand.device == "":
            self._client = ""
            return
        self._heard_us = self._now_us()
        self._spent &= set(values)
        before, self._held = self._held, values
        for name in before.keys() - self._held.keys():
            self._moved_to(name, 0.0)
        self._age_us = hand.age_us
        try:
            for name, value in self._held.items():
                if value != before.get(name) and name not in self._spent:
                    self._moved_to(name, value)
        finally:
            self._age_us = 0
        if hand.stale:  # a press has been refused with its reason; a stick is no longer there
            self._spent |= set(values)
        self._look_at_sticks()
        self._compare_and_show()

    def lose_hand(self, client: str) -> None:
        """The connection has ended."""
        if client == self._client:
            self._lose(f"the connection of {client} has ended")
            self._client = ""
            if self._device:
                self._rename("")

    def _check(self, hand: HandInput) -> None:
        """Raises `RejectedError` for what cannot be taken."""
        if self._client and hand.client != self._client and not hand.take_over:
            raise RejectedError(
                f"{self.name} is in the hands of {self._client} ({self._device or 'no device'})",
                "woz hands --take-over takes it",
            )
        for name, value in hand.values.items():
            if name not in self._controls:
                near = difflib.get_close_matches(name, self._controls, n=1)
                meant = f"; did you mean {near[0]!r}?" if near else ""
                raise RejectedError(f"a {self.settings.device} has no {name!r}{meant}")
            low = -1.0 if name in STICKS else 0.0
            if not low <= value <= 1.0:
                raise RejectedError(f"{name} goes from {low:g} to 1, not to {value}")

    def _tell_refusal(self, what: str, why: str) -> None:
        """Once for each time that a stick is used: its commands have no lines of their own."""

        def tell() -> None:
            if not self._stopped:
                text = f"{what} moves nothing: {why}"
                self.context.notice("warning", text, "let go, then try again")

        # A stop ends the command first, and tells the drivers then.
        asyncio.get_running_loop().call_soon(tell)

    def _is_away(self, name: str, value: float) -> bool:
        """Whether a control is not at rest: no stick and no trigger comes back to 0 every time."""
        if name in STICKS:
            return abs(value) > self.settings.dead_zone
        return value > TRIGGER_REST

    def _moved_to(self, name: str, value: float) -> None:
        it = self._controls[name]
        if name in STICKS:
            value = self._beyond_dead_zone(value)
        elif it.pressed:
            value = float(value > PULLED)
        place = panel_value(name, value)
        hold = function_of(it).hold
        if name in self._knobs and hold and not self._is_held(hold):
            self._moved[name] = round(place)
            return
        self._turned(name, place)

    def _beyond_dead_zone(self, value: float) -> float:
        """A stick's place with its dead zone taken out, so that it begins at 0 behind it."""
        zone = self.settings.dead_zone
        if abs(value) <= zone:
            return 0.0
        return round((abs(value) - zone) / (1 - zone), 3) * (1 if value > 0 else -1)

    def _is_held(self, name: str) -> bool:
        return name not in self._spent and self._held.get(name, 0.0) > PULLED

    def _look_at_sticks(self) -> None:
        values = {
            name: self._beyond_dead_zone(value) if name in STICKS else value
            for name, value in self._held.items()
            if name not in self._spent
        }
        for group in self._groups:
            group.look(values, held=self._is_held(group.hold))

    def _is_knob(self, it: MappedControl) -> bool:
        return bool(it.mapped.control) and not function_of(it).rate

    def _present(self, it: MappedControl) -> float | None:
        """Where a control of the body stands."""
        state = self._state(it.on)
        return None if state is None else state.controls.get(it.mapped.control)

    # -- let go --------------------------------------------------------------------------------

    def _compare_and_show(self) -> None:
        silent_us = self._now_us() - self._heard_us
        if self._held and silent_us > self.settings.hold * 1_000_000:
            device = self.settings.device
            self._lose(f"nothing was heard of the {device} for {silent_us / 1e6:.1f} s")
        self._look_at_sticks()
        super()._compare_and_show()

    def _spend(self) -> None:
        """What is held now counts again once it has been at rest."""
        self._spent |= set(self._held)
        self._look_at_sticks()

    def _lose(self, why: str) -> None:
        """The hand is gone: all it held is let go, and what it drove stands still."""
        was_driving = any(group.active for group in self._groups)
        held = list(self._held)
        self._spend()
        self._held = {}
        self._let_go()
        for name in held:
            self._moved[name] = 64 if name in STICKS else 0
        if was_driving:
            self._ask(
                Ask("halt", f"{self.name}: {why}", source=self.settings.device),
                lambda carried, why: None,
            )
        if held:
            remedy = "let go of the controls, then go on"
            self.context.notice("warning", f"what was held has been let go: {why}", remedy)

    def _rename(self, device: str) -> None:
        """Another device lies under the hand, or none."""
        was, self._device = self._device, device
        if was and self._held:
            self._lose(f"{was} was unplugged")
        elif was and not device:
            self.context.notice("warning", f"{was} is not there any more", "plug it in again")
        whose = f"{device} ({self._client})" if device else self._waits
        self.context.health(Health.CONNECTED, whose)

    def _ask(self, ask: Ask, done: Callable[[bool, str], None]) -> None:
        if ask.what == "stop" and self._stopped:
            done(True, "")  # `woz hands` has sent it already, by the shorter way
            return
        super()._ask(replace(ask, age_us=self._age_us) if self._age_us else ask, done)


def _outlined(it: MappedControl, *, holds: bool) -> dict[str, Json]:
    """A control for the console's picture, and what a Stream Deck needs to label its key; `holds`:
    it is a dead man's button.
    """
    drawn = drawn_control(it)
    if holds and it.free:
        drawn["label"] = "dead man"
    for what in ("action", "key", "stop", "script", "release"):
        if function := getattr(it.mapped, what):
            drawn[what] = function
    return drawn
