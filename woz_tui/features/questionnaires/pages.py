"""Draws the pages of a questionnaire as rows: large, calm, one thing at a time."""

from __future__ import annotations

import textwrap
from dataclasses import replace

from rich.cells import cell_len, chop_cells

from woz_tui.console.drawing.cells import Piece, Row, clean, cut_rows, fit
from woz_tui.console.drawing.glyphs import Glyphs, PaintFrame
from woz_tui.features.questionnaires.run import WIDE, QuestionnairePage, QuestionnaireRun
from woz_tui.protocol.welcome import QuestionnaireItem

#: Cells of a page's column, and of a box on a scale.
COLUMN, BOX = 72, 9
#: Cells below which nothing is drawn.
NARROWEST = 16
#: Lines from which there is room for air.
_AIRY = 15


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
    asked, count = run.asked, len(run.asked.items)
    done = min(run.position + (run.page is QuestionnairePage.ITEM), count)
    told = (
        run.words.position.format(number=done, count=count)
        if run.page is QuestionnairePage.ITEM
        else ""
    )
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
    count = len(run.asked.items)
    words = run.words
    many = words.questions_one if count == 1 else words.questions.format(count=count)
    return [*rows, (), ((many, "muted"),)]


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
    rows: list[Row] = [((line, "strong"),) for line in _wrapped(item.question, frame.width)]
    if item.optional:
        rows.append(((run.words.optional, "muted"),))
    rows += [(), ()] if frame.height >= _AIRY else [()]
    if item.text:
        return rows
    scale = _boxes(item, run, frame) if item.high - item.low < WIDE else _line(item, run, frame)
    return [*rows, *scale]


def _boxes(item: QuestionnaireItem, run: QuestionnaireRun, frame: PaintFrame) -> list[Row]:
    """A box for each point, the chosen one filled and between brackets."""
    values = range(item.low, item.high + 1)
    box = max(3, min(BOX, frame.width // len(values)))
    blank: list[Piece] = []
    row: list[Piece] = []
    for value in values:
        shown, look = (f"[{value}]", "fill") if value == run.mark else (str(value), "key")
        blank += [(" " * (box - 1), look), (" ", "plain")]
        row += [(shown.center(box - 1), look), (" ", "plain")]
    ends = _ends(item, box * len(values) - 1, frame)
    return [tuple(blank), tuple(row), tuple(blank), (), *ends]


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
    for number, item in enumerate(run.asked.items):
        here = number == run.chosen
        answer = run.asked.answers.get(item.name)
        said = answer.shown(words.left_out) if answer is not None else words.no_answer
        said = fit(said, min(cell_len(clean(said)), frame.width // 3), glyphs.ellipsis)
        question = fit(item.question, frame.width - cell_len(said) - 4, glyphs.ellipsis)
        look = "strong" if here else "plain"
        mark = glyphs.here if here else " "
        good = "muted" if answer is None or answer.skipped else "run"
        rows.append(((f"{mark} {question}  ", look), (said, good)))
    room = max(1, frame.height - 6)
    first = max(0, min(len(rows) - room, run.chosen - room // 2))
    here = run.chosen >= len(run.asked.items)
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
    if item is None:
        return words.keys_stop
    keys = words.keys_scale if item.digits else words.keys_scale_enter
    if item.text:
        keys = words.keys_text
    filled = keys.format(
        low=item.low, high=item.high, left=glyphs.left, right=glyphs.right, up=glyphs.up
    )
    skips = [words.keys_skip] if item.optional else []
    return " · ".join([filled, *skips, words.keys_stop])
