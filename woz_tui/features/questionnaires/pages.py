"""Draws the pages of a questionnaire as rows: large, calm, one thing at a time."""

from __future__ import annotations

import textwrap
from dataclasses import replace

from rich.cells import cell_len, chop_cells

from woz_tui.console.drawing.cells import Piece, Row, clean, cut_rows, fit
from woz_tui.console.drawing.glyphs import Glyphs, PaintFrame
from woz_tui.features.questionnaires.items import SKIPPED, said, way_text, wording
from woz_tui.features.questionnaires.run import (
    CHOICE_KEYS,
    WIDE,
    QuestionnairePage,
    QuestionnaireRun,
)
from woz_tui.protocol.welcome import QuestionnaireItem

#: Cells of a page's column, and of a box on a scale.
COLUMN, BOX = 72, 9
#: Cells below which nothing is drawn.
NARROWEST = 16
#: Lines from which there is room for air.
_AIRY = 15
#: Lines of a page that an item does not have: title, air, ways to give no answer.
_AROUND = 6


def column_of(width: int) -> int:
    """Cells of the column in which everything stands, on a screen so wide."""
    return max(1, min(COLUMN, width - 4))


def page_rows(run: QuestionnaireRun, frame: PaintFrame) -> list[Row]:
    """The whole page, as many rows as the frame is high."""
    if frame.width < NARROWEST:
        return []  # not laid out yet, or nothing that could be read
    inner = replace(frame, width=column_of(frame.width))
    air: list[Row] = [()] if frame.height >= _AIRY else []
    head = [*air, *_head(run, inner), ()]
    body = _BODIES[run.page](run, inner)
    above = min(max(0, (frame.height - len(head) - len(body)) // 3), 4)
    return _centred([*head, *[()] * above, *body], frame)


def _centred(rows: list[Row], frame: PaintFrame) -> list[Row]:
    """Rows in their column."""
    left: Piece = (" " * max(0, (frame.width - column_of(frame.width)) // 2), "plain")
    return cut_rows([(left, *row) for row in rows], frame) if frame.width >= NARROWEST else []


def question_height(run: QuestionnaireRun, width: int, glyphs: Glyphs) -> int:
    """Lines that a question for words needs at least, from the title on, in a column so wide."""
    frame = PaintFrame(width, 0, 0, glyphs)
    return len(_head(run, frame)) + 1 + len(_item(run, frame))


def foot_rows(run: QuestionnaireRun, frame: PaintFrame, notice: str = "") -> list[Row]:
    """What is wrong, the keys, and a `notice`."""
    glyphs = frame.glyphs
    complaint: Row = ((f"{glyphs.warning} {run.complaint}", "warn"),) if run.complaint else ()
    keys = glyphs.plain(_keys(run, glyphs))
    return _centred([complaint, ((keys, "muted"),), ((notice, "strong"),)], frame)


def words_rows(lines: list[tuple[str, str]], frame: PaintFrame) -> list[Row]:
    """Sentences with their looks in the middle of the screen."""
    above = max(0, (frame.height - len(lines)) // 3)
    rows: list[Row] = [()] * above
    for text, look in lines:
        before = " " * max(0, (frame.width - cell_len(text)) // 2)
        rows.append(((before, "plain"), (clean(text), look)))
    return rows


# -- pages ----------------------------------------------------------------------------------------


def _head(run: QuestionnaireRun, frame: PaintFrame) -> list[Row]:
    """Title, and how far it is."""
    asked, count = run.asked, len(run.asked.questions)
    within = run.page in (QuestionnairePage.ITEM, QuestionnairePage.NO_ANSWER) and run.number
    told = run.words.position.format(number=run.number, count=count) if within else ""
    title = clean(asked.questionnaire.heading)
    title = fit(title, frame.width - cell_len(told) - 1, frame.glyphs.ellipsis)
    full = round(frame.width * asked.answered / count) if count else 0
    return [
        ((title, "title"), (" ", "plain"), (told, "muted")),
        ((frame.glyphs.bar * full, "run"), (frame.glyphs.rule * (frame.width - full), "faint")),
    ]


def _introduction(run: QuestionnaireRun, frame: PaintFrame) -> list[Row]:
    told = run.asked.questionnaire.introduction
    rows: list[Row] = [((line, "plain"),) for line in _wrapped(told, frame.width)]
    return [*rows, (), ((run.asked.count_told(run.words), "muted"),)]


def _wrapped(text: str, width: int) -> list[str]:
    """Its lines, each as long as the column at the most; an empty one stays."""
    return [part for line in text.strip().split("\n") for part in _folded(clean(line), width)]


def _folded(line: str, width: int) -> list[str]:
    if cell_len(line) > len(line):  # of wide signs, between which there are no blanks
        return chop_cells(line, width) or [""]
    return textwrap.wrap(line, width) or [""]


def _item(run: QuestionnaireRun, frame: PaintFrame) -> list[Row]:
    item = run.item
    if item is None:
        return []
    if item.asks == "page":
        return [((line, "plain"),) for line in _wrapped(item.question, frame.width)]
    rows = _question(item, frame)
    if item.optional:
        rows.append(((run.words.optional, "muted"),))
    rows += [(), ()] if frame.height >= _AIRY else [()]
    if run.pending is not None:
        return [*rows, ((run.words.other, "plain"),)]
    draw = _ANSWERS.get(item.asks)
    if draw is not None:
        room = frame.height - len(rows) - _AROUND
        rows += draw(item, run, frame, max(3, room) if frame.height else len(item.choices))
    return [*rows, *_ways(item, run, frame)]


def _question(item: QuestionnaireItem, frame: PaintFrame) -> list[Row]:
    """What is asked: a stem first; opposites stand at the ends of their scale alone."""
    asked = f"{item.stem} {item.question}".strip() or wording(item)
    return [((line, "strong"),) for line in _wrapped(asked, frame.width)]


def _ways(item: QuestionnaireItem, run: QuestionnaireRun, frame: PaintFrame) -> list[Row]:
    """The ways to give no answer that have words of their own."""
    ways = [way_text(item, way, "") for way in run.ways if way != SKIPPED]
    if not ways:
        return []
    told = run.words.keys_ways.format(way=" / ".join(ways))
    return [(), *(((line, "muted"),) for line in _wrapped(told, frame.width))]


def _no_answer(run: QuestionnaireRun, frame: PaintFrame) -> list[Row]:
    """Why there is none, to choose from."""
    item = run.item
    rows = _question(item, frame) if item is not None else []
    rows += [(), ((run.words.no_answer_how, "plain"),), ()]
    for key, way in zip(CHOICE_KEYS, run.ways, strict=False):
        told = way_text(item, way, run.words.left_out) if item is not None else ""
        rows.append(((f"{key}  ", "key"), (told, "plain")))
    return rows


def _scale(
    item: QuestionnaireItem, run: QuestionnaireRun, frame: PaintFrame, room: int
) -> list[Row]:
    """Boxes in a row, points with their labels one below the other, or a line."""
    points = item.high - item.low + 1
    if any(label.text for label in item.labels[1:-1]) and points <= room:
        return _named_points(item, run, frame)
    return _boxes(item, run, frame) if points <= WIDE else _line(item, run, frame)


def _named_points(item: QuestionnaireItem, run: QuestionnaireRun, frame: PaintFrame) -> list[Row]:
    """A line for each point: its number, if that is shown, and its label."""
    texts = {label.value: label.text for label in item.labels}
    wide = max(len(str(item.low)), len(str(item.high)))
    rows: list[Row] = []
    for value in range(item.low, item.high + 1):
        here = value == run.mark
        number = f"{str(value).rjust(wide)}  " if item.numbers else ""
        mark = f"{frame.glyphs.here if here else ' '} {number}"
        text = fit(clean(texts.get(value, "")), frame.width - cell_len(mark), frame.glyphs.ellipsis)
        rows.append(((mark, "key"), (text, "fill" if here else "plain")))
    return rows


def _choices(
    item: QuestionnaireItem, run: QuestionnaireRun, frame: PaintFrame, room: int
) -> list[Row]:
    """A line for each choice with its key; ticked ones have a cross between brackets."""
    rows: list[Row] = []
    before = run.answer.value if run.answer is not None else None
    for number, choice in enumerate(item.choices):
        here = number == run.mark
        ticked = choice.value in run.ticked or (item.asks == "choice" and choice.value == before)
        box = ("[x] " if ticked else "[ ] ") if item.asks == "choices" else ""
        mark = f"{frame.glyphs.here if here else ' '} {CHOICE_KEYS[number]}  {box}"
        text = fit(clean(choice.text), frame.width - cell_len(mark), frame.glyphs.ellipsis)
        look = "fill" if here and item.asks == "choice" else "strong" if here or ticked else "plain"
        rows.append(((mark, "key"), (text, look)))
    first = max(0, min(len(rows) - room, (run.mark or 0) - room // 2))
    return rows[first : first + room]


def _number(
    item: QuestionnaireItem, run: QuestionnaireRun, frame: PaintFrame, room: int
) -> list[Row]:
    """What was typed so far, and its unit."""
    empty = "____-__" if item.asks == "month" else "__"
    typed = (f"[ {run.typed or empty} ]", "strong" if run.typed else "muted")
    return [(typed, (f" {clean(item.unit)}", "plain"))]


def _boxes(item: QuestionnaireItem, run: QuestionnaireRun, frame: PaintFrame) -> list[Row]:
    """A box for each point, the chosen one filled and between brackets."""
    values = range(item.low, item.high + 1)
    box = max(3, min(BOX, frame.width // len(values)))
    blank: list[Piece] = []
    row: list[Piece] = []
    for value in values:
        told = str(value) if item.numbers else frame.glyphs.dash
        shown, look = (f"[{told}]", "fill") if value == run.mark else (told, "key")
        blank += [(" " * (box - 1), look), (" ", "plain")]
        row += [(shown.center(box - 1), look), (" ", "plain")]
    ends = _ends(item, box * len(values) - 1, frame)
    return [tuple(blank), tuple(row), tuple(blank), (), *ends]


def _slider(
    item: QuestionnaireItem, run: QuestionnaireRun, frame: PaintFrame, room: int
) -> list[Row]:
    return _line(item, run, frame)


def _line(item: QuestionnaireItem, run: QuestionnaireRun, frame: PaintFrame) -> list[Row]:
    """A line from end to end, with a mark on it and the number above."""
    glyphs, width = frame.glyphs, frame.width
    cells = [(glyphs.track, "faint")] * width
    told: Row = ((f"{run.typed or glyphs.dash}".center(width), "muted"),)
    if run.mark is not None:
        share = (run.mark - item.low) / max(1, item.high - item.low)
        at = min(width - 1, round(share * (width - 1)))
        cells[:at] = [(glyphs.bar, "run")] * at
        cells[at] = (glyphs.spot, "strong")
        told = ((f"[ {run.mark} ]".center(width), "strong"),)
    low, high = str(item.low), str(item.high)
    numbers = low + high.rjust(max(1, width - len(low)))
    return [told, (), tuple(cells), ((numbers, "plain"),), *_ends(item, width, frame)]


def _ends(item: QuestionnaireItem, width: int, frame: PaintFrame) -> list[Row]:
    """What the ends are called, each under its own end."""
    low, high = map(clean, item.ends)
    if not low and not high:
        return []
    width = min(frame.width, max(width, cell_len(low) + cell_len(high) + 2))
    if cell_len(low) + cell_len(high) + 2 <= width:
        between = " " * (width - cell_len(low) - cell_len(high))
        return [((low, "plain"), (between, "plain"), (high, "plain"))]
    return [
        ((f"{item.low}  {low}", "plain"),),
        ((f"{item.high}  {high}", "plain"),),
    ]


def _summary(run: QuestionnaireRun, frame: PaintFrame) -> list[Row]:
    """All answers, the chosen line marked; beneath them the way to finish."""
    glyphs, words = frame.glyphs, run.words
    rows: list[Row] = []
    for number, item in enumerate(run.asked.questions):
        here = number == run.chosen
        answer = run.asked.answers.get(item.name)
        told = said(item, answer, words.left_out) if answer is not None else words.no_answer
        told = fit(told, min(cell_len(clean(told)), frame.width // 3), glyphs.ellipsis)
        question = fit(wording(item), frame.width - cell_len(told) - 4, glyphs.ellipsis)
        look = "strong" if here else "plain"
        mark = glyphs.here if here else " "
        good = "muted" if answer is None or answer.skipped else "run"
        rows.append(((f"{mark} {question}  ", look), (told, good)))
    room = max(1, frame.height - 6)
    first = max(0, min(len(rows) - room, run.chosen - room // 2))
    here = run.chosen >= len(run.asked.questions)
    finish = f"{glyphs.here if here else ' '} {words.finish}"
    return [*rows[first : first + room], (), ((finish, "strong" if here else "plain"),)]


def _decline(run: QuestionnaireRun, frame: PaintFrame) -> list[Row]:
    return [
        ((run.words.stop_question, "strong"),),
        (),
        ((run.words.stop_kept, "plain"),),
    ]


_BODIES = {
    QuestionnairePage.INTRODUCTION: _introduction,
    QuestionnairePage.ITEM: _item,
    QuestionnairePage.SUMMARY: _summary,
    QuestionnairePage.DECLINE: _decline,
    QuestionnairePage.NO_ANSWER: _no_answer,
}

#: Where the answer to an item is given, by its kind; that of a text is a field of its own.
_ANSWERS = {
    "scale": _scale,
    "slider": _slider,
    "choice": _choices,
    "choices": _choices,
    "number": _number,
    "month": _number,
}


def _keys(run: QuestionnaireRun, glyphs: Glyphs) -> str:
    """What the keys do on this page."""
    item, words = run.item, run.words
    match run.page:
        case QuestionnairePage.INTRODUCTION:
            return words.keys_begin
        case QuestionnairePage.DECLINE:
            return words.keys_decline.format(stop=words.stop_key, go_on=words.go_on_key)
        case QuestionnairePage.SUMMARY:
            return words.keys_summary.format(up=glyphs.up)
        case QuestionnairePage.NO_ANSWER:
            return words.keys_no_answer.format(up=glyphs.up)
    if item is None:
        return words.keys_stop
    keys = words.keys_scale if item.digits else words.keys_scale_enter
    keys = keys if item.numbers else words.keys_points
    keys = {
        "text": words.keys_text,
        "slider": words.keys_slider,
        "choice": words.keys_choice,
        "choices": words.keys_several,
        "month": words.keys_month,
        "page": words.keys_page,
        "number": words.keys_scale_enter,
    }.get(item.asks, keys)
    if run.pending is not None:
        keys = words.keys_other
    signs = {"left": glyphs.left, "right": glyphs.right, "up": glyphs.up, "down": glyphs.down}
    filled = keys.format(low=item.low, high=item.high, **signs)
    skips = [words.keys_skip] if item.optional else []
    return " · ".join([filled, *skips, words.keys_stop])
