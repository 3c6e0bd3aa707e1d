"""Features are passed by while the file gives them nothing to do, and only then."""

from __future__ import annotations

import asyncio
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import FrameType
from typing import Any

import pytest

import woz_tui
from tests.session.rig import HERE, SessionRig, experiment, with_script
from woz_tui.config.experiment import Action, Experiment
from woz_tui.features.choices.section import CHOICES, Choice, Option
from woz_tui.features.delay.section import SHAPING, ResponseShaping
from woz_tui.features.people.section import PEOPLE, ParticipantFields
from woz_tui.features.phases.section import PHASES, Phase
from woz_tui.features.profiles.in_session import ProfileInUse
from woz_tui.features.profiles.section import PROFILES, Profile
from woz_tui.features.proposals.section import PROPOSALS, Proposals
from woz_tui.features.repairs.section import PANEL, REPEAT
from woz_tui.features.slots.section import SLOTS, Slot
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError

KEY = RequestOrigin("key", "h", "con1")
FEATURES = Path(woz_tui.__file__).parent / "features"


def bare(folder: Path) -> Experiment:
    """No feature has anything to do."""
    return with_script(experiment(folder))


def section(key: Any, value: Any) -> Callable[[Experiment], Experiment]:
    """The same file with this section."""
    return lambda made: replace(made, sections={**made.sections, key: value})


def repaired(made: Experiment) -> Experiment:
    return replace(made, beside_panels=(Action(REPEAT, REPEAT, "", PANEL, (), HERE),))


COLOUR = Choice("colour", (Option("red"), Option("blue")), "Which one?")
#: By feature: what of the file gives it something to do.
GIVES: dict[str, Callable[[Experiment], Experiment]] = {
    "choices": section(CHOICES, (COLOUR,)),
    "delay": section(SHAPING, ResponseShaping(0.8, 0.4)),
    "people": section(PEOPLE, ParticipantFields({"first": ()})),
    "phases": section(PHASES, (Phase("Open"),)),
    "proposals": section(PROPOSALS, Proposals()),
    "repairs": repaired,
    "scripts": lambda made: with_script(made, "Hello", "Welcome"),
    "slots": section(SLOTS, {"colour": Slot(("red", "blue"))}),
}


async def passed(rig: SessionRig) -> set[str]:
    """The features of which functions are called from a press until its command has ended; not for
    what is kept of every log.
    """
    found: set[str] = set()

    def note(frame: FrameType, event: str, argument: Any) -> None:
        file = Path(frame.f_code.co_filename)
        if event == "call" and file.is_relative_to(FEATURES) and file.stem != "history":
            found.add(file.relative_to(FEATURES).parts[0])

    await asyncio.sleep(2)  # what reading the file has brought about is over
    sys.setprofile(note)
    try:
        rig.session.play("Hello", KEY)
        await asyncio.sleep(2)
    finally:
        sys.setprofile(None)
    return found


@pytest.mark.parametrize("feature", GIVES)
def test_it_is_asked_from_the_reading_of_a_file_that_uses_it_to_that_of_one_that_does_not(
    tmp_path: Path, feature: str
) -> None:
    plain = bare(tmp_path)
    found: list[set[str]] = []

    async def scenario(rig: SessionRig) -> None:
        for made in (plain, GIVES[feature](plain), plain):
            rig.session.adopt(made, [])
            found.append(await passed(rig))

    SessionRig(tmp_path, made=plain).run(scenario)
    assert [feature in each for each in found] == [False, True, False]
    assert found[0] == found[2] == set()


@pytest.mark.parametrize("feature", GIVES)
def test_a_session_that_begins_with_it_asks_it(tmp_path: Path, feature: str) -> None:
    found: list[set[str]] = []

    async def scenario(rig: SessionRig) -> None:
        found.append(await passed(rig))

    SessionRig(tmp_path, made=GIVES[feature](bare(tmp_path))).run(scenario)
    assert feature in found[0]


@pytest.mark.safety
def test_a_profile_forbids_from_the_moment_on_at_which_it_is_chosen(tmp_path: Path) -> None:
    only_moves = Profile(name="mute", verbs=frozenset({"play"}))
    made = section(PROFILES, {"mute": only_moves})(bare(tmp_path))

    async def scenario(rig: SessionRig) -> None:
        assert await passed(rig) == set()
        profile = rig.session.features.of(ProfileInUse)
        profile.use("mute", "key")
        with pytest.raises(RequestError, match="mute"):
            rig.session.play("Hello", KEY)
        rig.session.adopt(bare(tmp_path), [])  # it is still in use
        with pytest.raises(RequestError, match="mute"):
            rig.session.play("Hello", KEY)
        profile.use("", "key")
        assert await passed(rig) == set()

    SessionRig(tmp_path, made=made).run(scenario)


def test_what_is_held_when_its_section_goes_begins_in_its_turn(tmp_path: Path) -> None:
    plain = bare(tmp_path)

    async def scenario(rig: SessionRig) -> None:
        rig.session.hub.publish(m.Marker(text="now"))
        rig.session.play("Hello", KEY)
        rig.session.adopt(plain, [])
        rig.session.play("Welcome", KEY)
        await asyncio.sleep(0.4)
        assert rig.driver().calls == []
        await asyncio.sleep(4)

    shaping = ResponseShaping(0.8, 0.0, ("marker",))
    rig = SessionRig(tmp_path, made=section(SHAPING, shaping)(plain)).run(scenario)
    said = [args["text"] for verb, args in rig.driver().calls if verb == "say"]
    assert said == ["Hello P07", "Welcome"]
