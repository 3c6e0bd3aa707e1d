"""What became forbidden while it waited is refused when its turn comes; what has begun goes on."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import replace
from pathlib import Path

import pytest

from tests.session.rig import HERE, SessionRig, action, call, experiment, together
from woz_tui.config.experiment import Experiment, Panel
from woz_tui.features.profiles.in_session import ProfileInUse
from woz_tui.features.profiles.section import PROFILES, Profile
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m

pytestmark = pytest.mark.safety

KEY = RequestOrigin("key", "h", "con1")
#: Says two things, and locks its own panel between them.
BYE = action(
    "Bye",
    together(call("say", text="Bye"), call("lock", "session", panel="Speech")),
    together(call("say", text="See you")),
)
BOTH = action("Both", together(call("say", text="Hm"), call("play", move="nod")), panel="Base")


def made(tmp_path: Path) -> Experiment:
    base = experiment(tmp_path)
    speech, base_panel = base.panels
    return replace(
        base,
        panels=(
            replace(speech, actions=(*speech.actions, BYE), covers=("say",)),
            Panel("Base", (*base_panel.actions, BOTH), HERE),
        ),
        sections={PROFILES: {"child": Profile(name="child", panels=frozenset({"Base"}))}},
    )


def played(tmp_path: Path, scenario: Callable[[SessionRig], Awaitable[None]]) -> SessionRig:
    """A session whose robot speaks for a second while `scenario` goes on."""

    async def speaking(rig: SessionRig) -> None:
        rig.session.play("Hello", KEY)
        await asyncio.sleep(0.1)
        await scenario(rig)
        await asyncio.sleep(10)

    return SessionRig(tmp_path, made=made(tmp_path)).run(speaking)


def said(rig: SessionRig) -> list[object]:
    return [args.get("text") for verb, args in rig.driver().calls if verb == "say"]


async def lock(rig: SessionRig) -> None:
    rig.session.lock("Speech", True)


async def choose_a_profile(rig: SessionRig) -> None:
    rig.session.features.of(ProfileInUse).use("child", "key")


@pytest.mark.parametrize(
    ("forbid", "code", "why"),
    [
        (lock, "locked", "the panel 'Speech' is locked"),
        (choose_a_profile, "profile", "is not in the profile child"),
    ],
)
def test_an_action_and_a_verb_that_wait_are_refused(
    tmp_path: Path, forbid: Callable[[SessionRig], Awaitable[None]], code: str, why: str
) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.play("Welcome", KEY)  # its second verb does not wait: it has begun
        rig.session.play("Map", KEY)
        rig.session.send("say", {"text": "Well"}, "", KEY)
        await forbid(rig)

    rig = played(tmp_path, scenario)
    assert said(rig) == ["Hello P07", "Welcome"]
    [refused] = rig.of(m.ActionRefused)
    assert (refused.action, why in refused.reason) == ("Map", True)
    assert not refused.reason.startswith("robot: ")
    assert [(each.code, why in each.reason) for each in rig.of(m.Refused)] == [(code, True)] * 2


def test_one_refusal_holds_for_all_verbs_that_begin_together(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.play("Welcome", KEY)  # nods for half a second
        rig.session.play("Both", KEY)
        rig.session.lock("Base", True)

    rig = played(tmp_path, scenario)
    assert "Hm" not in said(rig)
    assert [move for verb, move in rig.driver().calls if verb == "play"] == [{"move": "nod"}]
    [refused] = rig.of(m.ActionRefused)
    assert (refused.action, refused.reason) == ("Both", "the panel 'Base' is locked")


def test_what_an_action_locks_does_not_cut_it_off_itself(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.play("Bye", KEY)

    rig = played(tmp_path, scenario)
    assert said(rig) == ["Hello P07", "Bye", "See you"]
    assert rig.session.locked["Speech"]
    assert rig.of(m.ActionRefused) == []
