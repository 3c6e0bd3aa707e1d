"""Lines at the bottom: actions beside the panels, what comes next with its sentence, hints, news,
the stop.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache

from rich.cells import cell_len

from woz_tui.config.screen_language import say, word
from woz_tui.config.utterance_template import HIDDEN_TEXT
from woz_tui.console.drawing.cells import (
    Cells,
    Piece,
    Row,
    clean,
    cut,
    fit,
    heading,
    length,
    spread,
    wrap_row,
)
from woz_tui.console.drawing.glyphs import Glyphs, PaintFrame
from woz_tui.console.drawing.number_text import millis
from woz_tui.console.state.command_text import command_words
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.state.stop_confirmation import settled_row, stopped_words
from woz_tui.console.widgets.feature_console import ActionOrder, AskedWords, FeatureConsole
from woz_tui.feature import answer_of, pieces
from woz_tui.protocol.messages import FilledCall
from woz_tui.protocol.sentence import Sentence
from woz_tui.timeline.episodes import StopEpisode


def action_row(state: ConsoleState, frame: PaintFrame, keys: Mapping[str, str]) -> Row:
    """Each action beside the panels with its key, in a replay alone; what is under way stands
    out.
    """
    found: list[Row] = []
    for action in state.settings.beside_panels:
        if state.runs.of(action.name) is not None:
            mark, look = frame.glyphs.running, "run"
        elif state.runs.failure_of(action.name) is not None:
            mark, look = frame.glyphs.failed, "bad"
        else:
            mark, look = " ", "muted"
        label: Piece = (f"{mark}{clean(action.label)}", look)
        key = keys.get(action.name, "")
        if state.replay is not None:  # no key plays anything there
            found.append((label,))
        else:
            found.append(((key, "key") if key else (say("rows.no_key", "no key"), "muted"), label))
    need = sum(map(length, found))
    apart = 3 if need + 3 * len(found) <= frame.width else 1
    row: Row = ((" ", "plain"),)
    for each in found:
        row += (*each, (" " * apart, "plain"))
    return cut(row, frame.width, frame.glyphs.ellipsis)


class ActionRow(Cells):
    """One row."""

    #: Action -> its key, as a cap shows it; the app says so.
    keys: Mapping[str, str] = {}

    def paint(self, state: ConsoleState, frame: PaintFrame) -> None:
        self.show([action_row(state, frame, self.keys)])


#: What stands for a text that is kept from the wizard.
KEPT = Sentence("rows.kept", "what it says is kept from you")


def step_words(step: Sequence[FilledCall] | float) -> str:
    """`say “Hello” + play nod`, or `wait 0.5 s`; what several robots do alike stands there once."""
    if isinstance(step, float | int):
        return say("rows.wait", "wait {seconds:g} s", seconds=step)
    alike = Counter[str]()
    for call in step:
        text = command_words(call)
        alike[f"{call.verb} {text}" if call.args.get("text") else text] += 1
    return " + ".join(
        words
        if count == 1
        else say("rows.robots", "{words} ({number} robots)", words=words, number=count)
        for words, count in alike.items()
    )


def steps_text(state: ConsoleState, action: str) -> str:
    """All of its steps in one line; empty where nobody has told."""
    return ", ".join(map(step_words, state.steps(action)))


def quoted(state: ConsoleState, action: str, glyphs: Glyphs) -> str:
    """What it says, between quotation marks; empty if it says nothing, or it is kept."""
    return quotation(state.sentence(action), glyphs)


def quotation(text: str, glyphs: Glyphs) -> str:
    """A text between quotation marks; nothing of an empty one, or one that is kept."""
    said = clean(text)
    if not said or said == HIDDEN_TEXT:
        return ""
    return f"{glyphs.opening}{glyphs.plain(said)}{glyphs.closing}"


def sentence_rows(state: ConsoleState, frame: PaintFrame, action: str) -> list[Row]:
    """What it says, or what it does if it says nothing, in as many rows as the frame has."""
    if state.sentence(action) == HIDDEN_TEXT:
        text, look = word(KEPT), "muted"
    elif said := quoted(state, action, frame.glyphs):
        text, look = said, "strong"
    else:
        text, look = frame.glyphs.plain(clean(steps_text(state, action))), "muted"
    rows = wrap_row(((f" {text}", look),), 2, frame.width) if text else []
    if len(rows) > frame.height > 0:
        rest = " ".join(
            "".join(piece for piece, _ in row).strip() for row in rows[frame.height - 1 :]
        )
        rows[frame.height - 1 :] = [(("  " if frame.height > 1 else " ", "plain"), (rest, look))]
    rows += [()] * (frame.height - len(rows))
    return [cut(row, frame.width, frame.glyphs.ellipsis) for row in rows]


@cache
def _order() -> tuple[str, ActionOrder] | None:
    """The order, and whose it is."""
    orders = ((name, each.order) for name, each in pieces("console", FeatureConsole).items())
    return next(((name, order) for name, order in orders if order is not None), None)


def order_keys() -> Sequence[str]:
    """Ids of the keys that its row names; the first plays the next action."""
    return found[1].keys if (found := _order()) is not None else ()


def has_order(state: ConsoleState) -> bool:
    """Whether the experiment has one."""
    if (found := _order()) is None:
        return False
    name, order = found
    return answer_of(name, False, order.any, state)


def upcoming(state: ConsoleState) -> str:
    """The action that comes next in it; empty: none."""
    if (found := _order()) is None:
        return ""
    name, order = found
    return answer_of(name, "", order.next, state)


def asked_words(state: ConsoleState) -> dict[str, AskedWords]:
    """Actions about which something is asked before they are played, by name, and how."""
    nothing: Collection[str] = ()
    return {
        action: asks
        for name, each in pieces("console", FeatureConsole).items()
        if (asks := each.asks) is not None
        for action in answer_of(name, nothing, asks.lacking, state)
    }


def asks_again(state: ConsoleState, action: str) -> AskedWords | None:
    """How an action's words, which it has, are asked for anew; None: it has none of these."""
    for name, each in pieces("console", FeatureConsole).items():
        asks: AskedWords | None = each.asks
        if asks is not None and answer_of(name, False, asks.again, state, action):
            return asks
    return None


def order_row(state: ConsoleState, frame: PaintFrame, caps: Sequence[str] = ()) -> Row:
    """How it stands; `caps`: its keys. Empty: there is nothing in it now."""
    nothing: Row = ()
    if (found := _order()) is None:
        return nothing
    name, order = found
    return answer_of(name, nothing, order.row, state, frame, caps)


def no_order() -> str:
    """What stands in place of its row where there is nothing in it."""
    return word(found[1].nothing) if (found := _order()) is not None else ""


def next_row(
    state: ConsoleState,
    frame: PaintFrame,
    caps: Sequence[str],
    *,
    then: Sequence[tuple[str, str]] = (),
    begin: tuple[str, str] = ("", ""),
) -> Row:
    """What comes next in the order of actions, whose keys are `caps`. What is likely to follow the
    last act, `then`, stands first: key and label of each. `begin`: where there is no order yet, the
    key that begins something, and what.
    """
    glyphs = frame.glyphs
    if then:
        row: Row = ((f" {say('rows.then', 'then')} ", "title"),)
        for cap, label in then:
            row += ((f" {cap or glyphs.dash} ", "key"), (f" {clean(label)}  ", "strong"))
        room = frame.width - length(row)
        if room >= THEN_ROOM:
            return row + next_row(state, replace(frame, width=room), caps, begin=begin)
        return cut(row, frame.width, glyphs.ellipsis)
    if row := order_row(state, frame, caps):
        return row
    press, does = begin
    if press:
        row = ((f" {press} ", "key"), (f" {does}", "strong"))
        return cut(row, frame.width, glyphs.ellipsis)
    return ((fit(f" {does or no_order()}", frame.width, glyphs.ellipsis), "muted"),)


#: Cells that the order of actions needs at least behind what is likely to follow.
THEN_ROOM = 24


class OrderPane(Cells):
    """All of it."""

    def paint(self, state: ConsoleState, frame: PaintFrame) -> None:
        """Show a heading and the actions."""
        if not self.display or (found := _order()) is None:
            return
        name, order = found
        nothing: Sequence[Row] = ()
        inner = replace(frame, height=frame.height - 1)
        rows = answer_of(name, nothing, order.rows, state, inner)
        self.show([heading(word(order.heading), frame), *rows])


@dataclass(frozen=True, slots=True)
class News:
    """A sentence in the place of the hints; `look` as in `theme.LOOKS`."""

    text: str = ""
    look: str = "muted"


@dataclass(frozen=True, slots=True)
class BarInfo:
    """What does not come from messages.

    `news` takes the place of the `hints` (keys with a word each) for a while; `page` stands behind
    the hints and says which page of the panels is shown. `next` are the keys of the order of
    actions, `release` is the one that releases the stop, `stop` the one that stops,
    `take_over` lets a console that watches play, `failures` shows what can be done. `then`: keys
    and labels of what is likely to follow the last act. `asked_us`: session time at which this
    console asked for a stop that has not been answered yet. `begin`: where there is no order yet,
    the key that begins something, and what; without a key, why there is none.
    """

    news: News = News()
    hints: tuple[tuple[str, str], ...] = ()
    next: tuple[str, ...] = ()
    release: str = ""
    asked_us: int | None = None
    page: str = ""
    take_over: str = ""
    then: tuple[tuple[str, str], ...] = ()
    stop: str = ""
    failures: str = ""
    begin: tuple[str, str] = ("", "")


def bar_rows(state: ConsoleState, frame: PaintFrame, bar: BarInfo) -> list[Row]:
    """As many rows as the frame has, two at least. What is urgent takes the lowest."""
    lines = max(2, frame.height)
    urgent = _urgent(state, frame, bar)
    coming = [next_row(state, frame, bar.next, then=bar.then, begin=bar.begin)]
    if state.nobody_plays:
        what, key = clean(state.part), bar.take_over
        if what:
            told = say(
                "rows.nobody_plays_part",
                "Nobody plays {part}. {key} plays it from here.",
                part=what,
                key=key,
            )
        else:
            told = say(
                "rows.nobody_plays", "Nobody plays the robot. {key} plays it from here.", key=key
            )
        coming = [((fit(f" {frame.glyphs.warning} {told}", frame.width), "alarm-soft"),)]
    if lines > len(coming) + 1:
        name, two_rows = upcoming(state), replace(frame, height=2)
        if (asks := asked_words(state).get(name)) is not None:
            coming += asks.rows(state, two_rows, name)
        else:
            coming += sentence_rows(state, two_rows, name)
    hints = [hint_row(bar.hints, frame.width, bar.page)]
    rows = [*coming, *hints][:lines]
    if urgent:
        rows[lines - len(urgent) :] = urgent
    return rows


def _urgent(state: ConsoleState, frame: PaintFrame, bar: BarInfo) -> list[Row]:
    """What the wizard must know now, in two rows at most."""
    glyphs, width, asked_us = frame.glyphs, frame.width, bar.asked_us
    if state.ended and state.lost and asked_us is None:
        where = ""
        if bar.failures:
            where = say("rows.shows_log", "{key} shows where its log is", key=bar.failures)
            where = f" {where}"
        over = f" {say('rows.ended', 'The session has ended.')}"
        return [((fit(over, width), "strong"),), ((fit(where, width), "muted"),)]
    stop = state.session.stop
    if stop is not None and (not state.lost or (stop.settled and asked_us is None)):
        return _stopped(state, stop, bar, frame)
    if state.lost and (asked_us is not None or stop is not None):
        part = state.lost.part
        told = say("stop.undelivered", "STOP NOT DELIVERED: use the robot's own switch")
        if asked_us is None:
            told = say("stop.unconfirmed", "STOP NOT CONFIRMED: use the robot's own switch")
        first = f" {glyphs.stop} {told}"
        if len(told := f"{first}; {part.sentence}") <= width:
            first = told
        second = f" {part.robot}"
        return [((fit(first, width), "alarm"),), ((fit(second, width), "alarm-soft"),)]
    if state.lost:
        why = f" {glyphs.error} {state.lost.part.title}: {clean(word(state.lost.why))}"
        what = say("rows.no_key_sent", "No key is sent.")
        if bar.failures:
            what = say(
                "rows.no_key_sent_more",
                "No key is sent. {key} shows what the robot does and what can be done",
                key=bar.failures,
            )
        return [((fit(why, width), "alarm"),), _below(what, bar.news, frame)]
    if asked_us is not None:
        waited = millis(frame.now - asked_us)
        sent = say("stop.sent", "STOP SENT")
        told = say("stop.no_answer", "no answer yet, {waited}", waited=waited)
        first = f" {glyphs.stop} {sent} {glyphs.middle} {told}"
        return [((fit(first, width), "alarm"),), ((" " * width, "alarm-soft"),)]
    return _news_rows(bar.news, glyphs, width, bar.stop)


def _news_rows(news: News, glyphs: Glyphs, width: int, stop: str) -> list[Row]:
    """News on one line, or on two if it takes them: the remedy stands at its end, and behind it the
    key of the stop, which no sentence hides.
    """
    if not news.text:
        return []
    behind: Row = (
        ((f" {stop}", "strong"), (f" {say('stop.word', 'stop')} ", "muted")) if stop else ()
    )
    row: Row = ((f" {glyphs.plain(clean(news.text))}", news.look),)
    room = width - length(behind)
    first, *rest = wrap_row(row, 1, room if length(row) <= width else width)
    last = spread(sum(rest, ()) or first, behind, width, glyphs.ellipsis)
    return [cut(first, width, glyphs.ellipsis), last] if rest else [last]


def _below(what: str, news: News, frame: PaintFrame) -> Row:
    """What stands below an alarm, or news for their time."""
    text, look = (news.text, news.look) if news.text else (what, "alarm-soft")
    text = f" {frame.glyphs.plain(clean(text))}"
    return ((fit(text, frame.width, frame.glyphs.ellipsis), look),)


def _stopped(state: ConsoleState, stop: StopEpisode, bar: BarInfo, frame: PaintFrame) -> list[Row]:
    glyphs, width = frame.glyphs, frame.width
    release = "" if state.lost else bar.release  # no key is sent
    left = stopped_words(stop, state.others, glyphs)
    confirmed = stop.settled and not stop.missing
    hint = ""
    if release:
        hint = say("stop.asks_first", "{key} releases (asks first)", key=release)
        if confirmed:
            hint = say("stop.releases", "{key} releases", key=release)
        hint += " "
    if state.lost:
        if confirmed:
            left = say("stop.by_all", "{stopped}, confirmed by all", stopped=left)
        part = state.lost.part
        hint = f"{part.sentence} "
        if len(left) + len(hint) >= width:
            hint = f"{part.sign} "
    if len(left) + len(hint) >= width:
        hint = ""
    first = spread(((left, "alarm"), (" " * width, "alarm")), ((hint, "alarm"),), width, " ")
    if not stop.settled:
        waits = say("stop.waiting", "waiting for the drivers to confirm")
        second: Row = ((fit(f" {waits}", width), "alarm-soft"),)
        return [first, second]
    if confirmed and (state.lost or bar.news.text):
        more = word(state.lost.why) if state.lost else ""
        if bar.failures:
            more = say(
                "rows.can_be_done",
                "{key} shows what can be done ({why})",
                key=bar.failures,
                why=more,
            )
        return [first, _below(more, bar.news, frame)]
    row = settled_row(stop, state.short_names, glyphs, width, release)
    blanks = max(0, width - length(row))
    return [first, cut((*row, (" " * blanks, "alarm-soft")), width, glyphs.ellipsis)]


def hint_row(hints: tuple[tuple[str, str], ...], width: int, page: str = "") -> Row:
    """Keys with a word each, as many as have room beside the page's number."""
    row: Row = ((" ", "plain"),)
    used = 1
    behind = f"{page} " if page else ""
    for key, what in hints:
        need = cell_len(key) + cell_len(what) + 3
        if used + need > width - cell_len(behind):
            break
        row += ((key, "strong"), (f" {what}", "muted"), ("  ", "plain"))
        used += need
    return spread(row, ((behind, "muted"),), width) if behind else row


class StopBar(Cells):
    """The bar over the whole width at the bottom of every screen."""

    def paint(self, state: ConsoleState, frame: PaintFrame, bar: BarInfo) -> None:
        """Show the stop, or the news and hints."""
        self.show(bar_rows(state, frame, bar))
