"""Profiles: what a wizard may use, for those who shall not have everything before them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any

from woz_tui.config.annotated_decoder import names_of, read_partly
from woz_tui.config.experiment import Action, Experiment
from woz_tui.config.feature_section import FeatureSection, FileContents
from woz_tui.config.problems import quoted
from woz_tui.config.reload_changes import changed_entries
from woz_tui.config.yaml_cursor import Cursor, texts_of
from woz_tui.drivers.fields import Doc, Entry, ReadApart

#: The verb that turns a knob; its first argument's choices are all controls there are.
CONTROL = "control"


@dataclass(frozen=True, slots=True)
class ProfileEntry(Entry):
    """What a wizard may use: actions of these panels and these actions; by themselves (from keys of
    the console, the palette, a control panel, a program) these verbs and controls.

    `hide`: what may not be used is not even shown.
    """

    what = "a profile"
    example = "{panels: [Speech]}"
    panels: Annotated[frozenset[str], Doc("panels that can be used")] = frozenset()
    actions: Annotated[frozenset[str], Doc("actions that can be used")] = frozenset()
    controls: Annotated[frozenset[str], Doc("controls that can be used")] = frozenset()
    verbs: Annotated[frozenset[str], Doc("verbs that can be used")] = frozenset()
    hide: Annotated[bool, Doc("hide what cannot be used")] = False


@dataclass(frozen=True, slots=True)
class Profile(ProfileEntry):
    """A profile with its name."""

    name: str = ""

    def plays(self, action: Action) -> bool:
        """Whether the action may be played."""
        return action.panel in self.panels or action.name in self.actions


#: What a profile may say.
FIELDS = names_of(ProfileEntry)


@dataclass(frozen=True, kw_only=True)
class ProfileKeys:
    """The key `profiles`."""

    profiles: Annotated[
        dict[str, ProfileEntry], ReadApart(), Doc("profiles: what a wizard may use, by name")
    ] = field(default_factory=dict)


class ProfileSection(FeatureSection[Mapping[str, Profile]]):
    """Profiles by name."""

    def read(
        self, table: Mapping[str, Cursor], file: Any, contents: FileContents
    ) -> dict[str, Profile]:
        cursor = table.get("profiles")
        entries = cursor.table("a mapping of profiles by name") if cursor is not None else None
        return {
            name: profile
            for name, entry in (entries or {}).items()
            if (profile := _profile(name, entry, contents)) is not None
        }

    def changes(self, old: Mapping[str, Profile], new: Mapping[str, Profile]) -> Iterable[str]:
        return changed_entries("profile", old, new)

    def moments(self, experiment: Experiment) -> Iterable[tuple[str, Profile]]:
        return (
            (f"with the profile {name}", profile) for name, profile in self.of(experiment).items()
        )


def _profile(name: str, cursor: Cursor, contents: FileContents) -> Profile | None:
    profile = read_partly(cursor, Profile, name=name)
    if profile is None:
        return None
    if not name.strip():
        cursor.error("a profile needs a name")
    table = dict(cursor.entries())
    panels = [panel.title for panel in contents.panels]
    actions = [action.name for panel in contents.panels for action in panel.actions]
    knobs = [verb for verb in contents.verbs if verb.name == CONTROL and verb.arguments]
    controls = [choice for verb in knobs for choice in verb.arguments[0].choices]
    for field_, there, what in (
        ("panels", panels, "there is no panel"),
        ("actions", actions, "there is no action"),
        ("controls", [*dict.fromkeys(controls)], "no body has a control"),
        ("verbs", [*dict.fromkeys(verb.name for verb in contents.verbs)], "no driver offers"),
    ):
        for entry, word in texts_of(table.get(field_)):
            if word not in there and (contents.complete or field_ in ("panels", "actions")):
                near = entry.report.hint(word, there, or_list="there are")
                entry.error(f"{what} {quoted(word)}{near}")
    if not any(field_ in table for field_ in FIELDS[:-1]):
        cursor.error(f"allows nothing; name some of {', '.join(FIELDS[:-1])}")
    return profile


PROFILES = ProfileSection(ProfileKeys, {})
