"""The robot's camera, as large as the screen allows; the robot is played meanwhile."""

from __future__ import annotations

from collections.abc import Iterable

from rich.console import RenderableType
from textual import events
from textual.containers import Vertical
from textual.widget import Widget

from woz_tui.config.screen_language import say, word
from woz_tui.console.camera.picture_requests import STALE_S, PictureRequester
from woz_tui.console.camera.picture_sizes import CELL, CellArea, area_for
from woz_tui.console.camera.picture_widgets import PictureView, depth_of, view_for
from woz_tui.console.drawing.cells import Cells, Row, clean, cut
from woz_tui.console.screens.dialog import Dialog
from woz_tui.protocol.camera_pictures import PictureShown
from woz_tui.protocol.requests import AskVerb
from woz_tui.protocol.sentence import Sentence

#: How often is looked whether the next picture may be asked for, in seconds.
_LOOK_S = 0.05
#: Sizes to choose from, as shares of the room there is.
_SIZES = (1.0, 0.75, 0.5, 0.35)
#: Columns and lines that the frame takes, and the words; lines left for the stop's bar.
_FRAME, _WORDS, _BAR = (4, 2), 1, 2
#: The frame is not narrower: its words have to fit.
_NARROWEST = 34
#: The shape of a picture before the first one has come.
_SHAPE = (4, 3)
_NEXT, _BACK, _LARGER, _SMALLER, _TAKE = "tab", "shift+tab", "+", "-", "enter"
#: Their names to Textual.
_KEYS = {"plus": _LARGER, "minus": _SMALLER}
#: The driver's verb that makes a file of a picture.
_VERB = "picture"
OFF = Sentence("camera.switched_off", "Pictures are switched off (--pictures off).")
REPLAY = Sentence("camera.replay", "A replay has no pictures: they are in no log.")


class CameraDialog(Dialog):
    """One camera of the session; tab shows the next."""

    heading = Sentence("camera.heading", "Camera")
    hint = Sentence("camera.hint", "tab next · + - size · enter file · ctrl+q")
    size_class = "drawing"
    plays = True
    own_keys = frozenset((_NEXT, _BACK, _LARGER, _SMALLER, _TAKE))

    def __init__(self) -> None:
        super().__init__()
        self._step = 0
        self._view: PictureView | None = None
        self._watching: PictureRequester | None = None
        self._shape = _SHAPE
        self._laid: tuple[CellArea, tuple[int, int]] | None = None

    # -- what it consists of -----------------------------------------------------------------

    def body(self) -> Iterable[Widget]:
        """Words in one line; beneath them the picture, in the way that suits the terminal."""
        words = Cells(id="camera-words")
        words.styles.height = _WORDS
        yield words
        app = self.console_app
        if app.pictures == "off" or self.state.role == "replay":
            return
        plain = self.glyphs.ascii or self.app.no_color
        depth = depth_of(self.app.console.color_system, plain=plain)
        self._view = view_for(app.pictures, depth, app.picture_terminal, app.terminal.multiplexer)
        self._watching = PictureRequester(
            self.requests.ask_picture, app.clock, app.picture_terminal, self._draw
        )
        middle = Vertical(self._view)
        middle.styles.align_horizontal = "center"
        yield middle

    def on_mount(self) -> None:
        self._lay_out()
        self.set_interval(_LOOK_S, self._request_picture)

    def on_resize(self) -> None:
        self._lay_out()

    # -- its place ---------------------------------------------------------------------------

    def _lay_out(self) -> None:
        """Frame and picture in their size; nothing happens where it is the same as before."""
        width, height = size = self.app.size
        terminal = self.console_app.picture_terminal
        cell = (terminal.cell if terminal is not None else None) or CELL
        share = _SIZES[self._step]
        columns = (width - _FRAME[0]) * share
        rows = (height - _FRAME[1] - _WORDS - _BAR) * share
        within = CellArea(max(1, int(columns)), max(1, int(rows)), cell)
        room = area_for(*self._shape, within)
        if self._laid == (room, size):
            return
        self._laid = (room, size)
        for box in self.query(".dialog"):
            box.styles.width = min(width, max(_NARROWEST, room.columns + _FRAME[0]))
            box.styles.height = room.rows + _FRAME[1] + _WORDS
        if self._view is not None and self._watching is not None:
            self._view.place(room)
            self._watching.restart()

    # -- pictures ----------------------------------------------------------------------------

    def _request_picture(self) -> None:
        """Ask for the next picture, unless something else has the screen."""
        view, watching = self._view, self._watching
        if view is not None and watching is not None and self.is_active:
            watching.tick(view.wanted_size(watching.allowance), view.format)
        self.refreshed()

    def _draw(self, shown: PictureShown) -> None:
        view, watching = self._view, self._watching
        if view is None or watching is None or not self.is_active:
            return
        shape = (shown.camera_width, shown.camera_height)
        if min(shape) > 0 and shape != self._shape:
            self._shape = shape
            self._lay_out()
        if view.show(shown, watching.allowance):
            view.after_painting(self._painted)
        else:
            self.call_later(self._painted)

    def _painted(self) -> None:
        if self._view is not None and self._watching is not None:
            self._view.settled()
            self._watching.painted()

    def displayed(self, update: RenderableType | None) -> None:
        """What was painted over is drawn again."""
        if self._view is not None:
            self._view.displayed(update)

    def on_screen_suspend(self) -> None:
        """Another dialog has come: nobody looks, and nothing may be drawn over it."""
        self._rest()

    def closing(self) -> None:
        """Leave nothing behind."""
        self._rest()

    def _rest(self) -> None:
        if self._view is not None and self._watching is not None:
            self._view.clear()
            self._watching.restart()

    # -- words -------------------------------------------------------------------------------

    def refreshed(self) -> None:
        """Say how old the picture is."""
        for cells in self.query("#camera-words").results(Cells):
            ellipsis = self.glyphs.ellipsis
            cells.show([cut(self._words(), cells.size.width, ellipsis)])

    def _words(self) -> Row:
        watching, view = self._watching, self._view
        if watching is None or view is None:
            return ((word(REPLAY if self.state.role == "replay" else OFF), "muted"),)
        trouble = self._why_no_picture(watching)
        if watching.last is None:
            waits = say("camera.waits", "waiting for the first picture")
            return ((trouble or waits, "warn" if trouble else "muted"),)
        name: Row = ((f"{clean(watching.camera)} ", "title"),)
        age = max(0.0, (self.now - watching.last.t) / 1_000_000)
        if age > STALE_S:
            why = f" {self.glyphs.middle} {trouble}" if trouble else ""
            stale = say("camera.stale", "stale {seconds:.1f} s", seconds=age)
            return (*name, (f"{stale}{why}", "stale"))
        old = say("camera.old", "{seconds:.1f} s old", seconds=age)
        words = [old, f"{watching.rate:.1f}/s", word(view.word)]
        cameras = watching.cameras
        if len(cameras) > 1 and watching.camera in cameras:
            words.insert(0, f"{cameras.index(watching.camera) + 1}/{len(cameras)}")
        return (*name, (f" {self.glyphs.middle} ".join(words), "muted"))

    def _why_no_picture(self, watching: PictureRequester) -> str:
        """Why there are no pictures, as far as anybody knows."""
        if self.state.lost:
            return word(self.state.lost.part.sentence)
        driver = self.state.drivers.get(watching.camera)
        if driver is not None and driver.health in ("lost", "faulted"):
            told = {"camera": watching.camera, "detail": word(driver.detail)}
            why = say("camera.faulted", "{camera} is faulted: {detail}", **told)
            if driver.health == "lost":
                why = say("camera.lost", "{camera} is lost: {detail}", **told)
            return clean(why)
        return clean(word(watching.why))

    # -- keys --------------------------------------------------------------------------------

    def on_key(self, event: events.Key) -> None:
        """The next camera, another size, a file of what is seen."""
        key = _KEYS.get(event.key, event.key)
        if key not in self.own_keys or self._watching is None:
            return
        event.stop()
        if key in (_NEXT, _BACK):
            self._watching.next_camera(1 if key == _NEXT else -1)
        elif key == _TAKE:
            self._save_picture(self._watching.camera)
        else:
            larger = -1 if key == _LARGER else 1
            self._step = min(len(_SIZES) - 1, max(0, self._step + larger))
            self._lay_out()
        self.refreshed()

    def _save_picture(self, camera: str) -> None:
        """Have the driver make a file of a picture."""
        if _VERB not in self.state.verbs.get(camera, ()):
            name = camera or say("camera.this", "this camera")
            told = say("camera.no_files", "{camera} cannot save pictures", camera=name)
            self.console_app.news(told)
            return
        self.requests.ask(AskVerb(verb=_VERB, on=camera, source="key", key=_TAKE))
        told = say(
            "camera.takes", "{camera} takes a picture; the log names its file", camera=camera
        )
        self.console_app.news(told, "run")
