"""Type something and have the robot say it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rich.cells import cell_len
from textual.widgets import Static

from woz_tui.config.screen_language import say, word
from woz_tui.config.utterance_template import HIDDEN_TEXT
from woz_tui.console.drawing.cells import Row, clean, fit
from woz_tui.console.robot_settings.completion import (
    NumberEntry,
    PartialTag,
    TagOffer,
    completed,
    partial_tag,
    tag_offers,
)
from woz_tui.console.screens.dialog import (
    Completion,
    CompletionDialog,
    content,
    plain,
)
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.protocol.robot_outline import RobotOutline
from woz_tui.protocol.sentence import Sentence

#: Lines of matching utterances under the field, and of matching tags or animations.
MATCHES, TAGS = 5, 9


def complete(text: str, utterances: Iterable[str], variables: Iterable[str]) -> str | None:
    """What `text` may become: a variable after an open brace, else an utterance it begins."""
    brace = text.rfind("{")
    if brace > text.rfind("}"):
        begun = text[brace + 1 :]
        for name in sorted(variables):
            if name.startswith(begun):
                return f"{text[: brace + 1]}{name}}}"
        return None
    if not text:
        return None
    folded = text.casefold()
    for utterance in utterances:
        if utterance.casefold().startswith(folded) and len(utterance) > len(text):
            return text + utterance[len(text) :]
    return None


def utterances_of(state: ConsoleState, said: Iterable[str]) -> list[str]:
    """What was typed before, newest first, then all the session's utterances."""
    told = [
        utterance
        for panel in state.panels
        for action in panel.actions
        for utterance in action.utterances or [state.sentence(action.name)]
        if utterance and utterance != HIDDEN_TEXT
    ]
    return list(dict.fromkeys([*reversed(list(said)), *told]))


class SayDialog(CompletionDialog):
    """Type and say: arrows walk through what was said, tab completes, ctrl+o changes the voice."""

    heading = Sentence("say.heading", "Say")
    hint = Sentence("say.hint", "enter says it · tab completes · arrows: history · ctrl+q closes")
    placeholder = Sentence("say.type", "type what the robot shall say; {{ for variables")
    _WITH_TAGS = Sentence(
        "say.type_tags", "type what the robot shall say; {{ for variables, \\ and ^ for tags"
    )

    verb, word = "say", Sentence("say.voice", "voice")

    def __init__(self) -> None:
        super().__init__()
        self._utterances: list[str] = []
        self._numbered: NumberEntry | None = None

    def on_mount(self) -> None:
        """Utterances as they are now."""
        if not self.there:
            return
        self._utterances = utterances_of(self.state, self.requests.history)
        self.entry.suggester = Completion(self._suggest)
        self.watch(self.entry, "selection", self._show_matches, init=False)  # the caret

    def adopt(self) -> None:
        """The tags of this voice."""
        if not self.robot:
            nobody = say("say.nobody", "No driver of this session can speak.")
            self.update("robot", plain(nobody))
        self.entry.placeholder = word(self._WITH_TAGS if self._outline.tags else self.placeholder)
        self._show_matches()

    @property
    def _outline(self) -> RobotOutline:
        """Of the robot that speaks; an empty one where it tells of none."""
        return self.state.robot_outlines.get(self.robot) or RobotOutline()

    def _offers(self, text: str, caret: int) -> tuple[PartialTag | None, list[TagOffer]]:
        """The tag that is being typed, and what it may become."""
        outline = self._outline
        begun = partial_tag(text, caret) if outline.tags else None
        return begun, tag_offers(begun, outline) if begun is not None else []

    def _show_matches(self) -> None:
        entry = self.entry
        begun, offered = self._offers(entry.value, entry.cursor_position)
        if begun is None:
            folded = entry.value.casefold().strip()
            matches = [text for text in self._utterances if folded in text.casefold()][:MATCHES]
            self._show(
                [((f"  {clean(text)}", "muted"),) for text in matches if text != entry.value]
            )
            return
        shown = offered[:TAGS]
        wide = max((cell_len(clean(offer.text)) for offer in shown), default=0)
        rows: list[Row] = [
            ((f"  {fit(offer.text, wide)}", "plain"), (f"  {clean(offer.help)}", "muted"))
            for offer in shown
        ]
        if len(offered) > TAGS:
            more = say("say.more", "{count} more", count=len(offered) - TAGS)
            rows.append(((f"  {self.glyphs.ellipsis} {more}", "muted"),))
        nothing = say("say.no_tag", "not a tag of this robot")
        self._show(rows or [((f"  {nothing}", "muted"),)])

    def _show(self, rows: list[Row]) -> None:
        matches_widget = self.query_one("#matches", Static)
        matches_widget.update(content(rows))
        matches_widget.display = bool(rows)

    def _suggest(self, typed: str) -> str | None:
        whole, _ = self.completed(typed, len(typed))
        return whole if whole is not None and whole.startswith(typed) else None

    def changed(self, typed: str) -> None:
        """Show what matches; digits behind a tag that tab has put in are its number."""
        entry, before = self.entry, self._numbered
        self._numbered = before.goes_on(entry.value) if before is not None else None
        if self._numbered is not None and self._numbered.text != entry.value:
            self.set_text(self._numbered.text, self._numbered.caret)
        self._show_matches()

    def submit(self, text: str) -> None:
        voice = "" if self.robots == [self.robot] else self.robot
        self.requests.say(text, voice, self.console_app.key_of("say"))

    def action_complete(self) -> None:
        begun, _ = self._offers(self.entry.value, self.entry.cursor_position)
        whole, caret = self.completed(self.entry.value, self.entry.cursor_position)
        if whole is not None:
            self.set_text(whole, caret)
            self._numbered = NumberEntry.put_in(whole, begun, caret) if begun is not None else None

    def completed(self, text: str, caret: int) -> tuple[str | None, int]:
        """What the text becomes by tab, and where the caret is then; None: it stays."""
        begun, offered = self._offers(text, caret)
        if begun is not None:
            return completed(text, begun, offered[0]) if offered else (None, caret)
        whole = complete(text, self._utterances, self.state.plan.variables)
        return whole, len(whole or "")

    @property
    def history(self) -> Sequence[str]:
        return self.requests.history
