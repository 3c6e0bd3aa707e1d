"""The sentence of the script's next line, said otherwise this once."""

from __future__ import annotations

from woz_tui.config.screen_language import say, word
from woz_tui.config.utterance_template import HIDDEN_TEXT
from woz_tui.console.drawing.cells import clean
from woz_tui.console.screens.dialog import ConsoleApp, EntryDialog
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.widgets.bottom_rows import KEPT
from woz_tui.features.scripts.kinds import AskScript
from woz_tui.features.scripts.shown_script import shown_script
from woz_tui.protocol.sentence import Sentence


def open_edit(app: ConsoleApp) -> None:
    """Edit the sentence of the script's next line, if it has one that may be seen."""
    name = shown_script(app.state).next
    said = next((call.args["text"] for call in app.state.calls(name) if call.verb == "say"), "")
    if not name:
        app.news(say("scripts.no_next", "The script has no next line"))
    elif not said:
        label = app.state.label(name)
        app.news(
            say(
                "scripts.says_nothing",
                "{label} says nothing: there is nothing to edit",
                label=label,
            )
        )
    elif HIDDEN_TEXT in (said, app.state.sentence(name)):
        app.news(word(KEPT))
    else:
        app.open_dialog(EditLineDialog(app.state, str(said)))


class EditLineDialog(EntryDialog):
    """The sentence of the script's next line, to be said otherwise this once.

    What was typed is a draft of this line alone; the box closes when another line is the next.
    """

    hint = Sentence(
        "scripts.edit_keys", "enter says it so, once; the file is not changed · ctrl+q closes"
    )
    size_class = "wide"

    def __init__(self, state: ConsoleState, sentence: str) -> None:
        super().__init__()
        label = clean(state.label(shown_script(state).next))
        self.heading = say("scripts.edit", "Edit: {label}", label=label)
        self._line = _place(state)
        self._sentence = sentence

    @property
    def draft(self) -> str:
        """Of this line and this sentence."""
        return f"{type(self).__name__} {self._line} {self._sentence}"

    def on_mount(self) -> None:
        """The sentence as the file has it, unless another one was begun."""
        super().on_mount()
        if self.there and not self.entry.value:
            self.set_text(self._sentence)

    def refreshed(self) -> None:
        """Another line is the next: this one has been played, or left out."""
        if _place(self.state) != self._line:
            self.leave()

    def submit(self, text: str) -> None:
        """Play the line; where nothing was changed, as it stands in the file."""
        new = "" if text == self._sentence else text
        key = self.console_app.key_of("script_edit")
        self.requests.ask(AskScript(to=self._line[1], text=new, key=key))


def _place(state: ConsoleState) -> tuple[str, int]:
    """Which script is played, and its next line."""
    script = shown_script(state)
    return script.name, script.position
