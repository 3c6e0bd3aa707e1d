"""Profiles: what a wizard may use, for those who shall not have everything before them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from woz_tui.config.annotated_decoder import names_of, read_partly
from woz_tui.config.experiment import Panel, Profile, ProfileEntry
from woz_tui.config.problems import quoted
from woz_tui.config.yaml_cursor import Cursor, texts_of
from woz_tui.drivers.contract import Verb

#: What a profile may say.
FIELDS = names_of(ProfileEntry)
#: The verb that turns a knob; its first argument's choices are all controls there are.
CONTROL = "control"


@dataclass(frozen=True, slots=True)
class ProfileTargets:
    """Everything that a profile can name.

    `complete`: the robot files are right. Else a driver is missing here, and what only it knows
    must not be called unknown: that would hide the mistake that is there.
    """

    panels: Sequence[str]
    actions: Sequence[str]
    controls: Sequence[str]
    verbs: Sequence[str]
    complete: bool = True

    @classmethod
    def of(
        cls, panels: Iterable[Panel], verbs: Iterable[Verb], *, complete: bool = True
    ) -> ProfileTargets:
        """Of these panels and of the verbs of all drivers."""
        offered, rows = [*verbs], [*panels]
        controls = [
            choice
            for verb in offered
            if verb.name == CONTROL and verb.arguments
            for choice in verb.arguments[0].choices
        ]
        return cls(
            [panel.title for panel in rows],
            [action.name for panel in rows for action in panel.actions],
            [*dict.fromkeys(controls)],
            [*dict.fromkeys(verb.name for verb in offered)],
            complete,
        )


def read_profiles(cursor: Cursor | None, known: ProfileTargets) -> dict[str, Profile]:
    """The section `profiles`: profiles by name. What is wrong is reported where it stands."""
    table = cursor.table("a mapping of profiles by name") if cursor is not None else None
    return {
        name: profile
        for name, entry in (table or {}).items()
        if (profile := _profile(name, entry, known)) is not None
    }


def _profile(name: str, cursor: Cursor, known: ProfileTargets) -> Profile | None:
    profile = read_partly(cursor, Profile, name=name)
    if profile is None:
        return None
    if not name.strip():
        cursor.error("a profile needs a name")
    table = dict(cursor.entries())
    for field, there, what in (
        ("panels", known.panels, "there is no panel"),
        ("actions", known.actions, "there is no action"),
        ("controls", known.controls, "no body has a control"),
        ("verbs", known.verbs, "no driver offers"),
    ):
        for entry, word in texts_of(table.get(field)):
            if word not in there and (known.complete or field in ("panels", "actions")):
                near = entry.report.hint(word, there, or_list="there are")
                entry.error(f"{what} {quoted(word)}{near}")
    if not any(field in table for field in FIELDS[:-1]):
        cursor.error(f"allows nothing; name some of {', '.join(FIELDS[:-1])}")
    return profile
