"""Repairs: the last sentence again, in other words, or no more of it."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import replace
from pathlib import Path

import pytest

from tests.session.rig import HERE, SessionRig
from tests.session.test_action_texts import HM, KEY, make_experiment
from woz_tui.config.experiment import Action
from woz_tui.features.delay.section import SHAPING, ResponseShaping
from woz_tui.features.profiles.in_session import ProfileInUse
from woz_tui.features.profiles.section import PROFILES, Profile
from woz_tui.features.repairs.section import INTERRUPT, LABELS, PANEL, REPEAT, REWORD
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError
from woz_tui.session.redactor import Redactor
from woz_tui.session.session_plan import study_settings

NAMES = (REPEAT, REWORD, INTERRUPT)
MOVES = tuple(Action(name, LABELS[name], "", PANEL, (), HERE) for name in NAMES)


def scene(tmp_path: Path, play: Callable[[SessionRig], Awaitable[None]]) -> SessionRig:
    made = replace(make_experiment(tmp_path), beside_panels=MOVES)
    return SessionRig(tmp_path, made=made).run(play, 10)


def spoken_texts(rig: SessionRig) -> list[m.Json]:
    return [args["text"] for verb, args in rig.driver().calls if verb == "say"]


def test_the_last_sentence_again_as_it_was_said(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        with pytest.raises(RequestError, match="nothing has been said"):
            rig.session.play(REPEAT, KEY)
        rig.session.play("Filler", KEY)
        await asyncio.sleep(2)
        rig.session.send("say", {"text": "typed {brace}"}, "", KEY)
        await asyncio.sleep(2)
        rig.session.set(trial=3)
        rig.session.play(REPEAT, KEY)
        await asyncio.sleep(2)
        rig.session.play(REPEAT, KEY)

    rig = scene(tmp_path, play)
    assert spoken_texts(rig)[1:] == ["typed {brace}"] * 3
    requests = rig.of(m.ActionRequested)
    assert [(line.action, line.panel) for line in requests[-2:]] == [(REPEAT, PANEL)] * 2


def test_a_file_that_gets_repairs_repeats_what_was_said_before(tmp_path: Path) -> None:
    plain = make_experiment(tmp_path)

    async def play(rig: SessionRig) -> None:
        rig.session.play("Hello", KEY)
        await asyncio.sleep(2)
        rig.session.adopt(replace(plain, beside_panels=MOVES), [])
        rig.session.play(REPEAT, KEY)

    rig = SessionRig(tmp_path, made=plain).run(play, 10)
    assert spoken_texts(rig)[-2:] == [spoken_texts(rig)[0]] * 2


def test_the_next_participant_hears_nothing_that_was_said_to_the_one_before(
    tmp_path: Path,
) -> None:
    async def play(rig: SessionRig) -> None:
        rig.session.play("Hello", KEY)
        await asyncio.sleep(2)
        rig.session.set("P08")
        for repair in (REPEAT, REWORD):
            with pytest.raises(RequestError, match="nothing has been said"):
                rig.session.play(repair, KEY)
        rig.session.play("Hello", KEY)
        await asyncio.sleep(2)
        rig.session.play(REPEAT, KEY)

    assert spoken_texts(scene(tmp_path, play)) == ["Hello P07", "Hello P08", "Hello P08"]


def test_other_words_until_there_are_none(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        rig.session.play("Filler", KEY)
        for _ in range(2):
            await asyncio.sleep(2)
            rig.session.play(REWORD, KEY)
        await asyncio.sleep(2)
        rig.session.play("Hello", KEY)
        await asyncio.sleep(2)
        with pytest.raises(RequestError, match="no other words"):
            rig.session.play(REWORD, KEY)

    said = spoken_texts(scene(tmp_path, play))
    assert sorted(map(str, said[:3])) == sorted(HM)
    assert said[3:] == ["Hello P07"]


def test_a_wizard_who_is_blind_does_not_read_what_is_repeated(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        rig.session.play("Greet", KEY)
        await asyncio.sleep(2)
        rig.session.play(REPEAT, KEY)

    rig = scene(tmp_path, play)
    again = rig.of(m.Command)[-1]
    assert (again.action, again.args) == (REPEAT, {"text": spoken_texts(rig)[0]})
    seen = Redactor(study_settings(rig.session.experiment)).message(again)
    assert isinstance(seen, m.Command)
    assert str(spoken_texts(rig)[0]) not in str(seen.args)


def test_an_interruption_ends_what_is_and_would_be_said_and_nothing_else(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        rig.session.send("drive", {"x": 1.0}, "", KEY)
        rig.session.play("Hello", KEY)
        rig.session.play("Welcome", KEY)
        rig.session.send("say", {"text": "typed"}, "", KEY)
        await asyncio.sleep(0.5)
        rig.session.play(INTERRUPT, KEY)

    rig = scene(tmp_path, play)
    assert spoken_texts(rig) == ["Hello P07"]
    ends = {line.action: type(line) for line in rig.of(m.ActionEnd)}
    assert ends == {"Hello": m.ActionStopped, "Welcome": m.ActionStopped, INTERRUPT: m.ActionDone}
    stopped = {line.reason for line in rig.of(m.Stopped)}
    assert stopped == {"interrupted by the wizard"}
    assert not rig.session.bus.latched


def test_an_interruption_lets_go_on_what_is_not_said(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        rig.session.play("Welcome", KEY)
        await asyncio.sleep(0.1)
        rig.session.play(INTERRUPT, KEY)

    rig = scene(tmp_path, play)
    ends = {line.command: type(line) for line in rig.of(m.End)}
    verbs = {line.command: line.verb for line in rig.of(m.Command)}
    assert {verbs[command]: end for command, end in ends.items()} == {
        "say": m.Stopped,
        "play": m.Done,
    }


def test_an_interruption_leaves_no_gesture_of_what_still_waits(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        rig.session.send("play", {"move": "wave"}, "", KEY)
        rig.session.play("Hello", KEY)
        rig.session.play("Welcome", KEY)
        await asyncio.sleep(0.1)
        rig.session.play(INTERRUPT, KEY)

    rig = scene(tmp_path, play)
    assert [args for verb, args in rig.driver().calls if verb == "play"] == [{"move": "wave"}]


def test_other_words_that_are_refused_use_no_wording_up(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        rig.session.play("Filler", KEY)
        await asyncio.sleep(2)
        rig.session.play("Hello", KEY)
        with pytest.raises(RequestError):
            rig.session.play(REWORD, KEY, "refuse")
        await asyncio.sleep(2)
        for _ in range(2):
            rig.session.play("Filler", KEY)
            await asyncio.sleep(2)

    said = spoken_texts(scene(tmp_path, play))
    assert sorted(map(str, [said[0], *said[2:]])) == sorted(HM)


def test_who_is_set_once_more_can_still_hear_it_again(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        rig.session.play("Hello", KEY)
        await asyncio.sleep(2)
        rig.session.set("P07", "warm", 3)
        rig.session.play(REPEAT, KEY)

    assert spoken_texts(scene(tmp_path, play)) == ["Hello P07"] * 2


def test_a_repetition_does_not_cross_a_change_of_condition(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        rig.session.play("Hello", KEY)
        await asyncio.sleep(2)
        rig.session.set(condition="cold")
        with pytest.raises(RequestError, match="nothing has been said"):
            rig.session.play(REPEAT, KEY)

    scene(tmp_path, play)


@pytest.mark.parametrize("at_us", [0, 2_000_000])
def test_an_interruption_ends_what_is_held_back(tmp_path: Path, at_us: int) -> None:
    async def play(rig: SessionRig) -> None:
        hub, now = rig.session.hub, rig.session.experiment
        shaping = ResponseShaping(2.0, 0.0, ("marker",))
        rig.session.adopt(replace(now, sections={**now.sections, SHAPING: shaping}), [])
        hub.publish(m.Marker(text="x"))
        at = hub.now() + at_us if at_us else 0
        rig.session.send("say", {"text": "typed"}, "", KEY, at=at)
        await asyncio.sleep(0.5)
        rig.session.play(INTERRUPT, KEY)

    rig = scene(tmp_path, play)
    assert spoken_texts(rig) == []
    (end,) = (line for line in rig.of(m.End))
    assert end.reason == "interrupted by the wizard"


def test_a_repair_for_a_later_moment_is_refused_and_the_log_has_it(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        with pytest.raises(RequestError, match="now") as caught:
            rig.session.play(REPEAT, KEY, at=rig.session.hub.now() + 1_000_000)
        assert not caught.value.command  # no key helps

    (action_refused,) = (
        line for line in scene(tmp_path, play).lines if isinstance(line, m.ActionRefused)
    )
    assert action_refused.action == REPEAT


def test_profiles_do_not_lock_repairs(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        rig.session.play("Hello", KEY)
        await asyncio.sleep(2)
        rig.session.features.of(ProfileInUse).use("child", "program")
        with pytest.raises(RequestError):
            rig.session.play("Hello", KEY)
        rig.session.play(REPEAT, KEY)

    async def with_profile(rig: SessionRig) -> None:
        rig.session.experiment = replace(
            rig.session.experiment, sections={PROFILES: {"child": Profile(name="child")}}
        )
        await play(rig)

    assert spoken_texts(scene(tmp_path, with_profile)) == ["Hello P07"] * 2


def test_typed_sentences_survive_a_reload(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        assert rig.session.add_typed_button("One moment", "")
        assert not rig.session.add_typed_button("One moment", "")
        rig.session.adopt(make_experiment(tmp_path), ["something"])
        rig.session.play("typed: One moment", KEY)

    assert spoken_texts(scene(tmp_path, play)) == ["One moment"]
