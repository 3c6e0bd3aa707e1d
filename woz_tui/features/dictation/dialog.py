"""The field of `say` that takes what the wizard dictates, as long as it is open."""

from __future__ import annotations

from collections.abc import Iterable

from rich.cells import cell_len
from textual.widget import Widget
from textual.widgets import Static

from woz_tui.config.screen_language import say
from woz_tui.console.drawing.cells import Row
from woz_tui.console.screens.dialog import content, plain, refusal_text
from woz_tui.console.screens.say import SayDialog
from woz_tui.features.dictation.console import is_attached
from woz_tui.features.dictation.history import DictationHistory
from woz_tui.features.dictation.kinds import AskDictation
from woz_tui.features.dictation.notes import DictatedTexts
from woz_tui.protocol.requests import Reply
from woz_tui.protocol.sentence import Sentence

#: So often it says that it is open, in microseconds: a screen that does not paint any more, or has
#: lost its terminal, says nothing.
_SAID_US = 500_000
#: Enter says nothing while what was dictated last has stood there for less time, in microseconds:
#: nobody has read it.
SETTLE_US = 300_000


class DictationDialog(SayDialog):
    """What is dictated stands there as if it were typed; enter says it."""

    heading = Sentence("dictation.heading", "Say (dictated)")
    placeholder = Sentence("dictation.speak", "speak, or type what the robot shall say")

    def __init__(self) -> None:
        super().__init__()
        #: When it said last that it is open, and whether that was taken.
        self._said_us: int | None = None
        self._opened = False
        #: When a text came last.
        self._came_us: int | None = None
        self._refused = ""
        self._shown: Row = ()
        self._whole = ""

    @property
    def draft(self) -> str:
        """The same as of the field without dictation."""
        return SayDialog.__name__

    def below(self) -> Iterable[Widget]:
        """Whether anybody listens comes first, then the text, where the field is too short."""
        yield Static("", id="listens", classes="caption")
        whole = Static("", id="whole", classes="caption")
        whole.display = False
        yield whole
        yield from super().below()

    def on_mount(self) -> None:
        """With what came before it was opened."""
        super().on_mount()
        self._go_on()

    def refreshed(self) -> None:
        """With what has come since."""
        super().refreshed()
        self._go_on()

    def closing(self) -> None:
        super().closing()
        self.requests.ask(AskDictation(on=False))

    def changed(self, typed: str) -> None:
        super().changed(typed)
        self._show_whole()

    def _show_whole(self) -> None:
        """All of a text that the field is too short for: nobody says what she cannot read."""
        value = self.entry.value
        text = value if cell_len(value) >= self.entry.content_size.width > 0 else ""
        if text != self._whole:
            self._whole = text
            for whole in self.query("#whole").results(Static):
                whole.display = bool(text)
                whole.update(plain(text))

    def accept(self, typed: str) -> None:
        """Unless a text came just before enter was pressed."""
        came, now = self._came_us, self.console_app.clock.now_us()
        if came is None or now - came >= SETTLE_US:
            super().accept(typed)
            return
        just = say("dictation.just_came", "Not said: a text had only just come; press enter again")
        self.console_app.news(just, "warn")

    def _go_on(self) -> None:
        if not self.there or not self.is_on_top:
            return
        if self._is_stopped:
            self.console_app.close_dialog(self)
            return
        now = self.console_app.clock.now_us()
        due = self._said_us is None or now - self._said_us >= _SAID_US
        feed = self.console_app.feed
        if due and feed.line_ok and feed.attached:
            self._said_us = now
            self.requests.ask(AskDictation(on=True, again=self._opened), self._answered)
        self._take()
        self._show_whole()
        if (row := self._listens()) != self._shown:
            self._shown = row
            self.update("listens", content([row]))

    def _answered(self, reply: Reply) -> None:
        if self._opened and not reply.ok:  # it was silent for too long, and opens anew
            self._said_us = None
        else:
            self._refused = "" if reply.ok else refusal_text(reply)
        self._opened = reply.ok or self._is_stopped

    @property
    def _is_stopped(self) -> bool:
        """Whether a stop has closed it: somebody else's, since one from here closes the dialog."""
        return self._opened and self.state.session.history(DictationHistory).closed == "stop"

    def _listens(self) -> Row:
        """Whether what is said now comes here, and else what would help."""
        state = self.state
        if self._refused:
            return ((self._refused, "warn"),)
        if not is_attached(state):
            nobody = say(
                "dictation.nobody",
                "nothing is heard: at your own computer, type  arecord -q -t raw -f S16_LE"
                " -r 16000 -c 1 | ssh ROBOT woz dictate --experiment FILE",
            )
            return ((nobody, "warn"),)
        notes = state.study.notes.of(DictatedTexts)
        if notes is None or notes.listens != state.console:
            return ((say("dictation.waits", "begins to listen"), "muted"),)
        return ((say("dictation.listens", "listens: what you say comes here"), "good"),)

    def _take(self) -> None:
        """Each once, also where the line to the robot was lost meanwhile. What comes while another
        console has the field is meant for that one.
        """
        notes, drafts = self.state.study.notes.of(DictatedTexts), self.requests.drafts
        place = f"dictated {self.state.log}"
        texts = notes.after(int(drafts.get(place, "0"))) if notes is not None else {}
        if texts:
            drafts[place] = str(max(texts))
        if texts and notes is not None and notes.listens in ("", self.state.console):
            self._came_us = self.console_app.clock.now_us()
            new = " ".join(texts.values()).replace("{", "{{").replace("}", "}}")
            self.set_text(f"{self.entry.value.rstrip()} {new}".lstrip())
