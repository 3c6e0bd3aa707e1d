"""Knobs of a panel send a hundred values a second: they are drawn, but no line of events each."""

from __future__ import annotations

from tests.console import scenes
from tests.console.test_console_state import welcomed_state
from woz_tui.protocol import messages as m

NOW = scenes.NOW


def command(verb: str, **args: m.Json) -> m.Command:
    return m.Command(
        command="c9", verb=verb, args=args, driver="body", source="midi", key="knob-1", t=NOW
    )


def test_a_turn_of_a_knob_is_no_event_and_nothing_that_could_be_cut_short() -> None:
    state = welcomed_state(command("control", control="pitch", value=0.5))
    before = len(state.events)
    assert not state.runs.active
    done = m.Done(command="c9", driver="body", latency_us=1, duration_us=2, sent={}, t=NOW)
    state.apply([done], 0)
    assert len(state.events) == before
    assert not any("control" in event.text for event in state.events)


def test_a_press_of_a_panels_button_is_an_event() -> None:
    state = welcomed_state(command("play", move="nod"))
    assert state.events[-1].text == "play nod"
    assert "c9" in state.runs.active
