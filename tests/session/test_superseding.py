"""Acts that need what older ones still want to use: nothing is cut out of the middle of another."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from tests.session.rig import ScriptedDriver, SessionRig, action, call, experiment, together
from woz_tui.config.experiment import Action, Panel, Wait
from woz_tui.drivers.contract import Argument, Job, Offer, Verb
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json
from woz_tui.protocol.refusal import RequestError
from woz_tui.timeline.episodes import ActionEpisode as Played
from woz_tui.timeline.episodes import EpisodeOutcome
from woz_tui.timeline.timeline import Timeline

KEY = RequestOrigin("key", "x", "con1")


class LaneDriver(ScriptedDriver):
    """Speaks, moves, looks and feels: each in a lane of its own, a second each time."""

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        text = (Argument("text", "text", required=True),)
        return replace(
            super().offer(settings),
            verbs=(
                Verb("say", "", text, lane="voice"),
                Verb("play", "", (Argument("move", "text"),), lane="body"),
                Verb("gaze", "", (Argument("yaw", "number"),), lane="head", stream=True),
                Verb("nudge", "", (Argument("yaw", "number"),), lane="head", brief=True),
                Verb("emotion", "", (Argument("emotion", "text"),), lane="face"),
            ),
        )

    async def perform(self, job: Job) -> Mapping[str, Json]:
        self.calls.append((job.verb, dict(job.args)))
        await asyncio.sleep(1.0)
        return dict(job.args)


def say_actions(*texts: str) -> tuple[Any, ...]:
    return tuple(together(call("say", text=text)) for text in texts)


ACTIONS = (
    replace(
        action("Exhibit", *say_actions("This is the whale.", "It is eleven metres long.", "Come.")),
        when_busy="replace",
    ),
    action("Repeat", *say_actions("Could you say that again?")),
    action("Map", *say_actions("Look at the map."), Wait(5), *say_actions("We are here.")),
    action(
        "Feel",
        together(call("say", text="I am"), call("emotion", emotion="happy")),
        together(call("say", text="so glad."), call("gaze", yaw=10), call("emotion", emotion="x")),
    ),
    action("Happy", together(call("emotion", emotion="happy"))),
    action("Wave", together(call("play", move="wave"))),
    action("Dance", together(call("play", move="one")), together(call("play", move="two"))),
    action("Look about", together(call("gaze", yaw=1)), Wait(1), together(call("gaze", yaw=-1))),
    replace(action("Gong", *say_actions("gong")), when_busy="refuse"),
    action("Hello", *say_actions("Hello {participant}")),
)


def scene(
    tmp_path: Path,
    play: Callable[[SessionRig], Awaitable[None]],
    actions: tuple[Action, ...] = ACTIONS,
) -> SessionRig:
    made = experiment(tmp_path)
    spec = replace(made.drivers[0], offer=LaneDriver.offer(None))
    made = replace(made, drivers=(spec,), panels=(Panel("All", actions, spec.place),))
    return SessionRig(tmp_path, catalogue={"puppet": LaneDriver}, made=made).run(play, 20)


def spoken_texts(rig: SessionRig) -> list[Json]:
    """What was said to its end."""
    return [
        line.sent["text"]
        for line in rig.of(m.Done)
        if "text" in line.sent and line.driver == "robot"
    ]


def ends(rig: SessionRig) -> dict[str, m.ActionEnd]:
    return {line.action: line for line in rig.of(m.ActionEnd)}


def press_actions(*presses: tuple[float, str]) -> Callable[[SessionRig], Awaitable[None]]:
    """Actions, each after so many seconds."""

    async def play(rig: SessionRig) -> None:
        for wait, name in presses:
            await asyncio.sleep(wait)
            rig.session.play(name, KEY)

    return play


def test_a_newer_act_is_not_cut_off_by_the_next_step_of_the_older_one(tmp_path: Path) -> None:
    rig = scene(tmp_path, press_actions((0, "Exhibit"), (0.6, "Repeat")))
    assert spoken_texts(rig) == ["This is the whale.", "Could you say that again?"]
    over = ends(rig)
    assert isinstance(over["Repeat"], m.ActionDone)
    assert isinstance(over["Exhibit"], m.ActionSuperseded)
    assert over["Exhibit"].by == over["Repeat"].run
    assert over["Exhibit"].reason == 'replaced by "Repeat"'


def test_a_step_that_is_running_gives_way_only_where_the_newer_one_says_so(tmp_path: Path) -> None:
    rig = scene(tmp_path, press_actions((0, "Map"), (0.6, "Exhibit")))
    assert spoken_texts(rig)[0] == "This is the whale."
    assert isinstance(ends(rig)["Map"], m.ActionSuperseded)
    assert ends(rig)["Map"].reason == 'replaced by "Exhibit"'


def test_what_pauses_between_two_steps_is_over_at_once(tmp_path: Path) -> None:
    rig = scene(tmp_path, press_actions((0, "Map"), (2, "Repeat")))
    assert spoken_texts(rig) == ["Look at the map.", "Could you say that again?"]
    assert ends(rig)["Map"].t < 2_500_000


def test_what_has_not_begun_is_not_begun_any_more(tmp_path: Path) -> None:
    rig = scene(tmp_path, press_actions((0, "Repeat"), (0.1, "Map"), (0.1, "Hello")))
    assert spoken_texts(rig) == ["Could you say that again?", "Hello P07"]
    assert ends(rig)["Map"].reason == 'replaced by "Hello"'


@pytest.mark.parametrize("other", ["Wave", "Happy"])
def test_what_needs_other_lanes_leaves_an_action_alone(tmp_path: Path, other: str) -> None:
    rig = scene(tmp_path, press_actions((0, "Map"), (0.6, other)))
    assert spoken_texts(rig) == ["Look at the map.", "We are here."]


def test_all_remaining_steps_end_if_one_of_them_needs_the_lane(tmp_path: Path) -> None:
    dance = action(
        "Dance", *say_actions("Now"), together(call("play", move="x")), *say_actions("Done")
    )
    rig = scene(tmp_path, press_actions((0, "Dance"), (0.6, "Wave")), (*ACTIONS[:6], dance))
    assert spoken_texts(rig) == ["Now"]
    assert isinstance(ends(rig)["Dance"], m.ActionSuperseded)


def test_feelings_and_steps_of_the_gaze_end_no_speech(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        rig.session.play("Feel", KEY)
        await asyncio.sleep(0.5)
        rig.session.play("Happy", KEY)
        rig.session.send("nudge", {"yaw": 5}, "", KEY)

    rig = scene(tmp_path, play)
    assert spoken_texts(rig) == ["I am", "so glad."]


def test_a_step_of_the_gaze_ends_what_only_looks_about(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        rig.session.play("Look about", KEY)
        await asyncio.sleep(1.5)
        rig.session.send("nudge", {"yaw": 5}, "", KEY)

    rig = scene(tmp_path, play)
    assert [args for verb, args in rig.driver().calls if verb == "gaze"] == [{"yaw": 1}]
    assert ends(rig)["Look about"].reason == 'replaced by "nudge"'


def test_what_is_refused_replaces_nothing(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        rig.session.play("Map", KEY)
        await asyncio.sleep(0.5)
        with pytest.raises(RequestError, match="still running"):
            rig.session.play("Gong", KEY)

    rig = scene(tmp_path, play)
    assert spoken_texts(rig) == ["Look at the map.", "We are here."]


def test_what_no_hand_asked_for_replaces_nothing(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        rig.session.play("Map", KEY)
        await asyncio.sleep(0.5)
        for source in ("engagement", "replay", "robot"):
            rig.session.send("say", {"text": source}, "", RequestOrigin(source))

    rig = scene(tmp_path, play)
    assert spoken_texts(rig)[-1] == "We are here."


def test_a_typed_sentence_replaces_what_is_still_to_be_said(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        rig.session.play("Map", KEY)
        await asyncio.sleep(0.5)
        rig.session.send("say", {"text": "typed"}, "", KEY)

    rig = scene(tmp_path, play)
    assert spoken_texts(rig) == ["Look at the map.", "typed"]
    over = ends(rig)["Map"]
    assert isinstance(over, m.ActionSuperseded)
    assert over.by == "c00002"


def test_the_timeline_counts_it_as_superseded(tmp_path: Path) -> None:
    rig = scene(tmp_path, press_actions((0, "Exhibit"), (0.6, "Repeat"), (3, "Exhibit")))
    timeline = Timeline()
    for line in rig.lines:
        timeline.apply(line)
    timeline.finish()
    outcomes = [each.outcome for each in timeline.of(Played)]
    assert outcomes == [EpisodeOutcome.SUPERSEDED, EpisodeOutcome.DONE, EpisodeOutcome.DONE]
