"""All keys as they are bound now."""

from __future__ import annotations

from woz_tui.config.screen_language import say, word
from woz_tui.console.drawing.cells import Row, clean, fit
from woz_tui.console.drawing.key_caps import KeyCap, cap_of, caption, key_name
from woz_tui.console.screens.dialog import ConsoleCommand, ReportDialog
from woz_tui.console.state.wizard_overrides import OVERRIDES, is_offered
from woz_tui.protocol.sentence import Sentence

KEY = 8
#: How key caps are read; an arrow or a letter follows.
_SIGNS = Sentence(
    "help.signs",
    "^ Ctrl, A- Alt, S- Shift. * your terminal cannot send the key in the file; this one is used"
    " instead.",
)


class HelpDialog(ReportDialog):
    """The stop, the console's keys, then every action; reserve keys with the reason.

    Arrow keys that move what no driver of this session has are left out.
    """

    heading: str = Sentence("help.heading", "Keys")
    hint = Sentence("dialog.scroll", "arrows scroll · ctrl+q closes")
    size_class = "wide"
    indent = KEY + 2

    def lines(self) -> list[Row]:
        """Key and meaning, one a line."""
        console = say("help.console", "Console")
        rows: list[Row] = [((word(_SIGNS), "muted"),), (), ((console, "title"),)]
        offered = {verb for verbs in self.state.verbs.values() for verb in verbs}
        bound = self.console_app.keymap.builtins
        for command in dict.fromkeys(self.console_app.commands.values()):
            if command.verb in {"", *offered}:
                note = "" if command.serves(self.state.role) else self._whose(command)
                for key in command.keys:
                    if (found := bound.get(key.id)) is not None:
                        rows += self._key(cap_of(found), found.wanted, word(key.description), note)
        rows += self._by_hand()
        for panel in self.state.panels:
            note = f"  {say('help.locked', 'locked')}" if self.state.is_locked(panel) else ""
            if played := clean(self.state.played_by(panel)):
                note += f"  {say('help.played_by', 'played by {part}', part=played)}"
            rows += [(), ((self.state.title(panel), "title"), (note, "muted"))]
            for action in panel.actions:
                cap = self.console_app.caps.get(action.name, KeyCap(action.key))
                rows += self._key(cap, action.key, action.label, action.help)
        return rows

    def _whose(self, command: ConsoleCommand) -> str:
        """For whom it is, where it is not for whoever looks."""
        if command.serves("wizard"):
            return say("help.for_wizard", "for the wizard")
        return say("help.for_watcher", "where you only watch")

    def _by_hand(self) -> list[Row]:
        """Keys of the engagement model, in a session that has one."""
        if not is_offered(self.state.engaged, self.state.verbs):
            return []
        key = self.console_app.key_of("engagement")
        opens = ""
        if key:
            opens = say("help.opens_hand", "after {key} and Tab", key=key_name(key, self.glyphs))
        title = say("help.by_hand", "Engagement by hand")
        rows: list[Row] = [(), ((title, "title"), (f"  {opens}", "muted"))]
        for order in OVERRIDES:
            text = word(order.does)
            rows.append(((fit(order.key, KEY), "strong"), (f"  {text}", "plain")))
        return rows

    def _key(self, cap: KeyCap, wanted: str, text: str, note: str) -> list[Row]:
        """Key and meaning; beneath it why it is not the key that was asked for."""
        key = fit(caption(cap, self.glyphs) or self.glyphs.dash, KEY, self.glyphs.ellipsis)
        rows: list[Row] = [((key, "strong"), (f"  {text}", "plain"), (f"  {note}", "muted"))]
        if cap.why:
            name = key_name(wanted, self.glyphs)
            told = f"{name}: {word(cap.why)}"
            if cap.reserve:
                told = say("help.instead", "instead of {key}: {why}", key=name, why=word(cap.why))
            rows.append(((" " * (KEY + 2), "plain"), (told, "warn")))
        return rows
