"""The participant's page as HTML: one thing at a time, in forms that need no JavaScript.

`assets/answer.js` sends them without leaving the page, keeps what is not sent yet, measures by the
page's own clock, and loads the page anew when something else is asked.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import zip_longest

from woz_tui.analysis.html.markup import Child, Markup, isolated, tag
from woz_tui.features.choices.kinds import ChoiceOffered
from woz_tui.features.page.html import hidden, page
from woz_tui.features.page.item_forms import item_form
from woz_tui.features.page.seat import ParticipantSeat, choosing
from woz_tui.features.questionnaires.answers import OpenQuestionnaire
from woz_tui.features.questionnaires.items import SKIPPED, ItemAnswer, said, way_text, wording
from woz_tui.protocol.welcome import QuestionnaireItem

#: Seconds after which a browser without JavaScript looks whether something is asked.
_AGAIN_S = 3
HERE = "/answer"


def answer_page(seat: ParticipantSeat, wanted: Mapping[str, str]) -> str:
    """What this browser shows now. `wanted`: the item that was chosen to be changed (`item`), or
    that somebody wants to stop (`stop`).
    """
    asked, offered = seat.asked, seat.offered
    if offered is not None and not seat.lost:
        return _choice(seat, offered)
    if asked is None or seat.lost:
        return _nothing_asked(seat)
    items = {item.name: item for item in asked.shown}
    chosen = items.get(wanted.get("item", ""))
    if "stop" in wanted:
        return _decline(seat, asked)
    if not seat.introduced and chosen is None:
        return _introduction(seat, asked)
    chosen = chosen or items.get(seat.open_item)
    return _summary(seat, asked) if chosen is None else _item(seat, asked, chosen)


def _page(seat: ParticipantSeat, title: str, *body: Child, again_s: float = 0) -> str:
    """A page of this seat; what has been wrong is said once."""
    notice = tag("p", seat.notice, id="notice", role="status", hidden=not seat.notice)
    complaint, seat.complaint = seat.complaint, ""
    wrong = tag("p", complaint, id="complaint", role="alert", class_="complaint")
    sheet = tag(
        "main",
        notice,
        wrong,
        *body,
        class_="sheet",
        data_round=seat.round,
        data_open=seat.open_item,
        data_unsent=seat.words.not_sent,
    )
    language = seat.follower.state.settings.study.language
    return page(title, sheet, script="answer.js", again_s=again_s, language=language)


def _nothing_asked(seat: ParticipantSeat) -> str:
    words = seat.words
    lines = [words.moment, words.kept] if seat.lost else [words.wait]
    if seat.thanks:
        lines = [words.thanks]
    told = (tag("p", line, class_="said") for line in lines)
    return _page(seat, lines[0], tag("div", told, class_="waiting"), again_s=_AGAIN_S)


def _choice(seat: ParticipantSeat, offered: ChoiceOffered) -> str:
    """A button for each option; its picture stands above its words."""
    shown_us = seat.show(seat.round)
    heading = offered.question or ", ".join(offered.options)
    buttons = []
    for place, (text, picture) in enumerate(
        zip_longest(offered.options, offered.pictures, fillvalue="")
    ):
        source = f"{HERE}/picture/{offered.seq}/{place}"
        image = tag("img", src=source, alt="") if picture else None
        words = tag("span", isolated(text))
        buttons.append(_button(choosing(place), image, words))
    return _page(
        seat,
        heading,
        tag("h1", isolated(heading), class_=None if offered.question else "unseen"),
        _form(
            seat,
            hidden("before", str(shown_us // 1000)),
            tag("div", buttons, class_="choices"),
        ),
    )


def _introduction(seat: ParticipantSeat, asked: OpenQuestionnaire) -> str:
    words, told = seat.words, asked.questionnaire.introduction.strip().split("\n")
    return _page(
        seat,
        asked.questionnaire.heading,
        tag("h1", isolated(asked.questionnaire.heading)),
        (tag("p", isolated(line)) for line in told),
        tag("p", asked.count_told(words), class_="muted"),
        _form(seat, tag("div", _button("begin", words.begin), class_="buttons")),
        _stop(seat),
    )


def _item(seat: ParticipantSeat, asked: OpenQuestionnaire, item: QuestionnaireItem) -> str:
    words, shown, questions = seat.words, asked.shown, asked.questions
    place = shown.index(item)
    shown_us = seat.show(item.name)
    answer = asked.answers.get(item.name) or ItemAnswer()
    hint = tag("p", words.optional, class_="muted") if item.optional else None
    buttons = [_button("seen" if item.asks == "page" else "answer", words.next)]
    for way in seat.ways(item):
        told = way_text(item, way, words.skip)
        buttons.append(_button("skip" if way == SKIPPED else way, told, quiet=True))
    back = f"{HERE}?item={shown[place - 1].name}" if place else ""
    count = len(questions)
    number = questions.index(item) + 1 if item in questions else 0
    at = words.position.format(number=number, count=count) if number else ""
    return _page(
        seat,
        asked.questionnaire.heading,
        tag("header", tag("span", isolated(asked.questionnaire.heading)), tag("span", at)),
        tag("progress", value=str(asked.answered), max=str(count), aria_hidden="true"),
        _form(
            seat,
            hidden("item", item.name),
            hidden("before", str(shown_us // 1000)),
            tag("fieldset", _asked(item), hint, item_form(item, answer, words)),
            tag("div", buttons, class_="buttons"),
        ),
        _stop(seat, tag("a", words.back, href=back) if back else None),
    )


def _asked(item: QuestionnaireItem) -> Child:
    """The question, or the lines of an instruction."""
    if item.asks == "page":
        return [tag("p", isolated(line)) for line in item.question.strip().split("\n")]
    return tag("legend", isolated(wording(item)))


def _summary(seat: ParticipantSeat, asked: OpenQuestionnaire) -> str:
    """All answers, each with a way to change it, and the way to finish."""
    words = seat.words
    rows = []
    for item in asked.questions:
        answer = asked.answers.get(item.name)
        told = words.no_answer if answer is None else said(item, answer, words.left_out)
        about = tag("span", wording(item), class_="unseen")
        change = tag("a", words.change, " ", about, href=f"{HERE}?item={item.name}")
        rows += [tag("dt", isolated(wording(item))), tag("dd", isolated(told), " ", change)]
    return _page(
        seat,
        asked.questionnaire.heading,
        tag("h1", isolated(asked.questionnaire.heading)),
        tag("dl", rows),
        _form(seat, tag("div", _button("done", words.finish), class_="buttons")),
        _stop(seat),
    )


def _decline(seat: ParticipantSeat, asked: OpenQuestionnaire) -> str:
    words = seat.words
    buttons = (
        tag("a", words.go_on, href=HERE, class_="button"),
        _button("declined", words.stop_here, quiet=True),
    )
    return _page(
        seat,
        asked.questionnaire.heading,
        tag("h1", words.stop_question),
        tag("p", words.stop_kept),
        _form(seat, tag("div", buttons, class_="buttons")),
    )


def _form(seat: ParticipantSeat, *content: Child) -> Markup:
    number = hidden("form", seat.next_form())
    return tag(
        "form",
        hidden("round", seat.round),
        number,
        *content,
        method="post",
        action=HERE,
        autocomplete="off",
    )


def _button(what: str, *content: Child, quiet: bool = False) -> Markup:
    """A button that sends the form; a quiet one also a form that is not filled in."""
    return tag(
        "button",
        *content,
        type="submit",
        name="what",
        value=what,
        class_="quiet" if quiet else None,
        formnovalidate=quiet,
    )


def _stop(seat: ParticipantSeat, *before: Child) -> Markup:
    """Small ways out, at the end of the page."""
    return tag("footer", *before, tag("a", seat.words.stop_here, href=f"{HERE}?stop"))
