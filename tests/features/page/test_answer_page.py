"""The participant's page: forms that work without JavaScript, each sent answer counted once."""

from __future__ import annotations

import asyncio
import re
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from html import unescape
from pathlib import Path

import pytest

from tests.features.page.rig import PageRig, WebBrowser, pages
from tests.host.rig import Peer, ServedSession, served_session
from tests.session.study_rig import STUDY, study_experiment
from woz_tui.features.page.item_forms import ITEM_FORMS, UnreadAnswerError, answer_of, kind_of
from woz_tui.features.questionnaires.kinds import QuestionnaireAnswered, QuestionnaireEnded
from woz_tui.features.questionnaires.section import QUESTIONNAIRES, Asked
from woz_tui.protocol import messages as m
from woz_tui.protocol.welcome import (
    ENGLISH,
    ItemCondition,
    ItemLabel,
    Questionnaire,
    QuestionnaireItem,
)
from woz_tui.system.clock import RealClock

UX = Questionnaire(
    "ux",
    "How was <it>?",
    introduction="There are no wrong answers.",
    when="hand",
    items=(
        QuestionnaireItem("pleasant", "How pleasant was it?", 1, 5, ("not at all", "very")),
        QuestionnaireItem("load", "How much work?", 0, 100),
        QuestionnaireItem("else", "Anything else?", text=True, optional=True),
    ),
)


class Clock(RealClock):
    """The server's clock, as far as it measures how long something was shown."""

    ahead_us = 0

    def now_us(self) -> int:
        return super().now_us() + self.ahead_us


class Stage:
    """A session with a wizard and a questionnaire, and pages of it."""

    def __init__(self, host: ServedSession, rig: PageRig, wizard: Peer) -> None:
        self.host, self.rig, self.wizard = host, rig, wizard

    async def begin(self, browser: WebBrowser) -> str:
        """The wizard begins the questionnaire; the page behind its introduction."""
        await shows(browser, "Please wait.")
        reply = await self.wizard.ask("questionnaire", questionnaire="ux", what="begin")
        assert reply["ok"]
        page = await shows(browser, "There are no wrong answers.")
        return await send(browser, page, what="begin")

    def answers(self) -> list[tuple[str, float | None, str, bool]]:
        """What the session has taken."""
        return [
            (line.item, line.value, line.text, line.skipped)
            for line in self.host.lines
            if isinstance(line, QuestionnaireAnswered)
        ]


@asynccontextmanager
async def on_stage(
    tmp_path: Path, clock: Clock | None = None, asked: Questionnaire = UX
) -> AsyncIterator[Stage]:
    made = study_experiment(tmp_path, STUDY, {QUESTIONNAIRES: Asked((asked,))})
    async with served_session(tmp_path, made=made) as host, pages(host, clock=clock) as rig:
        wizard = await host.connect()
        await wizard.hello("wizard")
        yield Stage(host, rig, wizard)


async def shows(browser: WebBrowser, wanted: str) -> str:
    """The page, once it says this: a stream tells when it is to be loaded anew."""
    async with browser.news("/answer/news") as reader:
        while True:
            status, page = await browser.get("/answer")
            assert status == 200
            if wanted in unescape(page):
                return page
            await reader.more()


async def send(browser: WebBrowser, page: str, **fields: str) -> str:
    """Fill in the form of a page and send it; the page behind it."""
    hidden = dict(re.findall(r'<input type="hidden" name="(\w+)" value="([^"]*)">', page))
    status, after = await browser.post("/answer", **{**hidden, **fields})
    assert status == 200
    return after


async def test_from_waiting_to_thank_you(tmp_path: Path) -> None:
    async with on_stage(tmp_path) as stage:
        browser = await stage.rig.participant()
        page = await stage.begin(browser)
        assert "How pleasant was it?" in page
        assert "1 of 3" in page
        page = await send(browser, page, what="answer", value="4")
        assert "How much work?" in page
        page = await send(browser, page, what="answer", value="70")
        assert "Anything else?" in page
        page = await send(browser, page, what="skip")
        for said in ("How pleasant was it?", "70", "left out", "These answers are correct: finish"):
            assert said in page
        assert await send(browser, page, what="done")
        await shows(browser, "Thank you!")
        assert stage.answers() == [
            ("pleasant", 4.0, "", False),
            ("load", 70.0, "", False),
            ("else", None, "", True),
        ]
        ended = [line for line in stage.host.lines if isinstance(line, QuestionnaireEnded)]
        assert [(line.reason, line.answered) for line in ended] == [("done", 2)]


async def test_a_page_that_is_loaded_anew_goes_on_where_it_was(tmp_path: Path) -> None:
    """Also on another tablet, and in the middle."""
    async with on_stage(tmp_path) as stage:
        first = await stage.rig.participant()
        page = await stage.begin(first)
        await send(first, page, what="answer", value="4")
        assert "How much work?" in (await first.get("/answer"))[1]
        second = await stage.rig.participant()
        page = await shows(second, "How much work?")
        await send(second, page, what="answer", value="1")
        await shows(first, "Anything else?")


async def test_a_form_that_is_sent_twice_counts_once(tmp_path: Path) -> None:
    async with on_stage(tmp_path) as stage:
        browser = await stage.rig.participant()
        page = await stage.begin(browser)
        after = await asyncio.gather(
            *(send(browser, page, what="answer", value="4") for _ in range(5))
        )
        assert all("How much work?" in each for each in after)
        assert stage.answers() == [("pleasant", 4.0, "", False)]


async def test_an_answer_can_be_changed(tmp_path: Path) -> None:
    async with on_stage(tmp_path) as stage:
        browser = await stage.rig.participant()
        page = await stage.begin(browser)
        await send(browser, page, what="answer", value="4")
        _, page = await browser.get("/answer?item=pleasant")
        assert re.search(r'value="4" required checked', page)
        await send(browser, page, what="answer", value="2")
        assert [value for _, value, _, _ in stage.answers()] == [4.0, 2.0]


async def test_what_is_no_answer_is_said_and_not_sent(tmp_path: Path) -> None:
    async with on_stage(tmp_path) as stage:
        browser = await stage.rig.participant()
        page = await stage.begin(browser)
        for value in ("", "6", "many", "2.5"):
            page = await send(browser, page, what="answer", value=value)
            assert "A number from 1 to 5, please." in page
        page = await send(browser, page, what="skip")  # it is not optional
        assert "This answer was not taken." in page
        page = await send(browser, page, what="answer", value="5", item="nothing")
        assert "How pleasant was it?" in page
        assert stage.answers() == []


async def test_who_does_not_want_to_is_asked_once_more(tmp_path: Path) -> None:
    async with on_stage(tmp_path) as stage:
        browser = await stage.rig.participant()
        await stage.begin(browser)
        _, page = await browser.get("/answer?stop")
        assert "Stop here and leave the rest unanswered?" in page
        await send(browser, page, what="declined")
        await shows(browser, "Thank you!")
        ended = [line for line in stage.host.lines if isinstance(line, QuestionnaireEnded)]
        assert [line.reason for line in ended] == ["declined"]


async def test_a_form_of_another_round_is_not_taken(tmp_path: Path) -> None:
    async with on_stage(tmp_path) as stage:
        browser = await stage.rig.participant()
        page = await stage.begin(browser)
        await stage.wizard.ask("questionnaire", questionnaire="ux", what="left")
        await shows(browser, "Please wait.")
        await stage.wizard.ask("questionnaire", questionnaire="ux", what="begin")
        await shows(browser, "There are no wrong answers.")
        await send(browser, page, what="answer", value="4")
        assert stage.answers() == []


@pytest.mark.parametrize(
    ("took", "shown_s", "told"),
    [
        ("1500", 10, 1_500_000),
        ("99000", 10, 10_000_000),
        (None, 10, 10_000_000),
        ("x", 3, 3_000_000),
    ],
)
async def test_how_long_it_took_is_by_the_clock_of_the_page(
    tmp_path: Path, took: str | None, shown_s: int, told: int
) -> None:
    """But not longer than since it was given away, and loading it anew begins nothing anew."""
    clock = Clock()
    async with on_stage(tmp_path, clock) as stage:
        browser = await stage.rig.participant()
        page = await stage.begin(browser)
        clock.ahead_us += shown_s * 1_000_000
        _, again = await browser.get("/answer")
        before = re.search(r'name="before" value="(\d+)"', again)
        assert before is not None
        assert int(before[1]) >= shown_s * 1000
        await send(browser, page, what="answer", value="4", **({"took": took} if took else {}))
        line = next(line for line in stage.host.lines if isinstance(line, QuestionnaireAnswered))
        assert told <= line.answered_us <= told + 5_000_000 * (line.answered_us != told)


async def test_a_session_that_does_not_answer_keeps_the_form(tmp_path: Path) -> None:
    async with on_stage(tmp_path) as stage:
        browser = await stage.rig.participant()
        page = await stage.begin(browser)
        await stage.host.host.close()
        await shows(browser, "Just a moment, please.")
        hidden = dict(re.findall(r'<input type="hidden" name="(\w+)" value="([^"]*)">', page))
        status, said = await browser.post("/answer", **hidden, what="answer", value="4")
        assert status == 503
        assert ENGLISH.not_sent in said


async def test_a_stop_is_said_and_nothing_on_the_page_stops(tmp_path: Path) -> None:
    async with on_stage(tmp_path) as stage:
        browser = await stage.rig.participant()
        await stage.begin(browser)
        await stage.wizard.ask("stop")
        page = await shows(browser, "The robot has been stopped.")
        assert "How pleasant was it?" in page
        await send(browser, page, what="stop")
        assert sum(isinstance(line, m.StopPressed) for line in stage.host.lines) == 1


async def test_what_the_file_says_is_text(tmp_path: Path) -> None:
    async with on_stage(tmp_path) as stage:
        browser = await stage.rig.participant()
        page = await stage.begin(browser)
        assert "How was &lt;it&gt;?" in page
        await send(browser, page, what="answer", value="4")
        _, page = await browser.get("/answer?item=else")
        await send(browser, page, what="answer", text="</textarea><script>alert(1)</script>\r\nbye")
        assert stage.answers()[-1][2] == "</textarea><script>alert(1)</script>\nbye"
        _, page = await browser.get("/answer?item=else")
        assert "&lt;/textarea&gt;&lt;script&gt;" in page


async def test_each_browser_is_a_participant_of_its_own_and_few_are_taken(tmp_path: Path) -> None:
    async with on_stage(tmp_path) as stage:
        for _ in range(10):
            assert (await (await stage.rig.participant()).get("/answer"))[0] == 200
        await stage.host.until(
            lambda: sum(isinstance(line, m.ConsoleLost) for line in stage.host.lines) == 2
        )
        there = [each.role for each in stage.host.session.state.consoles.values()]
        assert there.count("participant") == 8


def test_every_kind_of_item_has_a_form() -> None:
    kinds = {
        **{each: QuestionnaireItem("a", kind=each) for each in ("month", "page")},
        **{
            each: QuestionnaireItem("a", kind=each, choices=(ItemLabel(1, "a"), ItemLabel(2, "b")))
            for each in ("choice", "choices")
        },
        "scale": QuestionnaireItem("a", low=0, high=20),
        "number": QuestionnaireItem("a", low=0, high=100),
        "text": QuestionnaireItem("a", text=True),
    }
    assert {*kinds} == {*ITEM_FORMS}
    for kind, item in kinds.items():
        assert kind_of(item) == kind
        with pytest.raises(UnreadAnswerError):
            answer_of(item, {}, ENGLISH)


YES_NO = (ItemLabel(1, "yes"), ItemLabel(2, "no"))
KINDS = Questionnaire(
    "ux",
    introduction="There are no wrong answers.",
    when="hand",
    items=(
        QuestionnaireItem("page-1", "Think of the last task.", kind="page"),
        QuestionnaireItem(
            "natural", "", -3, 3, ("fake", "natural"), stem="It was", shift=4, flipped=True
        ),
        QuestionnaireItem("effort", "Effort?", 0, 100, ("low", "high"), kind="slider", step=5),
        QuestionnaireItem(
            *("often", "How often?", 1, 3, ("never", "always")),
            labels=(ItemLabel(1, "never"), ItemLabel(2, "at times"), ItemLabel(3, "always")),
            numbers=False,
            does_not_apply="does not fit",
        ),
        QuestionnaireItem("known", "Used one?", kind="choice", choices=YES_NO),
        QuestionnaireItem(
            *("which", "Which?"),
            kind="choices",
            choices=(ItemLabel(1, "mower"), ItemLabel(5, "toy"), ItemLabel(6, "other")),
            other=6,
            only_if=ItemCondition("known", (1,)),
        ),
        QuestionnaireItem("never", "Why not?", text=True, only_if=ItemCondition("known", (2,))),
        QuestionnaireItem("age", "How old?", 18, 99, kind="number", unit="years", soft=True),
        QuestionnaireItem("since", "Since when?", kind="month"),
    ),
)


async def test_items_of_every_kind_without_javascript(tmp_path: Path) -> None:
    async with on_stage(tmp_path, asked=KINDS) as stage:
        browser = await stage.rig.participant()
        page = await stage.begin(browser)
        assert "Think of the last task." in page
        page = await send(browser, page, what="seen")
        assert "It was fake - natural" in page
        assert page.index("1: natural") < page.index("7: fake")  # the other way round
        page = await send(browser, page, what="answer", value="2")
        assert 'value="5"' in page
        assert 'value="6"' not in page
        page = await send(browser, page, what="answer", value="12")
        assert "In steps of 5, please: 10 or 15." in page
        page = await send(browser, page, what="answer", value="15")
        assert "at times" in page
        page = await send(browser, page, what="does_not_apply")
        page = await send(browser, page, what="answer", value="1")
        page = await send(browser, page, what="answer")
        assert "Please choose at least one of these." in page
        page = await send(browser, page, what="answer", choice1="1", choice6="6")
        assert "Please say which:" in page
        page = await send(browser, page, what="answer", choice1="1", choice6="6", text="vacuum")
        assert ("How old?" in page, "Leave out" in page) == (True, False)
        page = await send(browser, page, what="answer", value="")
        assert ENGLISH.soft_button in page
        page = await send(browser, page, what="skip")
        page = await send(browser, page, what="answer", text="2026-13")
        assert ENGLISH.month in page
        page = await send(browser, page, what="answer", text="2026-11")
        for said in ("2", "15", "does not fit", "yes", "mower, other: vacuum", "left out"):
            assert f">{said}<" in page or f"{said} " in page, said
        assert "Why not?" not in page
        await send(browser, page, what="done")
        await shows(browser, "Thank you!")
    told = [line for line in stage.host.lines if isinstance(line, QuestionnaireAnswered)]
    assert [(line.item, line.value, line.ticked, line.text, line.reason) for line in told] == [
        ("natural", 2.0, [], "", ""),
        ("effort", 15.0, [], "", ""),
        ("often", None, [], "", "does_not_apply"),
        ("known", 1.0, [], "", ""),
        ("which", None, [1, 6], "vacuum", ""),
        ("age", None, [], "", ""),
        ("since", None, [], "2026-11", ""),
    ]
    assert {line.given for line in told} == {"browser"}
