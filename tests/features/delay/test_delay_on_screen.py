"""What the wizard sees of delayed answers."""

from __future__ import annotations

from tests.console import study_scene
from tests.console.piloting import piloted_console
from woz_tui.features.delay.kinds import ActionHeld, ShapingChanged
from woz_tui.protocol import messages as m

NOW, SECOND = study_scene.NOW, study_scene.SECOND


def held_action(seconds: float = 1.2) -> list[m.Message]:
    """Hello was pressed, and waits until it may answer."""
    return [
        m.ActionRequested(run="a20", action="Hello", source="key", t=NOW),
        ActionHeld(
            run="a20",
            action="Hello",
            sort="speech",
            cued=NOW - 300_000,
            until=NOW + round(seconds * SECOND),
            t=NOW,
        ),
    ]


async def test_a_held_action_shows_that_it_waits_and_how_long() -> None:
    async with piloted_console(study_scene.welcome(), size=(160, 50)) as pilot:
        await pilot.tell(*held_action())
        row = next(row for row in pilot.text("ActionPanels").splitlines() if "Hello" in row)
        assert "waits 1.2" in row
        assert "waits 1.2 s" in pilot.text("EventList")
        await pilot.pass_time(0.5)
        row = next(row for row in pilot.text("ActionPanels").splitlines() if "Hello" in row)
        assert "waits 0.7" in row
        await pilot.tell(
            m.Command(
                command="c20",
                run="a20",
                action="Hello",
                verb="say",
                args={},
                source="key",
                t=NOW + 2 * SECOND,
            )
        )
        await pilot.tell(
            m.Dispatched(command="c20", driver="voice", latency_us=1, t=NOW + 2 * SECOND)
        )
        row = next(row for row in pilot.text("ActionPanels").splitlines() if "Hello" in row)
        assert "waits" not in row


async def test_a_hold_of_a_run_that_is_unknown_shows_nothing() -> None:
    async with piloted_console(study_scene.welcome()) as pilot:
        await pilot.tell(held_action()[1])
        assert "waits" not in pilot.text("ActionPanels")


async def test_how_answers_are_delayed_is_an_event() -> None:
    async with piloted_console(study_scene.welcome(), size=(160, 50)) as pilot:
        changed = ShapingChanged(floor_us=800_000, jitter_us=400_000, cues=["speech"], t=NOW)
        await pilot.tell(changed)
        assert "Robot answers are delayed by 0.8 s to 1.2 s  after: speech" in pilot.text(
            "EventList"
        )
        await pilot.tell(ShapingChanged(floor_us=0, jitter_us=0, cues=[], t=NOW))
        assert "Robot answers are not delayed" in pilot.text("EventList")
