"""What is painted while a dialog lies over the living screen: all that changes, and little else."""

from __future__ import annotations

import asyncio

import pytest
from rich.console import Console, RenderableType
from textual._compositor import ChopsUpdate
from textual.screen import Screen
from textual.widgets import Input

from tests.console import engagement_scene, scenes
from tests.console.piloting import ConsolePilot, piloted_console, screen_strips
from tests.console.test_partial_update import terminal_screen
from woz_tui.console.drawing.partial_update import cropped
from woz_tui.protocol import messages as m

NOW, SECOND = scenes.NOW, scenes.SECOND


def lines(screen: Screen[object]) -> list[str]:
    """All cells of a screen and of those beneath it."""
    return ["".join(segment.text for segment in strip) for strip in screen_strips(screen)]


class TerminalCopy:
    """Looks on as a terminal would: keeps what has been sent to it."""

    def __init__(self, pilot: ConsolePilot, monkeypatch: pytest.MonkeyPatch) -> None:
        self.rows: list[str] = []
        self.updates: list[RenderableType] = []
        self._terminal = Console(force_terminal=True, color_system="truecolor")
        display = pilot.console._display

        def watched(screen: Screen[object], update: RenderableType | None) -> None:
            if update is not None:
                self._take(screen, cropped(update))
            display(screen, update)

        monkeypatch.setattr(pilot.console, "_display", watched)

    def _take(self, screen: Screen[object], update: RenderableType | None) -> None:
        assert update is not None
        self.updates.append(update)
        if isinstance(update, ChopsUpdate) and self.rows:
            self.rows = terminal_screen(update.render_segments(self._terminal), self.rows)
        else:
            self.rows = lines(screen)


@pytest.mark.parametrize("opening", [("equals_sign",), ("equals_sign", "tab", "f"), ("comma",)])
async def test_a_change_beneath_a_dialog_repaints_few_cells(
    opening: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    async with piloted_console(
        engagement_scene.welcome(engagement_scene.engagement_shown())
    ) as pilot:
        await pilot.press(*opening)
        for field in pilot.console.screen.query(Input):
            field.cursor_blink = False  # it does so by the real clock
        await pilot.pilot.pause(0.1)
        copy = TerminalCopy(pilot, monkeypatch)
        for level in (0.1, 0.02, 0.2):
            await pilot.tell(scenes.reading(NOW, "loudness", level))
            await pilot.pilot.pause(0.05)
        painted = 0
        for update in copy.updates:
            assert isinstance(update, ChopsUpdate), "not the whole screen"
            painted += sum(end - begin for _, begin, end in update.spans)
        assert 0 < painted < 400


async def test_nothing_is_left_unpainted_when_both_screens_change_at_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    async with piloted_console(
        engagement_scene.welcome(engagement_scene.engagement_shown()), size=(100, 36)
    ) as pilot:
        copy = TerminalCopy(pilot, monkeypatch)
        await pilot.press("equals_sign")
        states = [*engagement_scene.TALK, "RobotReplies", "EngagedWithKnown"]
        for number in range(30):
            t = NOW + number * SECOND // 2
            was, now = states[number % 9 - 1], states[number % 9]
            why = f"{number} times {'present ' * (number % 3)}"
            ago = -number / 2
            told: list[m.Message] = [
                scenes.reading(t, "loudness", 0.01 * number),
                engagement_scene.engagement_shown(now, since=t, t=t),
                engagement_scene.engagement_changed(
                    was, now, "done" if number % 2 else "error", why, ago
                ),
            ]
            await pilot.tell_quietly(*told)
            pilot.clock.advance(0.13)
            await asyncio.sleep(0.02 * (number % 6))  # in every phase of both screens' timers
        await pilot.settle()
        await pilot.until(lambda: copy.rows == lines(pilot.console.screen), "every cell painted")
