"""Looks up, renames and forgets visitors, with their faces on this machine.

A name is in the store of visitors, and may be in the store of faces, too; a label of a face is
another name that a recogniser has for somebody.
"""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from dataclasses import dataclass

from msgspec.structs import asdict

from woz_tui.config.visitor_names import key_of, quoted_name
from woz_tui.drivers.face_store import FaceStore
from woz_tui.protocol.messages import Json
from woz_tui.sensing.visitor_store import (
    UnsavedError,
    Visitor,
    VisitorRefusedError,
    VisitorsError,
    VisitorStore,
)


def as_json(visitor: Visitor) -> dict[str, Json]:
    """All that is kept of a visitor, for programs."""
    return {**asdict(visitor), "labels": list(visitor.labels)}


def visitor_named(store: VisitorStore, name: str) -> Visitor:
    """The visitor of this name, in any letter case. Raises `VisitorRefusedError` with names that
    are like it.
    """
    if found := store.find(name):
        return found
    names = {key_of(visitor.name): visitor.name for visitor in store.everybody()}
    similar = [names[key] for key in difflib.get_close_matches(key_of(name), names)]
    remedy = (
        f"did you mean {' or '.join(similar)}?" if similar else "list all with: woz visitors list"
    )
    raise VisitorRefusedError(f"{store.path}: there is no visitor {quoted_name(name)}", remedy)


def renamed(store: VisitorStore, faces: FaceStore, visitor: Visitor, name: str) -> Visitor:
    """The visitor under another name; a face that is kept under the old one becomes a label."""
    known = {key_of(face.name) for face in faces.faces()}
    label = visitor.name if key_of(visitor.name) in known else None
    return store.rename(visitor.name, name, label=label)


@dataclass(frozen=True, slots=True)
class Forgetting:
    """Who is to be forgotten: visitors of the store, and faces, by their names there."""

    store: VisitorStore
    face_store: FaceStore
    visitors: list[Visitor]
    faces: list[str]

    @classmethod
    def of(
        cls, store: VisitorStore, face_store: FaceStore, names: Sequence[str] | None
    ) -> Forgetting:
        """Of these names; None: of everybody. Raises `VisitorRefusedError`."""
        kept = [face.name for face in face_store.faces()]
        if names is not None:
            named = {key_of(name) for name in names}
            faces = [face for face in kept if key_of(face) in named]
            rest = [name for name in names if key_of(name) not in map(key_of, faces)]
            visitors = [visitor_named(store, name) for name in rest]
            visitors += [one for face in faces if (one := store.find(face)) is not None]
            visitors = list(dict.fromkeys(visitors))
        else:
            visitors, faces = store.everybody(), kept
        labels = {key_of(label) for visitor in visitors for label in visitor.labels}
        faces += [face for face in kept if key_of(face) in labels and face not in faces]
        return cls(store, face_store, visitors, faces)

    def carry_out(self) -> list[str]:
        """Forget them all; the names of the faces that were there. Raises `VisitorsError`."""
        # The face first: if something fails it is the name that is left to try again with.
        gone = self.face_store.forget(self.faces)
        try:
            if self.visitors:
                self.store.forget(*(visitor.name for visitor in self.visitors))
        except UnsavedError as error:
            if not gone:
                raise
            names = ", ".join(visitor.name for visitor in self.visitors)
            raise VisitorsError(
                f"{error.reason}; deleted faces: {', '.join(gone)}; still stored: {names}",
                f"{error.remedy}, then repeat the command",
            ) from None
        return gone

    def left(self, gone: Sequence[str]) -> list[str]:
        """Labels of theirs under which a recogniser may still know them."""
        labels = [label for visitor in self.visitors for label in visitor.labels]
        return [label for label in labels if key_of(label) not in map(key_of, gone)]
