"""Where each proposal stands on the screen: it keeps its place until it ends."""

from __future__ import annotations

from typing import NamedTuple

from woz_tui.console.state.feature_notes import FeatureNotes, StudyNews
from woz_tui.features.proposals.history import ProposalHistory
from woz_tui.features.proposals.kinds import (
    ProposedItem,
    SuggestGone,
    SuggestOffered,
    SuggestTaken,
)
from woz_tui.timeline.session_state import SessionState

#: Places, each with a key.
PLACES = 3


class ShownItem(NamedTuple):
    """An item of a set that is offered."""

    offered: SuggestOffered
    item: ProposedItem


class ShownProposals(FeatureNotes):
    """The item at each place; one that comes while all are taken waits for an empty one."""

    hears = (SuggestOffered, SuggestTaken, SuggestGone)

    def __init__(self, session: SessionState) -> None:
        super().__init__(session)
        self.places: list[ShownItem | None] = [None] * PLACES
        #: What this console has told of, by set and item.
        self.told: set[tuple[str, str]] = set()

    def apply(self, message: SuggestOffered | SuggestTaken | SuggestGone) -> StudyNews | None:
        self.follow()
        return None

    def follow(self) -> None:
        """Nothing that stays moves."""
        sets = self.session.history(ProposalHistory).sets
        self.told = {(name, item) for name, item in self.told if name in sets}
        for place, shown in enumerate(self.places):
            if shown is not None and shown.offered.set not in sets:
                self.places[place] = None
        there = {(shown.offered.set, shown.item.id) for shown in self.places if shown is not None}
        coming = [
            ShownItem(each.offered, item)
            for each in sets.values()
            for item in each.offered.items
            if (each.offered.set, item.id) not in there and each.offered.source != "logs"
        ]
        for place, shown in enumerate(self.places):
            if shown is None and coming:
                self.places[place] = coming.pop(0)

    def settle(self, rows: int) -> None:
        """Give what has no row on this screen an empty one: nobody has seen it move."""
        for place in range(rows, PLACES):
            if self.places[place] is not None and None in self.places[:rows]:
                self.places[self.places.index(None)] = self.places[place]
                self.places[place] = None
