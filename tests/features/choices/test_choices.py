"""Choices: offered by an action, made on a page, and what comes of them."""

from __future__ import annotations

import base64
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace
from pathlib import Path

import pytest

from tests.features.page.rig import pages
from tests.features.page.test_watch_page import texts
from tests.host.rig import Peer, ServedSession, served_session
from tests.session.rig import action, call, experiment, together
from tests.session.study_rig import PLANNED, study_experiment
from woz_tui.config.experiment import Experiment, Panel, TextVariants
from woz_tui.config.study import PerceptionLimits, Study
from woz_tui.features.choices.kinds import ChoiceGone, ChoiceMade, ChoiceOffered
from woz_tui.features.choices.section import CHOICES, Choice, Option
from woz_tui.features.slots.notes import HeardWords
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m
from woz_tui.timeline.session_state import SessionState

OFFER = action("Offer", together(call("choice", driver="choices", name="colour")))
TAKE = action("Take", together(call("choice", driver="choices", name="off")))


def offering(made: Experiment, *more: Choice, offer: object = OFFER) -> Experiment:
    """The same with a choice, which an action offers; one of its options plays another."""
    picture = made.path.parent / "blue.png"
    picture.write_bytes(b"\x89PNG of blue")
    colour = Choice(
        "colour",
        (Option("Red", plays="Welcome"), Option("Blue", picture=str(picture))),
        "Which colour?",
    )
    panel = Panel("Page", (offer, TAKE), made.panels[0].place)  # type: ignore[arg-type]
    sections = {**made.sections, CHOICES: (colour, *more)}
    return replace(made, panels=(*made.panels, panel), sections=sections)


class Stage:
    """A session with a wizard and somebody before a page."""

    def __init__(self, host: ServedSession, wizard: Peer, page: Peer) -> None:
        self.host, self.wizard, self.page = host, wizard, page

    async def offer(self) -> int:
        """The wizard offers it; its number."""
        assert (await self.wizard.ask("action", action="Offer"))["ok"]
        offered: int = (await self.page.kind("choice.offered"))["seq"]
        return offered


@asynccontextmanager
async def on_stage(made: Experiment) -> AsyncIterator[Stage]:
    async with served_session(made.path.parent, made=made) as host:
        wizard, page = await host.connect(), await host.connect()
        await wizard.hello("wizard")
        await page.hello("participant")
        yield Stage(host, wizard, page)


async def test_what_is_chosen_is_logged_and_plays_what_the_file_says(tmp_path: Path) -> None:
    async with on_stage(offering(experiment(tmp_path))) as stage:
        offer = await stage.offer()
        reply = await stage.page.ask("choose", offer=offer, option="Red", after_us=1_500_000)
        assert reply["ok"]
        [offered], [made] = stage.host.of(ChoiceOffered), stage.host.of(ChoiceMade)
        assert (offered.question, offered.options, offered.pictures) == (
            "Which colour?",
            ["Red", "Blue"],
            ["", "blue.png"],
        )
        assert (made.choice, made.option, made.after_us) == ("colour", "Red", 1_500_000)
        played = [line for line in stage.host.of(m.ActionRequested) if line.action == "Welcome"]
        assert [line.source for line in played] == ["participant"]


async def test_only_what_is_seen_can_be_chosen_and_once(tmp_path: Path) -> None:
    async with on_stage(offering(experiment(tmp_path))) as stage:
        first = await stage.offer()
        second = await stage.offer()
        assert [line.how for line in stage.host.of(ChoiceGone)] == ["replaced"]
        for offer, option in ((first, "Red"), (second, "Green")):
            assert not (await stage.page.ask("choose", offer=offer, option=option))["ok"]
        assert (await stage.page.ask("choose", offer=second, option="Blue"))["ok"]
        assert not (await stage.page.ask("choose", offer=second, option="Red"))["ok"]
        assert [line.option for line in stage.host.of(ChoiceMade)] == ["Blue"]
        assert not [line for line in stage.host.of(m.ActionRequested) if line.action == "Welcome"]


async def test_a_stop_holds_for_what_a_choice_plays(tmp_path: Path) -> None:
    async with on_stage(offering(experiment(tmp_path))) as stage:
        offer = await stage.offer()
        await stage.wizard.ask("stop")
        assert (await stage.page.ask("choose", offer=offer, option="Red"))["ok"]
        [refused] = stage.host.of(m.ActionRefused)
        assert "stop" in refused.reason
        assert not [line for line in stage.host.of(m.Command) if line.action == "Welcome"]


async def test_the_wizard_takes_it_back_and_another_participant_has_none(tmp_path: Path) -> None:
    async with on_stage(offering(experiment(tmp_path))) as stage:
        await stage.offer()
        await stage.wizard.ask("action", action="Take")
        await stage.page.kind("choice.gone")
        await stage.offer()
        await stage.wizard.ask("set", participant="P09")
        await stage.page.kind("choice.gone")
        assert [line.how for line in stage.host.of(ChoiceGone)] == ["taken_back", "moved_on"]


async def test_a_page_that_comes_later_has_it_and_its_picture(tmp_path: Path) -> None:
    async with on_stage(offering(experiment(tmp_path))) as stage:
        offer = await stage.offer()
        later = await stage.host.connect()
        welcome = await later.hello("participant")
        assert [line["options"] for line in welcome["state"] if line["kind"] == "choice.offered"]
        data = (await later.ask("choice.picture", offer=offer, place=1))["data"]
        assert (data["type"], base64.b64decode(data["bytes"])) == ("image/png", b"\x89PNG of blue")
        for asked in ({"offer": offer, "place": 2}, {"offer": offer - 1, "place": 1}):
            assert not (await later.ask("choice.picture", **asked))["ok"]


async def test_that_nobody_has_the_page_open_is_said(tmp_path: Path) -> None:
    async with served_session(tmp_path, made=offering(experiment(tmp_path))) as host:
        wizard = await host.connect()
        await wizard.hello("wizard")
        await wizard.ask("action", action="Offer")
        said = await wizard.until(lambda line: line.get("level") == "warning")
        assert said["text"] == "nobody has the participant's page open to see the choice colour"
        watcher = await host.connect()
        await watcher.hello("watcher")
        [offered] = host.of(ChoiceOffered)
        assert not (await watcher.ask("choose", offer=offered.seq, option="Red"))["ok"]


@pytest.mark.parametrize(
    "limits", [PerceptionLimits(("transcript",)), PerceptionLimits((), ("transcript",))]
)
async def test_who_may_not_hear_people_does_not_read_what_they_chose(
    tmp_path: Path, limits: PerceptionLimits
) -> None:
    made = offering(study_experiment(tmp_path, Study(perception=limits)))
    async with on_stage(made) as stage:
        offer = await stage.offer()
        await stage.page.ask("choose", offer=offer, option="Blue")
        seen = await stage.wizard.kind("choice.made")
        assert "Blue" not in str(seen)
        assert [line.option for line in stage.host.of(ChoiceMade)] == ["Blue"]


async def test_a_choice_that_depends_on_the_condition_is_nothing_for_the_blind(
    tmp_path: Path,
) -> None:
    variants = TextVariants({"warm": ("colour",), "cold": ("shade",)})
    offer = action("Offer", together(replace(OFFER.calls[0], args={}, choices={"name": variants})))
    shade = Choice("shade", (Option("Grey"),))
    made = offering(study_experiment(tmp_path, design=PLANNED), shade, offer=offer)
    async with on_stage(made) as stage:
        await stage.wizard.ask("assign", participant="P01", order=["A", "B"])
        await stage.wizard.ask("trial", what="begin")
        number = await stage.offer()
        await stage.page.ask(
            "choose", offer=number, option=stage.host.of(ChoiceOffered)[0].options[0]
        )
        seen = await stage.wizard.kind("choice.made")
        assert "option" not in seen or not seen["option"]
        assert not [line for line in stage.wizard.seen if line["kind"] == "choice.offered"]
        assert "condition" in stage.host.of(ChoiceOffered)[0].tells


async def test_each_of_two_choices_at_once_tells_what_its_own_command_does(tmp_path: Path) -> None:
    variants = TextVariants({"warm": ("colour",), "cold": ("shade",)})
    offer = action("Offer", together(replace(OFFER.calls[0], args={}, choices={"name": variants})))
    shade = Choice("shade", (Option("Grey"),))
    made = offering(study_experiment(tmp_path, design=PLANNED), shade, offer=offer)
    async with on_stage(made) as stage:
        await stage.wizard.ask("assign", participant="P01", order=["A", "B"])
        await stage.wizard.ask("trial", what="begin")
        origin = RequestOrigin("key", "o", "con1")
        stage.host.session.play("Offer", origin)
        stage.host.session.send("choice", {"name": "colour"}, "choices", origin)
        for _ in range(2):
            await stage.page.kind("choice.offered")
        assert ["condition" in line.tells for line in stage.host.of(ChoiceOffered)] == [True, False]


async def test_who_watches_reads_what_is_offered_and_chosen(tmp_path: Path) -> None:
    made = offering(experiment(tmp_path))
    async with on_stage(made) as stage, pages(stage.host) as rig:
        watcher = await rig.watcher()
        async with watcher.news("/watch/news") as reader:
            offer = await stage.offer()
            await reader.until(lambda view: "Offered: Which colour? Red, Blue" in texts(view))
            await stage.page.ask("choose", offer=offer, option="Blue")
            await reader.until(lambda view: "Chosen: Blue" in texts(view))


def test_a_slot_that_hears_takes_what_was_chosen() -> None:
    notes = HeardWords(SessionState())
    notes.apply(m.SpeechText(driver="ears", segment=1, text="I like the whale", own=False))
    notes.apply(ChoiceMade(choice="colour", option="Dark red"))
    assert notes.words == ("Dark red",)
    notes.apply(ChoiceMade(choice="colour", option=""))  # kept from this wizard
    assert notes.words == ("Dark red",)
