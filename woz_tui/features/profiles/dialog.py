"""Which profile is in use: how much of the experiment may be used."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from rich.cells import cell_len
from textual.content import Content
from textual.widgets import OptionList

from woz_tui.config.screen_language import say, word
from woz_tui.console.drawing.cells import Row, clean, fit
from woz_tui.console.screens.choice import ChoiceDialog, ListChoice
from woz_tui.features.profiles.console import EVERYTHING, profiles_of
from woz_tui.features.profiles.kinds import AskProfile
from woz_tui.protocol.sentence import Sentence

#: Cells of a profile's name at the most.
NAME = 20


class ProfileDialog(ChoiceDialog):
    """The one in use is chosen at first, so that enter after a slip changes nothing."""

    heading = Sentence("profiles.heading", "Profile")
    hint = Sentence("profiles.keys", "arrows choose · enter uses it · ctrl+q closes")

    def lines(self) -> list[Row]:
        """What a profile is; where there is none, that the file names none."""
        if profiles_of(self.state).names:
            always = say("profiles.always", "The stop, markers and notes count in each of them.")
            return [((always, "muted"),)]
        return [
            ((say("profiles.file_has_none", "The experiment file names no profiles."), "muted"),)
        ]

    def choices(self) -> Sequence[ListChoice]:
        """Everything first, then the file's; each with what it allows."""
        self._shown = profiles_of(self.state)
        self._names = self._shown.offered
        self.first = self._names.index(self._shown.current)
        return [
            ListChoice(row, partial(self._use, name))
            for row, name in zip(self._rows(), self._names, strict=True)
        ]

    def _rows(self) -> list[Content]:
        names = [clean(name or word(EVERYTHING)) for name in self._names]
        width = min(NAME, max(map(cell_len, names)))
        in_use = f"{self.glyphs.yes} {say('profiles.in_use', 'in use')}  "
        return [
            Content.assemble(
                (fit(in_use if name == self._shown.current else "", cell_len(in_use)), "bold"),
                fit(shown, width, self.glyphs.ellipsis),
                (f"  {clean(self._shown.words(name))}", "$woz-muted"),
            )
            for name, shown in zip(self._names, names, strict=True)
        ]

    def refreshed(self) -> None:
        """Somebody else may change it while the list is open: the lines stay, the mark moves."""
        known = profiles_of(self.state)
        for choices in self.query("#choices").results(OptionList):
            if known != self._shown:
                self._shown = known
                for index, row in enumerate(self._rows()):
                    choices.replace_option_prompt_at_index(index, row)

    def _use(self, name: str) -> None:
        """Ask for it, unless it is in use; a refusal is shown above the hints."""
        if name != profiles_of(self.state).current:
            self.requests.ask(AskProfile(profile=name, source="key"))
