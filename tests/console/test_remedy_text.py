"""A remedy that names a verb names the button that does it in this experiment."""

from __future__ import annotations

import pytest
from msgspec.structs import replace

from tests.console import scenes
from tests.console.piloting import ConsolePilot, piloted_console
from woz_tui.protocol import messages as m
from woz_tui.protocol.panels import ActionView, PanelView

NOW = scenes.NOW


def filled_steps(*calls: m.FilledCall) -> list[list[m.FilledCall] | float]:
    return [[*calls]]


MOTORS = m.FilledCall(verb="torque", args={"on": True})
FILLED = m.ActionsFilled(
    actions={
        "Morning": filled_steps(MOTORS, m.FilledCall(verb="say", args={"text": "Hi"})),
        "Awake": filled_steps(MOTORS),
        "Asleep": filled_steps(m.FilledCall(verb="torque", args={"on": False})),
        "Get up": filled_steps(m.FilledCall(verb="posture", args={"posture": "Stand"})),
    }
)
NAMED = {"Morning": "m", "Awake": "w", "Asleep": "z", "Get up": ""}
PANEL = PanelView(
    title="P", actions=[ActionView(name=name, label=name, key=key) for name, key in NAMED.items()]
)


async def refusal_text(pilot: ConsolePilot, remedy: str) -> str:
    command = m.Command(
        command="c1", verb="gaze", args={}, driver="head", source="key", key="x", t=NOW
    )
    end = m.Refused(
        command="c1", driver="head", code="args", reason="the motors are off", remedy=remedy, t=NOW
    )
    await pilot.tell(command, end)
    return pilot.text("StopBar")


@pytest.mark.parametrize(
    ("remedy", "shown"),
    [
        ("switch them on: `torque: on`", "switch them on: Awake (w)"),
        ("`torque: true` wakes it", "Awake (w) wakes it"),
        ("rest with `torque: off`, or wait", "rest with Asleep (z), or wait"),
        ("`wake_up` or `woz doctor`", "`wake_up` or `woz doctor`"),
        ("`posture: Sit` first", "`posture: Sit` first"),
    ],
)
async def test_a_refusal_names_the_button(remedy: str, shown: str) -> None:
    async with piloted_console(scenes.welcome([*scenes.healthy(), FILLED], shown=[PANEL])) as pilot:
        assert shown in " ".join((await refusal_text(pilot, remedy)).split())


async def test_events_and_drivers_name_it_too() -> None:
    async with piloted_console(
        scenes.welcome([*scenes.healthy(), FILLED], shown=[PANEL]), size=(160, 30)
    ) as pilot:
        remedy = "then `torque: on`"
        await pilot.tell(
            m.Notice(level="warning", text="head: slack", remedy=remedy, t=NOW),
            m.DriverLost(driver="head", detail="away", remedy=remedy, t=NOW),
        )
        assert "then Awake (w)" in pilot.text("EventList")
        await pilot.press("ctrl+d")
        assert "then Awake (w)" in pilot.drawn()


async def test_a_locked_panel_names_the_key_that_opens_it() -> None:
    opens = m.FilledCall(verb="unlock", args={"panel": "Driving"}, driver="session")
    filled = m.ActionsFilled(actions={"Drive on": [[opens]]})
    driving = PanelView(
        title="Driving", locked=True, actions=[ActionView(name="Forward", label="Forward", key="f")]
    )
    button = PanelView(title="P", actions=[ActionView(name="Drive on", label="Drive on", key="d")])
    first = scenes.welcome([*scenes.healthy(), filled], shown=[driving, button])
    async with piloted_console(first) as pilot:
        assert "Driving locked, d opens it" in pilot.text("ActionPanels")
        await pilot.tell(m.PanelLocked(panel="Driving", locked=False, t=NOW))
        assert "opens it" not in pilot.text("ActionPanels")


async def test_what_several_robots_do_alike_stands_once_below_the_script() -> None:
    calls = [replace(MOTORS, driver=f"{name}.body") for name in ("nao", "pepper", "reachy")]
    filled = m.ActionsFilled(actions={"Hello": [calls]})
    async with piloted_console(scenes.welcome([*scenes.healthy()[:-1], filled])) as pilot:
        assert "torque on (3 robots)" in pilot.text("StopBar")
