"""What the wizard and their consoles leave in a session: markers, notes, mistakes, locks, reloads.

Everybody imports these from `woz_tui.protocol.messages`, where all messages are together.
"""

from __future__ import annotations

import msgspec

from woz_tui.protocol.envelope import Message, RestrictedMessage


class Marker(RestrictedMessage, frozen=True, kw_only=True, omit_defaults=True, tag="marker"):
    """A moment worth finding again."""

    text: str = ""
    source: str = msgspec.field(default_factory=lambda: "key")


class Note(RestrictedMessage, frozen=True, kw_only=True, omit_defaults=True, tag="note"):
    """A sentence the wizard typed."""

    text: str


class Mistake(RestrictedMessage, frozen=True, kw_only=True, omit_defaults=True, tag="mistake"):
    """The wizard says that the run `run` of `action` was a mistake."""

    run: str
    action: str = ""
    text: str = ""


class ScriptMoved(Message, frozen=True, kw_only=True, omit_defaults=True, tag="script.moved"):
    """The script's next line: `position` counts from 0; equal to the length at the end.

    `phase`: whose script; empty: that of the file. `played`: lines that were played, also those
    that are being played; older logs do not say it, there it is all before `position`. `halted`:
    the script stands still at this line, because it ended so (failed, refused, stopped).
    """

    position: int
    phase: str = msgspec.field(default_factory=str)
    played: list[int] | None = None
    halted: str = msgspec.field(default_factory=str)


class PhaseChanged(Message, frozen=True, kw_only=True, omit_defaults=True, tag="phase.changed"):
    """A phase of the experiment begins; an empty `phase`: none holds from here on.

    `source`: key, palette, program; trial, session (a participant or a trial was set, or the
    session begins) or reload where it began with that. `planned_us`: how long it is to last (0:
    nobody said).
    """

    phase: str = msgspec.field(default_factory=str)
    source: str = msgspec.field(default_factory=lambda: "key")
    planned_us: int = 0


class PanelLocked(Message, frozen=True, kw_only=True, omit_defaults=True, tag="panel.locked"):
    """A panel was locked or unlocked while running; `source` is phase where that did it."""

    panel: str
    locked: bool
    source: str = msgspec.field(default_factory=str)


class ProfileChanged(Message, frozen=True, kw_only=True, omit_defaults=True, tag="profile.changed"):
    """What the wizard may use changed: only what `profile` of the experiment names; an empty one is
    everything.
    """

    profile: str = msgspec.field(default_factory=str)
    source: str = msgspec.field(default_factory=lambda: "key")


class ExperimentReloaded(
    Message, frozen=True, kw_only=True, omit_defaults=True, tag="experiment.reloaded"
):
    """The experiment file was read again; `changes` lists the differences in words, `telling` those
    of them that may tell which condition is which.
    """

    experiment_sha256: str
    changes: list[str]
    telling: list[str] = msgspec.field(default_factory=list)


class ConsoleAttached(
    Message, frozen=True, kw_only=True, omit_defaults=True, tag="console.attached"
):
    """A console or program connected. `role`: wizard, watcher, program or participant; `name`: how
    it calls itself. `sees` is `all` for a program that gets what is kept from the wizard.
    """

    console: str
    role: str
    name: str = ""
    sees: str = ""


class ConsoleLost(Message, frozen=True, kw_only=True, omit_defaults=True, tag="console.lost"):
    """It left (`why`: left) or died (closed, silent)."""

    console: str
    role: str
    why: str
