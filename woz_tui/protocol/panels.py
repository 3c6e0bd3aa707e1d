"""The experiment as a console sees it: panels with their actions."""

from __future__ import annotations

from collections.abc import Iterable

import msgspec

#: The title of the panel of sentences that a wizard has typed.
TYPED = "Typed"
#: Begins the name of an action that is one of these: the sentence comes behind it.
TYPED_NAME = "typed: "


class ActionView(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """An action as the console shows it; `key` is the chord as the experiment file has it, in the
    normal form of `woz_tui.config.keys`; `verbs` what it does, for icons and search; `then`
    names actions that are likely to follow; `without` verbs that this robot does not do of it;
    `slots` of its sentences. `code`: of which sentence of ours the label is; empty: the file's own.
    """

    name: str
    label: str
    key: str = ""
    help: str = ""
    verbs: list[str] = []
    utterances: list[str] = []
    locked: bool = False
    then: list[str] = []
    without: list[str] = []
    slots: list[str] = []
    code: str = ""


def covers_verb(covers: Iterable[str], verb: str, driver: str = "") -> bool:
    """Whether one of `covers` means this verb of this driver: `gaze` that of every robot,
    `left.gaze` that of one robot or driver. An empty `driver`: of any.
    """
    for each in covers:
        whose, _, name = each.rpartition(".")
        if name == verb and (not whose or not driver or f"{driver}.".startswith(f"{whose}.")):
            return True
    return False


class PanelView(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """A panel as the console shows it; while it is locked the verbs in `covers` are, too. `parts`:
    one of which a wizard has to play to use it, where several wizards play.
    """

    title: str
    actions: list[ActionView]
    locked: bool = False
    covers: list[str] = []
    parts: list[str] = []


class PhaseView(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """A phase of the experiment: the panels that are in front in it (none: all), the lines of its
    own script (none: the file's script goes on). It may begin once one of `after` has begun in the
    trial (none: at any time). `planned` in seconds (0: nobody said). `lock_others`: panels that
    only other phases have in front are locked.
    """

    name: str
    title: str = ""
    panels: list[str] = []
    script: list[str] = []
    after: list[str] = []
    planned: float = 0.0
    lock_others: bool = False

    @property
    def heading(self) -> str:
        """Its title, or its name."""
        return self.title or self.name
