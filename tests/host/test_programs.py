"""What a program asks for over the socket is in the log with its name, and within all limits."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from tests.host.rig import Peer, ServedSession, served_session
from tests.session.rig import (
    CONSENT_VERB,
    HERE,
    LEARN_VERB,
    ScriptedDriver,
    action,
    call,
    experiment,
    together,
    with_script,
    with_verbs,
)
from woz_tui.config.experiment import Experiment, Panel, SessionSettings
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.drivers.contract import Job, Offer
from woz_tui.features.phases.section import PHASES, Phase
from woz_tui.features.profiles.section import PROFILES, Profile
from woz_tui.protocol import messages as m
from woz_tui.protocol.codec import decode_incoming
from woz_tui.protocol.messages import Json
from woz_tui.protocol.requests import PROTOCOL, Welcome


async def program(host: ServedSession, name: str = "stimulus") -> Peer:
    peer = await host.connect()
    await peer.hello("program", protocol=PROTOCOL, name=name)
    return peer


class LogReadingDriver(ScriptedDriver):
    """Looks into the log when it is told to move."""

    log: Path

    async def perform(self, job: Job) -> Mapping[str, Json]:
        self.calls.append((job.verb, {"logged": f'"{job.command}"' in self.log.read_text()}))
        return {}


async def test_it_is_in_the_log_with_its_source_before_it_moves(tmp_path: Path) -> None:
    async with served_session(tmp_path, catalogue={"puppet": LogReadingDriver}) as host:
        LogReadingDriver.log = host.session.recorder.path
        peer = await program(host)
        await peer.ask("verb", verb="say", args={"text": "Hello"})
        await peer.kind("command.done")
        await peer.ask("action", action="Hello")
        await peer.kind("action.done")
        assert host.driver().calls == [("say", {"logged": True})] * 2
        lines = [json.loads(line) for line in LogReadingDriver.log.read_text().splitlines()]
        requested = [line for line in lines if line["kind"].endswith(".requested")]
        assert [line["source"] for line in requested] == ["program"] * 3
        assert [line.get("console") for line in requested] == ["con1", "con1", None]


ASKED: list[tuple[str, dict[str, Any], str]] = [
    ("marker", {"text": "onset"}, "marker"),
    ("note", {"text": "the phone rang"}, "note"),
    ("set", {"participant": "P08"}, "session.changed"),
    ("lock", {"panel": "Base", "locked": True}, "panel.locked"),
    ("stop", {}, "stop.pressed"),
    ("phase", {"phase": "opening"}, "phase.changed"),
    ("profile", {"profile": "child"}, "profile.changed"),
]


def with_profile(folder: Path) -> Experiment:
    child = Profile(name="child", actions=frozenset({"Hello"}))
    made = replace(experiment(folder), sections={PROFILES: {"child": child}})
    return replace(made, session=SessionSettings(stale_after=60.0))  # the machine may be busy


def limited(folder: Path) -> Experiment:
    """With a profile and phases."""
    phases = (
        Phase(name="opening", panels=("Base",), lock_others=True),
        Phase(name="closing", panels=("Speech",), after=("opening",)),
    )
    return with_phases(with_profile(folder), phases)


def with_phases(made: Experiment, phases: Iterable[Phase]) -> Experiment:
    return replace(made, sections={**made.sections, PHASES: tuple(phases)})


@pytest.mark.parametrize(("kind", "fields", "says"), ASKED)
async def test_the_log_names_the_connection_of_everything_asked_for(
    tmp_path: Path, kind: str, fields: dict[str, Any], says: str
) -> None:
    made = limited(tmp_path)
    made = with_phases(made, [replace(each, after=()) for each in reversed(PHASES.of(made))])
    async with served_session(tmp_path, made=made) as host:
        peer = await program(host)
        reply = await peer.ask(kind, **fields)
        assert reply["ok"], reply
        [line] = [line for line in peer.seen if line["kind"] == says]
        assert line["console"] == "con1"


async def test_nobody_is_named_for_what_the_robot_does_by_itself(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        peer = await program(host)
        await peer.ask("marker", text="onset")
        host.session.mark("by a driver", "midi")
        own = await peer.until(lambda line: line.get("text") == "by a driver")
        assert "console" not in own


SOURCES = ["engagement", "replay", "phase", "midi", "key", "palette", "script", "pedal"]


@pytest.mark.safety
@pytest.mark.parametrize("source", SOURCES)
async def test_a_program_is_the_source_of_what_it_asks_for_whatever_it_claims(
    tmp_path: Path, source: str
) -> None:
    made = limited(tmp_path)
    made = with_phases(made, [replace(each, after=()) for each in PHASES.of(made)])
    async with served_session(tmp_path, made=made) as host:
        peer = await program(host)
        for kind, fields in (
            ("phase", {"phase": "closing"}),
            ("verb", {"verb": "play", "args": {"move": "nod"}}),
            ("action", {"action": "Hello"}),
            ("profile", {"profile": "child"}),
            ("stop", {}),
            ("release", {}),
        ):
            said = {} if kind == "stop" else {"source": source}
            reply = await peer.ask(kind, **said, **fields)
            assert reply["ok"], reply
        await peer.ask("script", key="space")
        told = {line["kind"]: line["source"] for line in peer.seen if "source" in line}
        del told["panel.locked"]  # by the phase
        assert {"action.requested", "command.requested", "phase.changed", "profile.changed"} < {
            *told
        }
        assert {*told.values()} == {"program"}


class LearningDriver(ScriptedDriver):
    """Learns faces."""

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        return with_verbs(super().offer(settings), CONSENT_VERB, LEARN_VERB)

    async def perform(self, job: Job) -> Mapping[str, Json]:
        self.calls.append((job.verb, dict(job.args)))
        return {}


def with_faces(folder: Path) -> Experiment:
    """A step that a person plays, also in the script."""
    steps = together(call("face_consent", name="Anna")), together(call("learn_face", name="Anna"))
    made = experiment(folder)
    speech = Panel("Speech", (action("Anna agrees", *steps),), HERE)
    spec = replace(made.drivers[0], offer=LearningDriver.offer(None))
    return with_script(replace(made, panels=(speech,), drivers=(spec,)), "Anna agrees")


PRESSES: list[tuple[str, dict[str, Any]]] = [
    ("action", {"action": "Anna agrees", "source": "key", "key": "h"}),
    ("action", {"action": "Anna agrees", "source": "pedal", "key": "1"}),
    ("action", {"action": "Anna agrees", "source": "palette"}),
    ("script", {"key": "space"}),
]


@pytest.mark.safety
@pytest.mark.parametrize(("kind", "fields"), PRESSES)
async def test_a_program_gives_no_consent_whatever_it_claims(
    tmp_path: Path, kind: str, fields: dict[str, Any]
) -> None:
    made, catalogue = with_faces(tmp_path), {"puppet": LearningDriver}
    async with served_session(tmp_path, made=made, catalogue=catalogue) as host:
        peer, wizard = await program(host), await host.connect()
        reply = await peer.ask(kind, **fields)
        assert "no person has given this consent" in reply["reason"]
        assert host.driver().calls == []
        await wizard.hello("wizard", protocol=PROTOCOL)
        await wizard.ask("action", action="Anna agrees", source="key", key="h")
        await wizard.kind("action.done")
        assert [verb for verb, _ in host.driver().calls] == ["face_consent", "learn_face"]


# -- limits ----------------------------------------------------------------------------------------


async def test_a_profile_binds_a_program(tmp_path: Path) -> None:
    made = with_profile(tmp_path)
    async with served_session(tmp_path, made=made) as host:
        peer = await program(host)
        await peer.ask("profile", profile="child")
        assert (await peer.ask("action", action="Hello"))["ok"]
        for kind, fields in (
            ("action", {"action": "Map"}),
            ("verb", {"verb": "play", "args": {"move": "nod"}}),
        ):
            reply = await peer.ask(kind, **fields)
            assert not reply["ok"]
            assert "not in the profile child" in reply["reason"]


async def test_locks_and_phases_bind_a_program(tmp_path: Path) -> None:
    made = limited(tmp_path)
    speech, base = made.panels
    made = replace(made, panels=(speech, replace(base, covers=("play",))))
    async with served_session(tmp_path, made=made) as host:
        peer = await program(host)
        assert "in the phase" in (await peer.ask("action", action="Hello"))["reason"]
        await peer.ask("lock", panel="Base", locked=True)
        assert "is locked" in (await peer.ask("action", action="Go"))["reason"]
        covered = await peer.ask("verb", verb="play", args={"move": "nod"})
        assert not covered["ok"]
        assert "is locked" in covered["reason"]
        assert (await peer.ask("phase"))["ok"]
        assert (await peer.ask("action", action="Hello"))["ok"]


async def test_the_stop_and_the_dead_mans_switch_bind_a_program(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        peer, wizard = await program(host), await host.connect()
        drive = {"verb": "drive", "args": {"x": 1.0}}
        assert "no wizard" in (await peer.ask("verb", **drive))["reason"]
        await wizard.hello("wizard")
        assert (await peer.ask("verb", **drive))["ok"]
        await wizard.say(kind="beat", line_ok=False)
        assert (await peer.kind("command.stopped"))["command"]
        assert not (await peer.ask("verb", **drive))["ok"]
        await wizard.say(kind="beat")
        await wizard.ask("stop")
        for kind, fields in (
            ("verb", drive),
            ("verb", {"verb": "say", "args": {"text": "x"}}),
            ("action", {"action": "Hello"}),
        ):
            assert "stop is pressed" in (await peer.ask(kind, **fields))["reason"]


# -- the wizard's screen ---------------------------------------------------------------------------


async def seen_by_wizard(wizard: Peer, welcome: dict[str, Any]) -> list[tuple[str, str]]:
    """Text and detail of the lines on the wizard's list of events."""
    state = ConsoleState()
    first = decode_incoming(json.dumps(welcome).encode())
    assert isinstance(first, Welcome)
    state.apply([first], 0)
    later = wizard.seen[wizard.seen.index(welcome) + 1 :]
    decoded = [decode_incoming(json.dumps(line).encode()) for line in later]
    state.apply([line for line in decoded if isinstance(line, m.Message)], 0)
    return [(event.text, event.detail) for event in state.events]


async def test_the_wizards_screen_says_which_program_asked(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        wizard = await host.connect()
        welcome = await wizard.hello("wizard", protocol=PROTOCOL)
        peer = await program(host)
        await peer.ask("action", action="Hello")
        await peer.ask("verb", verb="play", args={"move": "nod"}, source="key")
        await peer.ask("marker", text="onset")
        await peer.ask("lock", panel="Base", locked=True)
        await peer.ask("stop")
        await peer.ask("release")
        await wizard.kind("stop.released")
        lines = await seen_by_wizard(wizard, welcome)
        named = [text for text, detail in lines if "stimulus" in detail]
        for begin in ("Hello", "Play nod", "Marker", "Base locked", "STOP", "Stop released"):
            assert any(text.lower().startswith(begin.lower()) for text in named), (begin, lines)
