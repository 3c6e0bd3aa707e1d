"""The editor's screen: keys to changes, and the move played along its time line."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable, Mapping
from contextvars import copy_context
from functools import partial
from pathlib import Path

from textual import events
from textual.app import App, ComposeResult
from textual.driver import Driver
from textual.screen import Screen

from woz_tui.config.keys.terminals import STOPS
from woz_tui.console.drawing.cells import Cells
from woz_tui.console.drawing.glyphs import UNICODE, PaintFrame
from woz_tui.console.drawing.partial_update import PartialScreen
from woz_tui.console.drawing.theme import SIXTEEN, THEMES, Appearance
from woz_tui.console.input.keyboard import Keyboard, OnPress
from woz_tui.console.link.stop_line import StopLine
from woz_tui.console.state.driver_outlines import body_outlines, outlines_of
from woz_tui.drivers.background import BackgroundTasks
from woz_tui.drivers.contract import RejectedError
from woz_tui.features.move_editor.drawing import EditorState, rows_of
from woz_tui.features.move_editor.edited_move import EMOTION, INTENSITY, EditedMove, EditError
from woz_tui.features.move_editor.hand_take import HandTake, take_name
from woz_tui.features.move_editor.mimicry import MimicError, mimicked
from woz_tui.features.move_editor.move_file import EditedFile, whole
from woz_tui.features.move_editor.preview import MovePreview
from woz_tui.features.move_editor.session_body import SessionBody
from woz_tui.motion.move_writer import WriteError, move_text
from woz_tui.motion.render_target import RenderTarget
from woz_tui.system.clock import Clock, RealClock
from woz_tui.system.tasks import end_tasks

#: Steps of the playhead, of values; seconds between two pictures while it plays.
_TICK, _FAR, _SMALL, _PICTURE_S = 0.02, 0.1, 0.1, 0.04
#: How many times the time line is enlarged at most.
_MOST_ZOOM = 32


class MoveEditorApp(App[None], inherit_bindings=False):
    """One move of one file.

    Args:
        target: The body on which it is seen.
        file: The move's file.
        look: Signs and colours for this terminal.
        clock: Plays by it.
        session: Code or socket of a session on whose body it plays, too; empty: the only one.
    """

    CSS_PATH = Path(__file__).parents[2] / "console" / "drawing" / "woz.tcss"
    ENABLE_COMMAND_PALETTE = False

    def __init__(
        self,
        target: RenderTarget,
        file: EditedFile,
        *,
        look: Appearance | None = None,
        clock: Clock | None = None,
        driver_class: type[Driver] | None = None,
        session: str | None = None,
    ) -> None:
        look = look or Appearance(UNICODE)
        super().__init__(driver_class=driver_class, ansi_color=look.theme == SIXTEEN.name or None)
        for theme in THEMES:
            self.register_theme(theme)
        self.look, self.theme = look, look.theme
        self._clock = clock or RealClock()
        self._target, self._file = target, file
        self.edited = EditedMove(file.read())
        self.preview = MovePreview(target, self.edited.move)
        outlines = body_outlines(outlines_of({target.body: target.spec.offer.outline}))
        self._outline = outlines[0] if outlines else None
        self._news = "" if self.edited.move.length else "a new move: + and - set the row's value"
        self._typed = ""
        self._piece: tuple[float, float] | None = None
        #: Where it began to play, and when; None: it does not.
        self._played: tuple[float, int] | None = None
        self._leaving = False
        self._zoom = 1
        #: The take that is made; whether it acts the row again.
        self.take: HandTake | None = None
        self._mimics = False
        stop_line = StopLine()
        #: Given to the terminal's driver: its thread sends the stop, whatever the screen does.
        self.keyboard = Keyboard(stop_line, self._clock)
        self._body = (
            None if session is None else SessionBody(session, target.body, self._tell, stop_line)
        )
        self._following: asyncio.Task[None] | None = None
        self._requests = BackgroundTasks("asking the session")
        self._screen = Cells(id="editor")
        self._keys: Mapping[str, Callable[[], object]] = self._bound()

    def get_default_screen(self) -> Screen[object]:
        """One that paints little."""
        return PartialScreen(id="_default")

    def compose(self) -> ComposeResult:
        """One widget with all rows."""
        yield self._screen

    def on_mount(self) -> None:
        """Show it, and play in pictures."""
        self.keyboard.on_pressed = self._in_loop(self._stop_pressed)
        self.keyboard.on_stale = self._in_loop(self._late)
        self.set_interval(_PICTURE_S, self.look_now)
        if self._body is not None:
            self._following = asyncio.create_task(self._body.follow(), name="edit-move session")
        self._paint()

    async def on_unmount(self) -> None:
        """What plays on a body ends."""
        await self._requests.close(0.0)
        await end_tasks(self._following)

    def _in_loop(self, call: Callable[[str, str, int], None]) -> OnPress:
        """`call`, from any thread."""
        loop, here = asyncio.get_running_loop(), copy_context()

        def pressed(chord: str, action: str, ref: int) -> None:
            with contextlib.suppress(RuntimeError):  # the loop has closed: nobody to tell
                loop.call_soon_threadsafe(call, chord, action, ref, context=here)

        return pressed

    def _tell(self, text: str) -> None:
        self._news = text
        self._paint()

    def on_cells_resized(self) -> None:
        """Draw for the new size."""
        self._paint()

    # -- keys ----------------------------------------------------------------------------------

    def _bound(self) -> dict[str, Callable[[], object]]:
        edited = self.edited
        return {
            "left": partial(edited.next_frame, -1),
            "right": partial(edited.next_frame, 1),
            "up": partial(edited.next_row, -1),
            "down": partial(edited.next_row, 1),
            ",": partial(self._move_by, -_TICK),
            ".": partial(self._move_by, _TICK),
            "shift+left": partial(self._move_by, -_FAR),
            "shift+right": partial(self._move_by, _FAR),
            "home": partial(edited.go, 0.0),
            "end": self._to_the_end,
            "+": partial(edited.step, 1.0),
            "-": partial(edited.step, -1.0),
            "=": partial(edited.step, _SMALL),
            "_": partial(edited.step, -_SMALL),
            "i": edited.insert,
            "x": edited.delete,
            "d": edited.copy,
            "<": partial(edited.shift, -_TICK),
            ">": partial(edited.shift, _TICK),
            "{": partial(edited.shift, -_TICK, ripple=True),
            "}": partial(edited.shift, _TICK, ripple=True),
            "e": edited.ease,
            "c": edited.clear,
            "m": edited.mute,
            "a": edited.share,
            "l": edited.add_layer,
            "t": edited.trim,
            "v": edited.mirror,
            "u": edited.undo,
            "ctrl+r": edited.redo,
            "[": self._from_here,
            "]": self._to_here,
            "space": self._play,
            "P": self._play_on_body,
            "R": self._release,
            "r": self._record,
            "f": self._act_again,
            "z": partial(self._enlarge, 2),
            "Z": partial(self._enlarge, -2),
            "s": self._save,
            "q": self._quit,
        }

    def on_key(self, event: events.Key) -> None:
        """Do what the key says, and show it."""
        event.stop()
        event.prevent_default()
        name = event.character if event.is_printable and event.character != " " else event.key
        self._news = ""
        leaving, self._leaving = self._leaving, False
        if event.key in STOPS:
            self.keyboard.stop(event.key)
        elif self.take is not None:
            self._perform(str(name))
        elif not self._type(str(name)):
            self._leaving = leaving and name in ("q", "s")
            self._do(self._keys.get(str(name)))
        self._shown_anew()

    def _type(self, key: str) -> bool:
        """Take a digit of an exact value, or what ends it; whether the key was one."""
        if key.isdigit() or (key == "." and self._typed):
            self._typed += key
        elif not self._typed:
            return False
        elif key == "-":
            self._typed = self._typed[1:] if self._typed[0] == "-" else f"-{self._typed}"
        elif key == "backspace":
            self._typed = self._typed[:-1].removesuffix("-")
        elif key == "enter":
            typed, self._typed = self._typed, ""
            with contextlib.suppress(ValueError):
                value = float(typed)
                self._do(partial(self.edited.enter, value))
        else:
            self._typed = ""
            return False
        return True

    def _do(self, call: Callable[[], object] | None) -> None:
        if call is None:
            return
        try:
            call()
        except EditError as error:
            self._news = str(error)

    def _move_by(self, by: float) -> None:
        self.edited.go(self.edited.place.at + by)

    def _to_the_end(self) -> None:
        self.edited.go(self.edited.move.length)

    # -- playing -------------------------------------------------------------------------------

    def _play(self) -> None:
        if self._played is not None:
            self._stop()
        elif self.edited.move.length <= 0:
            self._news = "there is nothing to play yet"
        else:
            begin, end = self._bounds()
            at = self.edited.place.at
            self._played = (at if begin <= at < end - 1e-6 else begin), self._clock.now_us()

    def _stop(self) -> None:
        """It plays no more, nothing is taken, and nothing is being typed; the editor stays."""
        if self.take is not None:
            self._news = "the take is given up"
        self._played, self._typed, self.take = None, "", None

    def _bounds(self) -> tuple[float, float]:
        return self._piece or (0.0, self.edited.move.length)

    def look_now(self) -> None:
        """The next picture of what plays, or is taken."""
        if self.take is not None:
            self._go_on_taking(self.take)
            return
        if self._played is None:
            return
        began, since = self._played
        at = began + (self._clock.now_us() - since) / 1_000_000 * self.preview.pace
        begin, end = self._bounds()
        if at >= end:
            at = begin if self._piece is not None else end
            self._played = (begin, self._clock.now_us()) if self._piece is not None else None
        self.edited.go(at)
        self._paint()

    def _from_here(self) -> None:
        self._set_piece(self.edited.place.at, self._bounds()[1])

    def _to_here(self) -> None:
        self._set_piece(self._bounds()[0], self.edited.place.at)

    def _set_piece(self, begin: float, end: float) -> None:
        whole = begin <= 0 and end >= self.edited.move.length
        self._piece = None if whole or end - begin < _FAR else (begin, end)
        if self._piece is None:
            self._news = "all of it is played"

    def _enlarge(self, by: int) -> None:
        """The time line twice as large, or half."""
        zoom = self._zoom * 2 if by > 0 else self._zoom // 2
        self._zoom = min(_MOST_ZOOM, max(1, zoom))

    # -- on the body of a session --------------------------------------------------------------

    def _play_on_body(self) -> None:
        if self._body is None:
            self._news = "no session: woz edit-move FILE --robot FILE --session plays on its body"
        elif self.edited.move.length <= 0:
            self._news = "there is nothing to play yet"
        else:
            # Sounds of a move are named from its file: from the root on there they are whole.
            self._requests.start(self._body.play(move_text(whole(self.edited.move), Path("/"))))

    def _stop_pressed(self, chord: str, action: str, sent: int) -> None:
        """A stop key, which has been sent to the session if it could be."""
        self._news, self._leaving = "", False
        self._stop()
        if self._body is not None:
            self._news = "stop"
            if not sent:
                self._requests.start(self._body.stop())
        self._shown_anew()

    def _late(self, chord: str, action: str, sent: int) -> None:
        self._tell(f"{chord} came too late, or with many keys at once: nothing is done by it")

    def _release(self) -> None:
        if self._body is not None:
            self._requests.start(self._body.release())

    # -- takes -----------------------------------------------------------------------------------

    def _record(self) -> None:
        """A take onto a new layer."""
        self._begin_take(take_name(self.edited.move), mimics=False)

    def _act_again(self) -> None:
        """The row of the hand acted again, which changes its size and place."""
        if self.edited.row in (EMOTION, INTENSITY):
            self._news = "a role or a joint can be acted again"
        elif self.edited.layer.length <= 0:
            self._news = "there is nothing to act again in this layer yet"
        else:
            self._begin_take(self.edited.layer.name, mimics=True)

    def _begin_take(self, layer: str, *, mimics: bool) -> None:
        self._played = None
        shape = self._target.spec.settings
        self.take = HandTake(shape, self.edited.move, layer, self._seconds)
        self._mimics = mimics

    def _seconds(self) -> float:
        return self._clock.now_us() / 1_000_000

    def _go_on_taking(self, take: HandTake) -> None:
        try:
            over = take.go_on()
        except RejectedError as refused:
            self.take, self._news = None, f"the take cannot begin: {refused.what}"
            over = False
        if over:
            self._end_take(take)
        self.edited.go(take.place * self.preview.tempo)
        self._shown_anew()

    def _perform(self, key: str) -> None:
        take = self.take
        assert take is not None
        if key in ("space", "enter"):
            take.go_on()
            self._end_take(take)
        else:
            take.press(key)

    def _end_take(self, take: HandTake) -> None:
        self.take = None
        layer = take.taken(trim=not self._mimics)
        if layer is None:
            self._news = "this take has no movement"
        elif not self._mimics:
            self.edited.add(layer)
            self._news = f"taken as {layer.name}"
        else:
            row = self.edited.row
            try:
                changed, fit = mimicked(
                    self.edited.layer, row, layer, self._bounds(), self._target.spec.settings
                )
            except MimicError as error:
                self._news = str(error)
                return
            self.edited.put(changed)
            self._news = f"{row} as you did it: {fit}"

    # -- the file ------------------------------------------------------------------------------

    def _save(self) -> None:
        try:
            self._news = self._file.save(self.edited.move)
        except WriteError as error:
            self._news = f"not saved: {error.what}"
            return
        if self._file.written:
            self.edited.saved()

    def _quit(self) -> None:
        if self.edited.unsaved and not self._leaving:
            self._leaving = True
            self._news = "not saved: s saves it, q once more leaves it as it was"
            return
        self.exit()

    # -- what is shown -------------------------------------------------------------------------

    def _shown_anew(self) -> None:
        if self.preview.move != self.edited.move:
            self.preview = MovePreview(self._target, self.edited.move)
            self._file.keep(self.edited.move)
        self._paint()

    def _paint(self) -> None:
        width, height = self._screen.size
        take = self.take
        state = EditorState(
            self._file.path.name,
            self._news if take is None else take.said,
            self._typed,
            self._piece,
            self._played is not None,
            self._zoom,
            None if take is None else take.tick,
            () if take is None else tuple(take.help((width or 80) - 2)),
        )
        frame = PaintFrame(width or 80, height or 24, 0, self.look.glyphs)
        self._screen.show(rows_of(self.edited, self.preview, self._outline, state, frame))
