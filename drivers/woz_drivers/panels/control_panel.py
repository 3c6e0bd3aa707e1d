"""What panels of controls have in common: hands on knobs become requests, and lights come back."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from woz_drivers.panels.control_functions import MappedControl
from woz_drivers.panels.control_requests import PanelButton, PanelKnob
from woz_tui.drivers.contract import (
    Ask,
    DriverContext,
    Job,
    Offer,
    PassiveDriver,
    RejectedError,
    Scope,
    Verb,
)
from woz_tui.motion.body_feeds import STATE, BodyState
from woz_tui.protocol.messages import ControlsMoved, Json
from woz_tui.system.tasks import end_tasks

#: How often the robot's state is looked at, and how often what moved is shown, in seconds.
LOOK_S = 0.05
TAKE_OVER = "take-over"


class ControlPanel(PassiveDriver):
    """A panel in front of one robot. It moves nothing by itself: what it asks for is carried out,
    logged and refused as if a key had been pressed.

    Args:
        name: The driver's name.
        settings: The driver's settings.
        context: The session.
        controls: What each control does.
    """

    def __init__(
        self,
        name: str,
        settings: Any,
        context: DriverContext,
        controls: Sequence[MappedControl],
    ) -> None:
        super().__init__(name, settings, context)
        active = [it for it in controls if not it.free]
        self._controls = {it.name: it for it in controls}
        self._feeds = {it.on: context.feed(STATE, of=it.on) for it in active}
        self._knobs = {
            it.name: PanelKnob(it, self._ask, self._now_us)
            for it in active
            if not it.pressed and self._is_knob(it)
        }
        self._buttons = {it.name: PanelButton(it, self._ask) for it in active if it.pressed}
        self._watch: asyncio.Task[None] | None = None
        self._moved: dict[str, int] = {}
        self._shown: tuple[dict[str, int | None], list[str]] = ({}, [])
        self._shown_us = -1_000_000
        self._stopped = False
        self._hinted = False

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        """It takes the hand's values over at once, where the hand shall win."""
        return Offer(
            verbs=(
                Verb(TAKE_OVER, "set the robot to the present values of the panel", evidence=""),
            ),
            part=str(settings.part),
        )

    # -- the bus -------------------------------------------------------------------------------

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

    # -- the controls --------------------------------------------------------------------------

    def _is_knob(self, it: MappedControl) -> bool:
        """Whether a control that is not pressed is a knob that follows the hand by itself."""
        return True

    def _turned(self, name: str, value: float) -> None:
        """A knob or button has moved to `value`, 0..127."""
        self._moved[name] = round(value)
        it = self._controls[name]
        state = self._state(it.on)
        if name in self._buttons:
            self._buttons[name].pressed(value, state)
        elif name in self._knobs:
            knob = self._knobs[name]
            knob.moved(value, state)
            if knob.waiting:
                self._explain_waiting(it, state)

    def _let_go(self) -> None:
        """The panel is gone, and with it the hands."""
        for knob in self._knobs.values():
            knob.pickup.forget()
        for button in self._buttons.values():
            button.let_go()

    def _ask(self, ask: Ask, done: Callable[[bool, str], None]) -> None:
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

    def _begin_looking(self) -> None:
        self._watch = asyncio.create_task(self._keep_looking())

    async def _end_looking(self) -> None:
        await end_tasks(self._watch)

    async def _keep_looking(self) -> None:
        while True:
            await asyncio.sleep(LOOK_S)
            self._compare_and_show()

    def _switch_lights(self, lit: list[str]) -> None:
        """Switch the lights of buttons on the panel itself: these are on."""

    def _compare_and_show(self) -> None:
        """Compare the hands with the robot, switch lights, show what is new."""
        for knob in self._knobs.values():
            knob.compare(self._state(knob.fitted.on))
        lit = [name for name, button in self._buttons.items() if self._lit(button)]
        self._switch_lights(lit)
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


def drawn_control(it: MappedControl) -> dict[str, Json]:
    """A control for the console's picture, in `Driver.outline`."""
    control = it.control
    return {
        "name": control.name,
        "kind": control.kind,
        "column": control.column,
        "row": control.row,
        "label": it.label,
        "takes_over": it.soft,
    }
