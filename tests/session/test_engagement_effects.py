"""What the robot does by itself on entering a state."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import pytest

from tests.session.engagement_rig import (
    PLAIN,
    WIZARD,
    EngagementRig,
    GuideDriver,
    effect,
    guided,
    in_room,
)
from tests.session.rig import call, together
from woz_tui.config.engagement import EngagementSettings
from woz_tui.config.engagement_words import STATES
from woz_tui.config.experiment import TextVariants, Wait
from woz_tui.drivers.contract import DriverError, Health, Job
from woz_tui.features.profiles.in_session import ProfileInUse
from woz_tui.features.profiles.section import PROFILES, Profile
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json
from woz_tui.session.state_signals import SIGNALS

KNOWN = "EngagedWithKnown"
SHOWING = EngagementSettings()


async def through_all_states(rig: EngagementRig) -> None:
    rig.tell("sense", sign="presence", value="on")
    await asyncio.sleep(1)
    rig.tell("sense", sign="all", value="on")
    await asyncio.sleep(1)
    rig.tell("visitor", code="Anna")
    await asyncio.sleep(1)
    await rig.hears(1)
    await asyncio.sleep(1)
    rig.tell("say", text="Yes")
    await asyncio.sleep(2)
    rig.tell("say", text="Well")
    await asyncio.sleep(2)
    rig.tell("sense", sign="all", value="off")
    await asyncio.sleep(1)


def test_each_state_shows_its_signals_within_a_third_of_a_second(tmp_path: Path) -> None:
    """E6: eyes, tablet and sound of each state; the beep once for each utterance."""
    rig = in_room(tmp_path, through_all_states, guided(tmp_path, SHOWING))
    changes = rig.of(m.EngagementChanged)
    assert {change.now for change in changes} == set(STATES)
    dispatched = {line.command: line.t for line in rig.of(m.Dispatched)}
    done = {line.command for line in rig.of(m.Done)}
    commands = [line for line in rig.of(m.Command) if line.source == "engagement"]
    for change in changes:
        signal = SIGNALS[change.now]
        window = [
            command
            for command in commands
            if change.t <= dispatched[command.command] <= change.t + 333_333
            and command.seq > change.seq
        ]
        eyes = next(command for command in window if command.verb == "eyes")
        assert eyes.args["color"] == signal.eyes, change.now
        left = next((other.t for other in changes if other.seq > change.seq), None)
        assert eyes.command in done or left == change.t
        if signal.screen:
            screen = next(command for command in window if command.verb == "screen")
            assert str(screen.args["file"]).endswith(signal.screen)
    beeps = [command for command in commands if command.verb == "sound"]
    assert len(beeps) == len(rig.of(m.SpeechEnded)) == 1


def test_effects_of_the_file_are_played_as_actions_of_the_model(tmp_path: Path) -> None:
    """E6: an explicit effect stands in the place of the default of that verb."""
    effects = effect(
        "PersonDetected", together(call("eyes", color="red")), together(call("play", move="nod"))
    )
    experiment = guided(tmp_path, SHOWING, effects, {KNOWN: ("Greet",)})

    async def scenario(rig: EngagementRig) -> None:
        await rig.visit(5, identity="V1")

    rig = in_room(tmp_path, scenario, experiment)
    requested = [line for line in rig.of(m.ActionRequested) if line.source == "engagement"]
    assert [line.action for line in requested][:2] == ["on PersonDetected", "Greet"]
    assert [line.action for line in requested].count("Greet") == 1
    assert [line.reason for line in rig.of(m.ActionEnd)].count("") >= 1
    seen = [args["color"] for verb, args in rig.commands if verb == "eyes"]
    assert seen[:2] == ["off", "red"]
    assert ("say", {"text": "Hello V1"}) in rig.robot.calls
    # What the model says by itself in EngagedWithKnown is the robot's initiative like any other.
    assert rig.path[1:4] == [KNOWN, "RobotSpeaks", KNOWN]


def test_what_waits_is_dropped_when_the_state_is_left(tmp_path: Path) -> None:
    """What was begun (a sentence) ends; what stood behind a pause does not come any more."""
    effects = effect(
        "PersonDetected",
        together(call("say", text="Come near")),
        Wait(5.0),
        together(call("say", text="Are you still there?")),
    ) | effect(
        "EngagedWithUnknown", together(call("say", text="Hello")), together(call("play", move="x"))
    )

    async def scenario(rig: EngagementRig) -> None:
        rig.tell("force", to="PersonDetected")
        await asyncio.sleep(2)
        rig.tell("force", to="EngagedWithUnknown")
        await asyncio.sleep(0.5)
        rig.tell("force", to="PersonDetected")
        await asyncio.sleep(0.1)
        rig.tell("force", to="Wait")
        await asyncio.sleep(10)

    rig = in_room(tmp_path, scenario, guided(tmp_path, PLAIN, effects))
    said = [args["text"] for verb, args in rig.robot.calls if verb == "say"]
    assert said == ["Come near", "Hello"]  # the third waits behind the second, for nobody
    assert "play" not in [verb for verb, _ in rig.robot.calls]
    ends = rig.of(m.ActionStopped)
    assert len(ends) == 3
    assert "PersonDetected to EngagedWithUnknown" in ends[0].reason


class FallingDriver(GuideDriver):
    """Falls over in the middle of a move."""

    async def perform(self, job: Job) -> Mapping[str, Json]:
        done = await super().perform(job)
        if job.verb == "play":
            raise DriverError("it fell over", "pick it up")
        return done


def test_what_fails_after_the_state_was_left_is_a_failure_and_told(tmp_path: Path) -> None:
    effects = effect(
        "PersonDetected",
        together(call("say", text="Come near"), call("play", move="wave")),
        together(call("say", text="Do come")),
    )

    async def scenario(rig: EngagementRig) -> None:
        rig.tell("force", to="PersonDetected")
        await asyncio.sleep(0.5)
        rig.tell("force", to="Wait")
        await asyncio.sleep(3)

    rig = in_room(tmp_path, scenario, guided(tmp_path, PLAIN, effects), kind=FallingDriver)
    (end,) = rig.of(m.ActionEnd)
    assert isinstance(end, m.ActionFailed)
    assert "it fell over" in end.reason
    assert [text for text in rig.notices if "it fell over" in text]
    assert [verb for verb, _ in rig.robot.calls].count("say") == 1


def test_a_greeting_is_not_repeated_after_each_turn(tmp_path: Path) -> None:
    effects = effect(KNOWN, together(call("say", text="Welcome"), call("eyes", color="pink")))

    async def scenario(rig: EngagementRig) -> None:
        rig.stands_there()
        await asyncio.sleep(3)
        await rig.hears(1)
        rig.tell("say", text="Yes")
        await asyncio.sleep(3)

    rig = in_room(tmp_path, scenario, guided(tmp_path, PLAIN, effects))
    said = [args["text"] for verb, args in rig.robot.calls if verb == "say"]
    assert said == ["Welcome", "Yes"]
    assert [args["color"] for verb, args in rig.commands if verb == "eyes"] == ["pink"] * 3


def test_an_effect_that_speaks_in_robot_thinks_is_the_answer(tmp_path: Path) -> None:
    effects = effect("RobotThinks", together(call("say", text="Let me see")))

    async def scenario(rig: EngagementRig) -> None:
        rig.stands_there()
        await asyncio.sleep(1)
        await rig.hears(1)
        await asyncio.sleep(2)

    rig = in_room(tmp_path, scenario, guided(tmp_path, PLAIN, effects))
    assert rig.path[-4:] == ["UserSpeaks", "RobotThinks", "RobotReplies", KNOWN]


def test_while_stopped_nothing_is_played_and_then_what_lasts_is_shown_again(
    tmp_path: Path,
) -> None:
    effects = effect(
        "PersonDetected", together(call("say", text="Come near"), call("eyes", color="red"))
    )

    async def scenario(rig: EngagementRig) -> None:
        await asyncio.sleep(1)
        rig.robot.calls.clear()
        rig.session.stop("key")
        rig.tell("force", to="PersonDetected")
        await asyncio.sleep(1)
        assert rig.path == ["PersonDetected"]
        assert [verb for verb, _ in rig.robot.calls if verb != "stop"] == []
        rig.session.release("key")
        await asyncio.sleep(1)

    rig = in_room(tmp_path, scenario, guided(tmp_path, SHOWING, effects))
    shown = [verb for verb, _ in rig.robot.calls if verb not in ("stop", "rest", "close")]
    assert sorted(shown) == ["eyes", "screen"]
    assert ("eyes", {"color": "red"}) in rig.robot.calls


def test_what_is_shown_again_after_a_stop_is_chosen_and_filled_in(tmp_path: Path) -> None:
    by_condition = TextVariants({"warm": ("{shade}-red",), "cold": ("blue",)})
    eyes = replace(call("eyes"), choices={"color": by_condition})
    experiment = guided(tmp_path, SHOWING, effect("PersonDetected", together(eyes)))

    async def scenario(rig: EngagementRig) -> None:
        rig.session.stop("key")
        rig.tell("force", to="PersonDetected")
        await asyncio.sleep(1)
        rig.session.release("key")
        await asyncio.sleep(1)

    rig = in_room(tmp_path, scenario, replace(experiment, variables={"shade": "dark"}))
    assert ("eyes", {"color": "dark-red"}) in rig.robot.calls


def test_what_fails_is_told_once(tmp_path: Path) -> None:
    effects = effect("PersonDetected", together(call("say", text="Hello {visitor}")))
    experiment = guided(tmp_path, SHOWING, effects, {"PersonDetected": ("Never", "Nothing")})

    async def scenario(rig: EngagementRig) -> None:
        rig.robot.broken = "eyes"
        for _ in range(3):
            rig.tell("force", to="PersonDetected")
            await asyncio.sleep(0.5)
            rig.tell("force", to="Wait")
            await asyncio.sleep(0.5)

    rig = in_room(tmp_path, scenario, experiment)
    told = [text for text in rig.notices if text.startswith("engagement: ")]
    assert len(told) == len(set(told))
    assert any("no eyes today" in text for text in told)
    assert any("{visitor} has no value yet" in text for text in told)
    assert any("'Never' is locked" in text for text in told)
    assert any("there is no action 'Nothing'" in text for text in told)
    assert len(rig.of(m.ActionRefused)) == 6


def test_a_signal_overtakes_an_older_one(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        for to in ("PersonDetected", "EngagedWithUnknown", "Handshake", "Wait") * 5:
            rig.tell("force", to=to)
        await asyncio.sleep(1)

    rig = in_room(tmp_path, scenario, guided(tmp_path, SHOWING))
    assert rig.robot.calls[-4:] != []
    eyes = [args["color"] for verb, args in rig.robot.calls if verb == "eyes"]
    assert eyes[-1] == "off"


def test_somebody_who_is_nearly_engaged_sees_it(tmp_path: Path) -> None:
    """All but the distance: green that comes and goes, after the paper's table."""

    async def scenario(rig: EngagementRig) -> None:
        await rig.visit(4, distance=3.0)

    rig = in_room(tmp_path, scenario, guided(tmp_path, SHOWING))
    eyes = [args["color"] for verb, args in rig.commands if verb == "eyes"]
    assert eyes[:3] == ["off", "white", "green"]


def test_a_robot_that_connects_shows_how_things_stand(tmp_path: Path) -> None:
    """E6: at the beginning, and when a cable was plugged in again."""

    async def scenario(rig: EngagementRig) -> None:
        await asyncio.sleep(1)
        assert [verb for verb, _ in rig.robot.calls] == ["eyes", "screen"]
        rig.tell("force", to="RobotThinks")
        await asyncio.sleep(1)
        rig.robot.calls.clear()
        rig.robot.context.health(Health.LOST, "the cable")
        await asyncio.sleep(1)
        assert rig.robot.calls == []
        rig.robot.context.health(Health.CONNECTED, "a puppet")
        await asyncio.sleep(1)
        assert [verb for verb, _ in rig.robot.calls] == ["eyes", "screen"]
        assert rig.robot.calls[0] == ("eyes", {"color": "white"})

    in_room(tmp_path, scenario, guided(tmp_path, SHOWING))


@pytest.mark.parametrize(
    "settings", [EngagementSettings(signals="none"), EngagementSettings(start="off")]
)
def test_a_robot_that_shall_show_nothing_shows_nothing(
    tmp_path: Path, settings: EngagementSettings
) -> None:
    async def scenario(rig: EngagementRig) -> None:
        await asyncio.sleep(1)
        assert rig.robot.calls == []

    in_room(tmp_path, scenario, guided(tmp_path, settings))


def test_a_profile_of_the_wizard_does_not_bind_the_robot(tmp_path: Path) -> None:
    experiment = replace(
        guided(tmp_path, PLAIN, None, {"PersonDetected": ("Welcome",)}),
        sections={PROFILES: {"little": Profile(name="little", verbs=frozenset({"force"}))}},
    )

    async def scenario(rig: EngagementRig) -> None:
        rig.session.features.of(ProfileInUse).use("little", "key")
        rig.tell("force", to="PersonDetected")
        await asyncio.sleep(2)
        with pytest.raises(ValueError, match="not in the profile"):
            rig.session.play("Welcome", WIZARD)

    rig = in_room(tmp_path, scenario, experiment)
    assert ("say", {"text": "Welcome"}) in rig.robot.calls
