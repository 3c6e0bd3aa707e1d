"""Profiles: what a wizard may use, and what is refused whichever way it comes."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import replace
from pathlib import Path

import pytest

from tests.config.reading import HEAD, errors, read_experiment
from tests.host.rig import served_session
from tests.session.rig import SessionRig, experiment
from tests.session.test_driver_requests import RequestOutcome, from_a_thread
from woz_tui.config.experiment import Experiment
from woz_tui.config.reload_changes import compare
from woz_tui.drivers.contract import Ask
from woz_tui.features.profiles.in_session import ProfileInUse
from woz_tui.features.profiles.kinds import ProfileChanged
from woz_tui.features.profiles.section import PROFILES, Profile
from woz_tui.gate.questions import RequestOrigin, SendVerb
from woz_tui.gate.table import why_not
from woz_tui.host.experiment_view import panel_views
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError

pytestmark = pytest.mark.toolkit("U3")

CHILD = Profile(
    name="child",
    panels=frozenset({"Base"}),
    actions=frozenset({"Hello"}),
    controls=frozenset({"eye-x"}),
    verbs=frozenset({"play"}),
)
KEY = RequestOrigin("key", "h", "con1")
NOT = "is not in the profile child"


def for_children(tmp_path: Path, profile: Profile = CHILD) -> Experiment:
    """The rig's experiment with a profile."""
    return replace(experiment(tmp_path), sections={PROFILES: {profile.name: profile}})


def on_stage(tmp_path: Path, scenario: Callable[[SessionRig], Awaitable[None]]) -> SessionRig:
    """A session in which the profile child is in use."""

    async def with_child(rig: SessionRig) -> None:
        rig.session.experiment = for_children(tmp_path)
        rig.session.features.of(ProfileInUse).use("child", "key")
        await scenario(rig)

    return SessionRig(tmp_path).run(with_child, 3)


def test_only_its_actions_are_played_and_the_others_are_refused_in_the_log(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.play("Hello", KEY)
        with pytest.raises(RequestError, match=f"'Map' {NOT}"):
            rig.session.play("Map", KEY)
        with pytest.raises(RequestError, match=f"'Welcome' {NOT}"):
            rig.session.play("Welcome", KEY)

    rig = on_stage(tmp_path, scenario)
    assert rig.driver().calls[0] == ("say", {"text": "Hello P07"})
    refused = [line.action for line in rig.of(m.ActionRefused)]
    assert refused == ["Map", "Welcome"]
    assert "play" not in [verb for verb, _ in rig.driver().calls]


def test_verbs_by_themselves_are_refused_but_those_it_names(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.send("play", {"move": "nod"}, "", KEY)
        rig.session.send("mark", {"text": "smile"}, "", KEY)
        with pytest.raises(RequestError, match=f"'say' {NOT}"):
            rig.session.send("say", {"text": "no"}, "", RequestOrigin("palette"))

    rig = on_stage(tmp_path, scenario)
    assert [verb for verb, _ in rig.driver().calls[:2]] == ["play", "rest"]
    [refused] = rig.of(m.Refused)
    assert (refused.code, refused.reason) == ("profile", f"'say' {NOT}")


@pytest.mark.parametrize(
    ("verb", "args", "allowed"),
    [
        ("control", {"control": "eye-x", "value": 0.3}, True),
        ("control", {"control": "pitch", "value": 0.3}, False),
        ("control", {}, False),
        ("mode", {"mode": "normal"}, True),
        ("mode", {"mode": "demo"}, False),
        ("note", {"text": "x"}, True),
        ("set", {"trial": 2}, False),
    ],
)
def test_controls_and_modes(
    tmp_path: Path, verb: str, args: dict[str, m.Json], allowed: bool
) -> None:
    async def scenario(rig: SessionRig) -> None:
        refusal = why_not(rig.session.facts(), SendVerb(verb, args, "robot", KEY))
        assert (refusal is None) is allowed
        assert refusal is None or refusal.reason.endswith(NOT)

    on_stage(tmp_path, scenario)


def test_a_control_panel_is_held_to_it_and_a_body_s_own_asks_are_not(tmp_path: Path) -> None:
    hand, own = RequestOutcome(), RequestOutcome()

    async def scenario(rig: SessionRig) -> None:
        say = {"text": "Hi"}
        from_a_thread(rig, Ask("verb", "say", say, source="midi", key="button 7"), hand)
        from_a_thread(rig, Ask("verb", "say", say, source="body"), own)

    rig = on_stage(tmp_path, scenario)
    assert hand.told == [(False, f"'say' {NOT}")]
    assert own.told == [(True, "")]
    assert [verb for verb, _ in rig.driver().calls].count("say") == 1


def test_the_stop_and_its_release_always_count(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.stop("midi")
        await asyncio.sleep(1)
        rig.session.release("key")

    rig = on_stage(tmp_path, scenario)
    assert rig.kinds(m.StopPressed, m.StopReleased) == ["StopPressed", "StopReleased"]


def test_a_reload_keeps_the_profile_also_when_it_is_gone_from_the_file(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        session = rig.session
        wider = replace(CHILD, actions=frozenset({"Map"}))
        session.adopt(for_children(tmp_path, wider), ["profile 'child' changed"])
        assert session.features.of(ProfileInUse).current == wider
        session.adopt(experiment(tmp_path), ["profile 'child' is gone"])
        assert session.features.of(ProfileInUse).current == wider
        with pytest.raises(RequestError, match=NOT):
            session.play("Hello", KEY)
        session.features.of(ProfileInUse).use("", "key")
        session.play("Hello", KEY)
        with pytest.raises(RequestError, match="there is no profile 'child'"):
            session.features.of(ProfileInUse).use("child", "key")

    rig = on_stage(tmp_path, scenario)
    assert "the profile child was removed from the file, but is still in use" in [
        line.text for line in rig.of(m.Notice)
    ]
    changed = [line.profile for line in rig.of(ProfileChanged)]
    assert changed == ["child", ""]


async def test_over_the_socket_everybody_gets_the_panels_that_are_left(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        host.session.experiment = for_children(tmp_path)
        peer, other = await host.connect(), await host.connect()
        welcome = await peer.hello()
        assert (welcome["settings"]["profiles"], welcome["settings"]["profile"]) == (["child"], "")
        await other.hello(role="watcher")
        assert (await peer.ask("profile", profile="adult"))["ok"] is False
        assert (await peer.ask("profile", profile="child", source="palette"))["ok"] is True
        panels = await other.kind("panels")
        assert panels["profile"] == "child"
        speech, base = panels["panels"]
        assert {a["name"] for a in speech["actions"] if not a.get("locked")} == {"Hello"}
        assert not any(action.get("locked") for action in base["actions"])
        reply = await peer.ask("verb", verb="say", args={"text": "no"})
        assert reply["reason"] == f"'say' {NOT}"
        assert (await other.ask("profile", profile=""))["ok"] is False  # it only watches
        late = await host.connect()
        welcome = await late.hello()
        assert welcome["settings"]["profile"] == "child"
        assert "profile.changed" in {line["kind"] for line in welcome["state"]}


def test_hidden_panels_and_actions_are_left_out(tmp_path: Path) -> None:
    hiding = replace(CHILD, panels=frozenset(), hide=True)
    [speech] = panel_views(experiment(tmp_path), {}, {"profiles": hiding})
    assert [action.name for action in speech.actions] == ["Hello"]
    locked = panel_views(experiment(tmp_path), {}, {"profiles": replace(hiding, hide=False)})
    assert [panel.locked for panel in locked] == [False, True]


# -- the file -------------------------------------------------------------------------------------

FILE = (
    HEAD + "panels:\n  - title: Speech\n    actions:\n      - {key: h, label: Hello, say: Hi}\n"
    "profiles:\n"
)


def test_the_file_says_what_a_profile_allows(tmp_path: Path) -> None:
    found = read_experiment(
        tmp_path, f"{FILE}  child: {{panels: [Speech], verbs: [say], hide: yes}}\n"
    )
    child = PROFILES.of(found)["child"]
    assert child == Profile(
        frozenset({"Speech"}), name="child", verbs=frozenset({"say"}), hide=True
    )
    assert child.plays(found.panels[0].actions[0])
    without = read_experiment(tmp_path, f"{FILE}  child: {{actions: [Hello]}}\n")
    assert compare(found, without).changes == ("profile 'child' changed",)
    assert not compare(found, without).drivers


@pytest.mark.parametrize(
    ("profile", "said"),
    [
        (
            "{panels: [Speach]}",
            "8:20: profiles.child.panels[0]: there is no panel 'Speach'; did you mean 'Speech'?",
        ),
        ("{actions: [Hallo]}", "there is no action 'Hallo'; did you mean 'Hello'?"),
        ("{verbs: [sya]}", "no driver offers 'sya'; did you mean 'say'?"),
        ("{controls: [eye-z]}", "no body has a control 'eye-z'"),
        ("{pannels: []}", "unknown; did you mean 'panels'?"),
        ("{panels: Speech}", "expected a list, not"),
        ("{panels: [Speech], hide: perhaps}", "expected true or false"),
        ("{hide: true}", "allows nothing; name some of panels, actions, controls, verbs"),
        ("[]", "expected a profile, such as {panels: [Speech]}"),
    ],
)
def test_what_is_wrong_with_a_profile_is_told_with_its_place(
    tmp_path: Path, profile: str, said: str
) -> None:
    found = errors(tmp_path, f"{FILE}  child: {profile}\n")
    assert any(said in error for error in found), found
    assert all(error.startswith("8:") for error in found)


@pytest.mark.safety
def test_a_profile_forbids_from_the_moment_on_at_which_it_is_chosen(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        session, profile = rig.session, rig.session.features.of(ProfileInUse)
        session.play("Map", KEY)  # nobody asks it yet
        profile.use("child", "key")
        with pytest.raises(RequestError, match=NOT):
            session.play("Map", KEY)
        session.adopt(experiment(tmp_path), [])  # it is still in use
        with pytest.raises(RequestError, match=NOT):
            session.play("Map", KEY)
        profile.use("", "key")
        await asyncio.sleep(5)
        session.play("Map", KEY)

    SessionRig(tmp_path, made=for_children(tmp_path)).run(scenario)
