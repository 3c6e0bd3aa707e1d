"""All keys as they are bound now."""

from __future__ import annotations

from woz_tui.config.screen_language import word
from woz_tui.console.drawing.cells import Row, clean, fit
from woz_tui.console.drawing.key_caps import KeyCap, cap_of, caption, key_name
from woz_tui.console.screens.dialog import ReportDialog
from woz_tui.console.state.wizard_overrides import OVERRIDES, is_offered

KEY = 8
#: How key caps are read; an arrow or a letter follows.
_SIGNS = (
    "^ Ctrl, A- Alt, S- Shift. * your terminal cannot send the key in the file; this one is used"
    " instead."
)


class HelpDialog(ReportDialog):
    """The stop, the console's keys, then every action; reserve keys with the reason.

    Arrow keys that move what no driver of this session has are left out.
    """

    heading = "Keys"
    hint = "arrows scroll · ctrl+q closes"
    size_class = "wide"
    indent = KEY + 2

    def lines(self) -> list[Row]:
        """Key and meaning, one a line."""
        rows: list[Row] = [((_SIGNS, "muted"),), (), (("Console", "title"),)]
        offered = {verb for verbs in self.state.verbs.values() for verb in verbs}
        bound = self.console_app.keymap.builtins
        for command in dict.fromkeys(self.console_app.commands.values()):
            if command.verb in {"", *offered}:
                whose = "for the wizard" if command.serves("wizard") else "where you only watch"
                note = "" if command.serves(self.state.role) else whose
                for key in command.keys:
                    if (found := bound.get(key.id)) is not None:
                        rows += self._key(cap_of(found), found.wanted, key.description, note)
        rows += self._by_hand()
        for panel in self.state.panels:
            locked = "  locked" if self.state.is_locked(panel) else ""
            played = clean(self.state.played_by(panel))
            note = f"{locked}  played by {played}" if played else locked
            rows += [(), ((panel.title, "title"), (note, "muted"))]
            for action in panel.actions:
                cap = self.console_app.caps.get(action.name, KeyCap(action.key))
                rows += self._key(cap, action.key, action.label, action.help)
        return rows

    def _by_hand(self) -> list[Row]:
        """Keys of the engagement model, in a session that has one."""
        if not is_offered(self.state.engaged, self.state.verbs):
            return []
        key = self.console_app.key_of("engagement")
        opens = f"after {key_name(key, self.glyphs)} and Tab" if key else ""
        rows: list[Row] = [(), (("Engagement by hand", "title"), (f"  {opens}", "muted"))]
        for order in OVERRIDES:
            text = word(order.does)
            rows.append(((fit(order.key, KEY), "strong"), (f"  {text}", "plain")))
        return rows

    def _key(self, cap: KeyCap, wanted: str, text: str, note: str) -> list[Row]:
        """Key and meaning; beneath it why it is not the key that was asked for."""
        key = fit(caption(cap, self.glyphs) or self.glyphs.dash, KEY, self.glyphs.ellipsis)
        rows: list[Row] = [((key, "strong"), (f"  {text}", "plain"), (f"  {note}", "muted"))]
        if cap.why:
            instead = "instead of " if cap.reserve else ""
            name = key_name(wanted, self.glyphs)
            rows.append(((" " * (KEY + 2), "plain"), (f"{instead}{name}: {cap.why}", "warn")))
        return rows
