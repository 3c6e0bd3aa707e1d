"""A robot's settings: what they are, what they were to be, and the wizard's hand on them.

The arrows, space and enter are the screen's; every other key plays the robot as everywhere.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from typing import ClassVar

from textual import events
from textual.widget import Widget
from textual.widgets import Input, Static

from woz_tui.config.keys.textual_names import from_textual
from woz_tui.config.screen_language import say
from woz_tui.console.drawing.cells import Row, clean
from woz_tui.console.drawing.glyphs import PaintFrame
from woz_tui.console.drawing.key_caps import key_name
from woz_tui.console.robot_settings.lines import CONNECTION, LineKind, SettingLine
from woz_tui.console.robot_settings.requests import SettingRequests
from woz_tui.console.robot_settings.rows import (
    ListPosition,
    Swatches,
    list_room,
    scrolled,
    settings_rows,
)
from woz_tui.console.robot_settings.status import is_stale
from woz_tui.console.robot_settings.values import (
    SettingValueError,
    allowed_values,
    next_value,
    typed_value,
    value_text,
)
from woz_tui.console.robot_settings.view import SettingViewer
from woz_tui.console.screens.dialog import EntryDialog, plain
from woz_tui.console.screens.drawing import DrawingDialog
from woz_tui.protocol.messages import Json
from woz_tui.protocol.sentence import Sentence

_ROBOTS = {"tab": 1, "shift+tab": -1}
_LINES = {"up": -1, "down": 1}
_VALUES = {"left": -1, "right": 1}
_DO = frozenset(("space", "enter"))
#: Taken only where no action of the experiment has them.
_FAR = frozenset(("pageup", "pagedown", "home", "end"))
#: Under which name the requests keep which line was chosen.
_LAST = "RobotDialog line"
_REPLAY_HINT = Sentence(
    "robot.replay_hint", "arrows up and down choose · tab: next · ctrl+q closes"
)


class RobotDialog(DrawingDialog):
    """One of the session's robots; tab shows the next."""

    heading: str = Sentence("robot.heading", "Robot")
    hint = Sentence(
        "robot.hint", "arrows, space, enter: change · other keys play · tab: next · ctrl+q closes"
    )

    def __init__(self) -> None:
        super().__init__()
        self._line = 0
        self._top = 0
        self._open = True
        self.own_keys = frozenset((*_ROBOTS, *_LINES, *_VALUES, *_DO))

    def on_mount(self) -> None:
        """Now the app is known: its keys, its requests."""
        app = self.console_app
        if app.state.replay is None:
            self.own_keys |= _FAR - app.keymap.table.keys()
        else:  # nothing can be changed, and the other keys move through the log
            self.own_keys = frozenset((*_ROBOTS, *_LINES))
            self.show_hint(_REPLAY_HINT)
        self._line = self._first_line()
        app.give_keys()

    @cached_property
    def _hand(self) -> SettingRequests:
        """Made when it is first needed: a painting may come before the mounting."""
        key = self.console_app.key_of("robot")
        return SettingRequests(
            self.state, self.requests.ask, self.requests.refused, key, watched=self._is_open
        )

    def _is_open(self) -> bool:
        return self._open

    @cached_property
    def _viewer(self) -> SettingViewer:
        return SettingViewer(self.state, self.glyphs, self.console_app.arrows, self._hand)

    def _first_line(self) -> int:
        """Where it opens: without a robot where one is taken, with settings that differ at the
        first of them, else at the line that was chosen last.
        """
        if not self.count():
            return 0
        lines, driver = self._lines(), self._driver
        shown = self.state.session.robots.shown.get(driver)
        wanted = shown.wanted if shown is not None else {}
        if is_stale(self.state, driver):
            found = [number for number, line in enumerate(lines) if line.kind is LineKind.ROBOT]
        else:
            found = [number for number, line in enumerate(lines) if line.setting.name in wanted]
        last = self.requests.drafts.get(_LAST)
        found += [number for number, line in enumerate(lines) if line.id == last]
        return next(iter(found), 0)

    def closing(self) -> None:
        """What is refused from now on is told on the main screen; the line is remembered, but not
        one where the next enter, in a hurry, would let go of the robot.
        """
        self._open = False
        line = self._lines()[self._line] if self.count() else None
        if line is not None and line.setting.section != CONNECTION:
            self.requests.drafts[_LAST] = line.id

    def body(self) -> Iterable[Widget]:
        """Cells that can show a colour."""
        yield Swatches(id="drawing")

    def count(self) -> int:
        return len(self.state.robot_outlines)

    def nothing(self) -> str:
        """What stands there in a session without such a robot."""
        names = list(dict.fromkeys(self.state.short_names.values()))
        key = key_name(self.console_app.key_of("drivers"), self.glyphs)
        told = say("robot.no_settings", "no settings to change here.")
        if names:
            told = say(
                "robot.none_of", "{names}: no settings to change here.", names=", ".join(names)
            )
        return f"{told}\n{say('robot.drivers', '{key} says how each driver is.', key=key)}"

    def rows(self, chosen: int, frame: PaintFrame) -> list[Row]:
        self._hand.settle(frame.now)
        driver, outline = list(self.state.robot_outlines.items())[chosen]
        view = self._viewer.see(driver, outline, frame.now)
        self._line = min(self._line, max(0, len(view.lines) - 1))
        self._top = scrolled(view.lines, self._line, self._top, frame)
        colours = not (self.app.no_color or self.app.has_class("-sixteen"))
        place = ListPosition(self._line, self._top, chosen, self.count(), colours)
        return settings_rows(view, place, frame)

    # -- keys -----------------------------------------------------------------------------------

    def on_key(self, event: events.Key) -> None:
        """Choose a line, change its value."""
        chord = from_textual(event.key, event.character)
        if chord not in self.own_keys:
            return
        event.stop()
        event.prevent_default()  # tab is `DrawingDialog`'s, too
        if not self.count():
            return
        if chord in _ROBOTS:
            self._chosen, self._line, self._top = self._chosen + _ROBOTS[chord], 0, 0
        elif chord in _VALUES:
            self._step(_VALUES[chord])
        elif chord in _DO:
            self._enter(typed=chord == "enter")
        else:
            self._walk(chord)
        self.refreshed()

    @property
    def _driver(self) -> str:
        return list(self.state.robot_outlines)[self._chosen % self.count()]

    def _lines(self) -> list[SettingLine]:
        return self._viewer.lines(self._driver, self.state.robot_outlines[self._driver])

    def _walk(self, chord: str) -> None:
        last = max(0, len(self._lines()) - 1)
        heights = [cells.size.height for cells in self.query("#drawing")]  # none before drawing
        rooms = [list_room(PaintFrame(0, height, 0, self.glyphs)) for height in heights]
        page = max(1, max(rooms, default=1) - 2)
        by = {**_LINES, "pageup": -page, "pagedown": page, "home": -last, "end": last}[chord]
        self._line = min(last, max(0, self._line + by))

    def _chosen_line(self) -> SettingLine | None:
        """The chosen line, if something may be done there."""
        lines = self._lines()
        line = lines[self._line] if self._line < len(lines) else None
        return None if line is None or self._viewer.locked(self._driver, line) else line

    def _step(self, by: int) -> None:
        """An arrow to the left or right."""
        line = self._chosen_line()
        if line is None or not line.is_set:
            return
        value = next_value(line.setting, self._viewer.value(self._driver, line), by)
        if value is None:
            self._type(line)
        else:
            self._change(line, value)

    def _enter(self, *, typed: bool) -> None:
        """Enter or space: do it, change it or type it. Only enter asks for a number, takes another
        robot or lets one go: elsewhere space plays the script.
        """
        line = self._chosen_line()
        if line is None:
            return
        if line.kind in (LineKind.ROBOT, LineKind.DISCONNECT):
            if typed:
                self._change(line, line.setting.name if line.kind is LineKind.ROBOT else True)
        elif line.is_typed and (typed or line.setting.kind != "number"):
            self._type(line)
        elif line.is_set:
            self._step(1)

    def _type(self, line: SettingLine) -> None:
        if line.is_typed:
            now = value_text(line.setting, self._viewer.value(self._driver, line), self.glyphs)
            self.console_app.open_dialog(ValueDialog(self, self._driver, line, now))

    def typed(self, driver: str, line: SettingLine, value: Json) -> None:
        if self._viewer.locked(driver, line):
            return
        self._change(line, value, driver)
        self.refreshed()

    def _change(self, line: SettingLine, value: Json, driver: str = "") -> None:
        if line.kind is not LineKind.STEP:
            self._hand.change(driver or self._driver, line, value)
        elif isinstance(value, int | float):
            self.console_app.arrows.change(line.setting.name, value)


class ValueDialog(EntryDialog):
    """A field for one value."""

    heading: str = Sentence("robot.value", "Value")
    hint = Sentence("robot.value_hint", "enter sets it · ctrl+q closes")
    BINDINGS: ClassVar = []

    def __init__(self, asks: RobotDialog, driver: str, line: SettingLine, now: str) -> None:
        super().__init__()
        self._asks, self._driver, self._line, self._now = asks, driver, line, now

    @property
    def draft(self) -> str:
        """Each setting has its own."""
        return f"{type(self).__name__} {self._driver} {self._line.id}"

    def on_mount(self) -> None:
        """Say what it is about."""
        for box in self.query(".dialog"):
            box.border_title = plain(f"{self._driver}: {self._line.setting.label}")
        for entry in self.query("#entry").results(Input):
            entry.placeholder = clean(say("robot.now", "now {value}", value=self._now))

    def below(self) -> Iterable[Widget]:
        """What may be typed, and what is wrong with what was."""
        setting = self._line.setting
        told = allowed_values(setting) or setting.help
        yield Static(plain(self.glyphs.plain(told)), classes="caption")
        yield Static("", id="wrong", classes="wrong")

    def accept(self, typed: str) -> None:
        """Set it; an empty field only closes, a wrong value stays."""
        if not typed:
            self.sent()
            return
        try:
            value = typed_value(self._line.setting, typed)
        except SettingValueError as wrong:
            self.update("wrong", plain(str(wrong)))
            return
        self.sent()
        self._asks.typed(self._driver, self._line, value)
