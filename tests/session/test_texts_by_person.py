"""Sentences that depend on who is addressed, and are kept from whom that is kept."""

from __future__ import annotations

import asyncio
from dataclasses import replace
from pathlib import Path

from tests.config.reading import errors, panel, read_experiment
from tests.session.engagement_rig import PLAIN, WIZARD, EngagementRig, guided, in_room
from tests.session.rig import action, call, together
from tests.session.test_engagement_visitors import stranger
from woz_tui.config.condition_texts import ANY
from woz_tui.config.experiment import ELSE, Experiment, TextVariants
from woz_tui.config.utterance_template import ADDRESS, AGE_GROUP
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError
from woz_tui.protocol.welcome import PerceptionView, StudySettings
from woz_tui.session.action_texts import utterances
from woz_tui.session.redactor import Redactor

WHALE = TextVariants({"child": ("Look, {visitor}!",), ELSE: ("This is a whale.",)}, AGE_GROUP)
FILE = (
    "{key: w, label: W, say: {by: visitor.age_group, child: 'Look, {visitor}!',"
    " else: {any: [A whale., This is a whale.]}}}"
)


def museum(folder: Path) -> Experiment:
    made = guided(folder, PLAIN)
    *others, last = made.panels
    more = (
        action("Whale", together(replace(call("say"), choices={"text": WHALE})), panel="Model"),
        action("Address", together(call("say", text=f"{{{ADDRESS}}}!")), panel="Model"),
    )
    return replace(made, panels=(*others, replace(last, actions=(*last.actions, *more))))


def spoken(rig: EngagementRig) -> list[str]:
    return [str(line.args["text"]) for line in rig.of(m.Command) if line.verb == "say"]


def test_a_child_hears_another_sentence_and_a_stranger_hears_one_too(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        rig.session.play("Whale", WIZARD)
        rig.tell("visitor", code="Anna", age_group="child")
        await asyncio.sleep(3)
        rig.session.play("Whale", WIZARD)
        await asyncio.sleep(3)
        prepared = [args["text"] for args in utterances_of(rig)]
        assert [text for text in prepared if "whale" in str(text) or "Anna!" in str(text)] == [
            "Look, Anna!",
            "This is a whale.",
        ]
        try:
            rig.session.play("Address", WIZARD)
        except RequestError as error:
            told = error
        assert "{visitor.address} has no value yet" in told.reason
        rig.tell("visitor", code="Anna", address="informal")
        await asyncio.sleep(1)
        rig.session.play("Address", WIZARD)
        await asyncio.sleep(3)

    rig = in_room(tmp_path, stranger(scenario), museum(tmp_path))
    assert spoken(rig) == ["This is a whale.", "Look, Anna!", "informal!"]
    command = next(line for line in rig.of(m.Command) if line.args.get("text") == "Look, Anna!")
    assert (command.tells, command.unfilled) == (("identity",), {"text": "..."})


def utterances_of(rig: EngagementRig) -> list[dict[str, m.Json]]:
    prepared = utterances(rig.session.experiment, rig.session.values())
    return [dict(args) for args in prepared["robot"]]


def test_who_may_not_know_who_is_there_is_shown_no_such_sentence(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        rig.tell("visitor", code="Anna", age_group="child", address="informal")
        await asyncio.sleep(2)
        rig.session.play("Whale", WIZARD)
        rig.session.play("Address", WIZARD)
        await asyncio.sleep(5)

    rig = in_room(tmp_path, stranger(scenario), museum(tmp_path))
    blind = Redactor(StudySettings(perception=PerceptionView(hide=["identity"])))
    seen = [str(blind.message(line)) for line in rig.of(m.Command, m.ActionsFilled)]
    seen = [text for text in seen if "verb='visitor'" not in text]
    assert not [text for text in seen if "Anna" in text or "informal" in text]


def test_a_file_says_by_what_and_has_something_for_everybody_else(tmp_path: Path) -> None:
    text = panel(FILE) + "engagement: {}\n"
    choice = read_experiment(tmp_path, text).panels[0].actions[0].calls[0].choices["text"]
    assert choice.by == AGE_GROUP
    assert choice.texts == {
        "child": ("Look, {visitor}!",),
        ELSE: ("A whale.", "This is a whale."),
    }
    assert ANY not in choice.texts
    wrong = errors(tmp_path, panel(FILE))[0]
    assert "nothing is known of people here by which a text could be chosen" in wrong
    without = panel("{label: W, say: {by: visitor.age_group, child: Hi}}") + "engagement: {}\n"
    [wrong] = errors(tmp_path, without)
    assert "needs a text for everybody else: else: ..." in wrong
    [wrong] = errors(tmp_path, without.replace("age_group", "agegroup"))
    assert "did you mean 'visitor.age_group'?" in wrong
