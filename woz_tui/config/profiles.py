"""Profiles: what a wizard may use, for those who shall not have everything before them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from woz_tui.config.experiment import Panel, Profile
from woz_tui.config.problems import quoted
from woz_tui.config.yaml_cursor import Cursor, is_set, read_texts
from woz_tui.drivers.contract import Verb

#: What a profile may say.
FIELDS = ("panels", "actions", "controls", "verbs", "hide")
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
    table = cursor.fields(FIELDS, "a profile has", "a mapping, such as {panels: [Speech]}")
    if table is None:
        return None
    if not name.strip():
        cursor.error("a profile needs a name")

    def names(field: str, there: Sequence[str], what: Callable[[str], str]) -> frozenset[str]:
        surely = known.complete or field in ("panels", "actions")
        return frozenset(_names(table.get(field), there, what if surely else None))

    profile = Profile(
        name=name,
        panels=names("panels", known.panels, lambda n: f"there is no panel {n}"),
        actions=names("actions", known.actions, lambda n: f"there is no action {n}"),
        controls=names("controls", known.controls, lambda n: f"no body has a control {n}"),
        verbs=names("verbs", known.verbs, lambda n: f"no driver offers {n}"),
        hide=is_set(table.get("hide")),
    )
    if not any(field in table for field in FIELDS[:-1]):
        cursor.error(f"allows nothing; name some of {', '.join(FIELDS[:-1])}")
    return profile


def _names(
    cursor: Cursor | None, there: Sequence[str], unknown: Callable[[str], str] | None
) -> Iterable[str]:
    """A list of names; those that are not `there` are `unknown`, if that can be said."""
    for entry, name in read_texts(cursor, "a list of names"):
        if unknown is not None and name not in there:
            near = entry.report.hint(name, there, or_list="there are")
            entry.error(f"{unknown(quoted(name))}{near}")
        yield name
