"""What actions say: by condition, in variants, and what consoles are told before it is played."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec import structs

from tests.session.rig import SessionRig, action, call, experiment, together
from woz_tui.config.experiment import Call, Experiment, TextVariants
from woz_tui.config.screen_language import use, word
from woz_tui.features.study.design import Design
from woz_tui.features.study.section import DESIGN
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError
from woz_tui.replay.rerun_plan import plan_of
from woz_tui.session.action_texts import variant
from woz_tui.session.participant_identity import SessionIdentity
from woz_tui.session.redactor import Redactor
from woz_tui.session.session_plan import study_settings

KEY = RequestOrigin("key", "h", "con1")
HM = ("Hm.", "Let me think.", "Well, well.")
GREETINGS = {"warm": ("How nice, {participant}!", "Welcome!"), "cold": ("Hello.",)}


def chosen(texts: Mapping[str, tuple[str, ...]]) -> Call:
    return replace(call("say"), choices={"text": TextVariants(texts)})


def make_experiment(folder: Path) -> Experiment:
    plain = experiment(folder)
    speech, *rest = plain.panels
    more = (
        action("Greet", together(chosen(GREETINGS), call("play", move="nod"))),
        action("Filler", together(chosen({"": HM}))),
    )
    return replace(
        plain,
        panels=(replace(speech, actions=(*speech.actions, *more)), *rest),
        conditions=("warm", "cold"),
        sections={DESIGN: Design(blind={"warm": "A", "cold": "B"})},
    )


class PlayedActions(SessionRig):
    """A session that plays one action after the other, and what came of it."""

    async def play(self, *names: str) -> list[str]:
        before = len(self.spoken_texts)
        for name in names:
            self.session.play(name, KEY)
            await asyncio.sleep(3)
        return self.spoken_texts[before:]

    @property
    def spoken_texts(self) -> list[str]:
        return [str(args["text"]) for verb, args in self.driver().calls if verb == "say"]

    def shown_text(self, name: str) -> str:
        """What consoles were told that the action says."""
        filled = self.session.state.filled
        assert filled is not None
        step = filled.actions[name][0]
        assert isinstance(step, list)
        return str(step[0].args["text"])


def on_stage(
    folder: Path,
    scenario: Callable[[PlayedActions], Awaitable[None]],
    identity: SessionIdentity | None = None,
) -> PlayedActions:
    who = identity or SessionIdentity(participant="P07", seed=5)
    return PlayedActions(folder, identity=who, made=make_experiment(folder)).run(scenario)


# -- variants ------------------------------------------------------------------------------------


@given(st.text(max_size=8), st.integers(2, 12), st.integers(0, 60))
def test_no_variant_comes_again_before_all_were_used(key: str, size: int, turns: int) -> None:
    first = turns * size
    assert sorted(variant(key, first + n, size) for n in range(size)) == [*range(size)]


@given(st.text(max_size=8), st.integers(2, 12), st.integers(0, 400))
def test_no_variant_comes_twice_in_a_row(key: str, size: int, count: int) -> None:
    assert variant(key, count, size) != variant(key, count + 1, size)


def test_what_was_shown_is_what_is_played(tmp_path: Path) -> None:
    async def scenario(rig: PlayedActions) -> None:
        for _ in range(7):
            shown = rig.shown_text("Filler")
            assert await rig.play("Filler") == [shown]
        assert {*rig.spoken_texts[:3]} == {*HM}

    on_stage(tmp_path, scenario)


def test_the_order_is_that_of_seed_participant_and_action(tmp_path: Path) -> None:
    orders: list[list[str]] = []

    async def scenario(rig: PlayedActions) -> None:
        orders.append(await rig.play(*["Filler"] * 6))
        rig.session.set(participant="P08")
        orders.append(await rig.play(*["Filler"] * 6))
        rig.session.set(participant="P07")
        orders.append(await rig.play(*["Filler"] * 6))

    on_stage(tmp_path / "one", scenario)
    on_stage(tmp_path / "again", scenario)
    first, other, anew = orders[:3]
    assert first == anew
    assert first != other
    assert orders[3:] == orders[:3]


def test_what_is_refused_uses_no_variant_up(tmp_path: Path) -> None:
    async def scenario(rig: PlayedActions) -> None:
        shown = rig.shown_text("Filler")
        rig.session.stop("key")
        with pytest.raises(RequestError):
            rig.session.play("Filler", KEY)
        await asyncio.sleep(1)
        rig.session.release("key")
        assert await rig.play("Filler") == [shown]

    on_stage(tmp_path, scenario)


def test_a_press_that_the_robot_has_no_time_for_uses_no_variant_up(tmp_path: Path) -> None:
    async def scenario(rig: PlayedActions) -> None:
        rig.session.play("Hello", KEY)
        shown = rig.shown_text("Filler")
        with pytest.raises(RequestError):
            rig.session.play("Filler", KEY, "refuse")
        assert rig.shown_text("Filler") == shown
        await asyncio.sleep(2)
        assert await rig.play("Filler") == [shown]

    on_stage(tmp_path, scenario)


def test_a_part_that_is_played_alone_leaves_the_whole_action_shown(tmp_path: Path) -> None:
    async def scenario(rig: PlayedActions) -> None:
        rig.session.set(condition="warm")
        whole = rig.session.experiment.action("Greet")
        assert whole is not None
        part = replace(whole, steps=(together(whole.calls[0]),))
        rig.session.texts.play(part)
        assert rig.session.state.filled is not None
        (step,) = rig.session.state.filled.actions["Greet"]
        assert isinstance(step, list)
        assert [each.verb for each in step] == ["say", "play"]

    on_stage(tmp_path, scenario)


# -- conditions ----------------------------------------------------------------------------------


def test_why_a_text_has_to_wait_is_worded(tmp_path: Path) -> None:
    async def scenario(rig: PlayedActions) -> None:
        with pytest.raises(RequestError) as caught:
            await rig.play("Greet")
        use("de")
        waits = "sein text hängt von der Bedingung ab, und es ist keine Bedingung gesetzt"
        assert word(caught.value.reason) == waits

    try:
        on_stage(tmp_path, scenario)
    finally:
        use("en")


def test_a_text_follows_the_condition(tmp_path: Path) -> None:
    async def scenario(rig: PlayedActions) -> None:
        with pytest.raises(RequestError) as caught:
            await rig.play("Greet")
        assert "depends on the condition, and no condition is set" in caught.value.reason
        assert rig.shown_text("Greet") == "..."
        rig.session.set(condition="cold")
        assert rig.shown_text("Greet") == "Hello."
        assert await rig.play("Greet", "Greet") == ["Hello.", "Hello."]
        rig.session.set(condition="warm")
        assert {*await rig.play("Greet", "Greet")} == {"How nice, P07!", "Welcome!"}

    on_stage(tmp_path, scenario)


def test_a_variable_without_a_value_is_shown_as_it_is_written(tmp_path: Path) -> None:
    async def scenario(rig: PlayedActions) -> None:
        assert rig.shown_text("Hello") == "Hello {participant}"
        rig.session.set(participant="P09")
        assert rig.shown_text("Hello") == "Hello P09"

    on_stage(tmp_path, scenario, SessionIdentity())


def test_a_reload_tells_the_new_texts_and_forgets_what_is_gone(tmp_path: Path) -> None:
    async def scenario(rig: PlayedActions) -> None:
        now = rig.session.experiment
        speech = replace(
            now.panels[0], actions=(action("Filler", together(chosen({"": ("Oh!",)}))),)
        )
        rig.session.adopt(replace(now, panels=(speech,)), [])
        assert rig.shown_text("Filler") == "Oh!"
        assert rig.session.state.filled is not None
        assert [*rig.session.state.filled.actions] == ["Filler"]

    on_stage(tmp_path, scenario)


def test_a_blind_wizard_is_told_the_same_in_every_condition(tmp_path: Path) -> None:
    """Neither what is told nor how often may differ."""
    told: dict[str, list[m.Message | None]] = {}
    for condition in ("warm", "cold"):

        async def scenario(rig: PlayedActions, condition: str = condition) -> None:
            await rig.play("Greet", "Greet", "Filler")
            redactor = Redactor(study_settings(rig.session.experiment))
            told[condition] = [replaced(redactor.message(line)) for line in rig.of(m.ActionsFilled)]

        who = SessionIdentity(participant="P07", condition=condition, seed=5)
        on_stage(tmp_path / condition, scenario, who)
    assert told["warm"] == told["cold"]
    text = repr(told).casefold()
    assert "let me think" in text
    assert "nod" in text
    assert "welcome!" not in text
    assert "'hello.'" not in text


def replaced(line: m.Message | None) -> m.Message | None:
    """Without its time, which no test decides."""
    return structs.replace(line, t=0, ts="", seq=0) if line is not None else None


def test_a_re_run_plays_the_texts_of_its_log(tmp_path: Path) -> None:
    async def scenario(rig: PlayedActions) -> None:
        await rig.play("Filler", "Greet", "Filler", "Filler")

    who = SessionIdentity(participant="P07", condition="warm", seed=5)
    rig = on_stage(tmp_path, scenario, who)
    plan = plan_of(rig.recorder.path)
    texts = [step.command.args["text"] for step in plan.sent if step.command.verb == "say"]
    assert texts == rig.spoken_texts
    assert len({*texts}) == 4
