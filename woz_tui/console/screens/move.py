"""Type the name of a move and have the robot play it."""

from __future__ import annotations

from collections.abc import Sequence

from woz_tui.config.screen_language import say
from woz_tui.console.drawing.cells import Row, clean
from woz_tui.console.robot_settings.completion import (
    best_match,
    names_beginning,
    names_containing,
)
from woz_tui.console.screens.dialog import Completion, CompletionDialog, ConsoleApp, content
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.protocol.sentence import Sentence

#: Lines of matching names under the field.
MATCHES = 8


def known_moves(state: ConsoleState, driver: str) -> list[str]:
    """Names that the driver is known to play; one that tells of a whole robot may play others."""
    outline = state.robot_outlines.get(driver)
    return outline.moves if outline is not None else state.settings.moves.get(driver, [])


def open_move(app: ConsoleApp) -> None:
    """Type a move, where one can be played."""
    if any("play" in verbs for verbs in app.state.verbs.values()):
        app.open_dialog(MoveDialog())
    else:
        app.news(say("move.none", "This robot plays no moves"))


class MoveDialog(CompletionDialog):
    """Type and play: enter plays the first name that holds what was typed, unless that is a path or
    a whole name; tab puts it in, arrows walk through what was played, ctrl+o takes another robot.
    """

    heading = Sentence("move.heading", "Play")
    hint = Sentence("move.hint", "enter plays it · tab completes · arrows: history · ctrl+q closes")
    placeholder = Sentence("move.name", "the name of a move")

    verb, word = "play", Sentence("move.robot", "robot")

    def __init__(self) -> None:
        super().__init__()
        self._names: list[str] = []

    def adopt(self) -> None:
        """Names as they are now."""
        self._names = list(dict.fromkeys(known_moves(self.state, self.robot)))
        if self._names:
            part = say("move.part", "a part of a move's name")
            if any("/" in name for name in self._names):
                part = say("move.part_or_path", "a part of a move's name, or its whole path")
            self.entry.placeholder = part
        self.entry.suggester = Completion(self._suggest)
        self.changed(self.entry.value)

    def _suggest(self, typed: str) -> str | None:
        return next(iter(names_beginning(typed, self._names)), None) if typed else None

    def changed(self, typed: str) -> None:
        found = [name for name in names_containing(typed, self._names) if name != typed]
        taken = best_match(typed, self._names) if typed else ""
        rows: list[Row] = [
            ((f"{self.glyphs.here} {clean(name)}", "plain"),)
            if name == taken
            else ((f"  {clean(name)}", "muted"),)
            for name in found[:MATCHES]
        ]
        if len(found) > MATCHES:
            more = say("say.more", "{count} more", count=len(found) - MATCHES)
            rows.append(((f"  {self.glyphs.ellipsis} {more}", "muted"),))
        elif typed and not found and typed not in self._names:
            why = say("move.not_listed", "not in the list; it is sent as it is typed")
            if not self._names:
                why = say(
                    "move.no_list",
                    "this robot does not list its moves; it is sent as it is typed",
                )
            rows.append(((f"  {why}", "muted"),))
        self.update("matches", content(rows))

    def submit(self, text: str) -> None:
        key = self.console_app.key_of("move")
        self.requests.move(best_match(text, self._names), self.robot, key)

    def action_complete(self) -> None:
        """Take the first name that matches."""
        for name in names_containing(self.entry.value.strip(), self._names)[:1]:
            self.set_text(name)

    @property
    def history(self) -> Sequence[str]:
        return self.requests.moved
