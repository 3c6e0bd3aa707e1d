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
from woz_tui.protocol.sentence import Sentence

#: The verb that turns a knob; its first argument's choices are all controls there are.
CONTROL = "control"


@dataclass(frozen=True, slots=True)
class ProfileEntry(Entry):
    """What a wizard may use: actions of these panels and these actions; by themselves (from keys of
    the console, the palette, a control panel, a program) these verbs and controls.

    `hide`: what may not be used is not even shown.
    """

    what = Sentence("profiles.a_profile", "a profile")
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
        entries = (
            cursor.table(Sentence("profiles.by_name", "a mapping of profiles by name"))
            if cursor is not None
            else None
        )
        return {
            name: profile
            for name, entry in (entries or {}).items()
            if (profile := _profile(name, entry, contents)) is not None
        }

    def changes(self, old: Mapping[str, Profile], new: Mapping[str, Profile]) -> Iterable[str]:
        return changed_entries(Sentence("reload.a_profile", "profile"), old, new)

    def moments(self, experiment: Experiment) -> Iterable[tuple[str, Profile]]:
        return (
            (f"with the profile {name}", profile) for name, profile in self.of(experiment).items()
        )


def _profile(name: str, cursor: Cursor, contents: FileContents) -> Profile | None:
    profile = read_partly(cursor, Profile, name=name)
    if profile is None:
        return None
    if not name.strip():
        cursor.error(Sentence("profiles.nameless", "a profile needs a name"))
    table = dict(cursor.entries())
    panels = [panel.title for panel in contents.panels]
    actions = [action.name for panel in contents.panels for action in panel.actions]
    knobs = [verb for verb in contents.verbs if verb.name == CONTROL and verb.arguments]
    controls = [choice for verb in knobs for choice in verb.arguments[0].choices]
    for field_, there in (
        ("panels", panels),
        ("actions", actions),
        ("controls", [*dict.fromkeys(controls)]),
        ("verbs", [*dict.fromkeys(verb.name for verb in contents.verbs)]),
    ):
        for entry, word in texts_of(table.get(field_)):
            if word not in there and (contents.complete or field_ in ("panels", "actions")):
                near = entry.report.hint(
                    word, there, or_list=Sentence("check.there_are", "there are")
                )
                entry.error(_not_there(field_, quoted(word), near))
    if not any(field_ in table for field_ in FIELDS[:-1]):
        cursor.error(
            Sentence(
                "profiles.allows_nothing",
                "allows nothing; name some of {names}",
                names=", ".join(FIELDS[:-1]),
            )
        )
    return profile


def _not_there(field_: str, name: str, near: str) -> str:
    match field_:
        case "panels":
            return Sentence(
                "check.no_panel", "there is no panel {name}{near}", name=name, near=near
            )
        case "actions":
            return Sentence(
                "check.no_action", "there is no action {name}{near}", name=name, near=near
            )
        case "controls":
            return Sentence(
                "profiles.no_control", "no body has a control {name}{near}", name=name, near=near
            )
    return Sentence("check.no_driver_offers", "no driver offers {verb}{near}", verb=name, near=near)


PROFILES = ProfileSection(ProfileKeys, {})
