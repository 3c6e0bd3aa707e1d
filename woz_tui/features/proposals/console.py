"""Proposals on the wizard's screen: a row for each, with its key."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import replace

from woz_tui.config.screen_language import say, word
from woz_tui.console.drawing.cells import Row, clean, cut, length, spread, wrap_row
from woz_tui.console.drawing.glyphs import PaintFrame
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.state.event_sentences import EventContext, EventLine
from woz_tui.console.widgets.bottom_rows import quotation
from woz_tui.console.widgets.feature_console import Board, FeatureCommand, FeatureConsole
from woz_tui.features.proposals.history import ProposalHistory
from woz_tui.features.proposals.kinds import (
    AskShown,
    ProposedItem,
    SuggestGone,
    SuggestState,
    SuggestTaken,
    SuggestTrial,
)
from woz_tui.features.proposals.model_state import WHY
from woz_tui.features.proposals.notes import PLACES, ShownItem, ShownProposals
from woz_tui.protocol.envelope import Json
from woz_tui.protocol.sentence import Sentence

#: Lines of a screen from which on all places are shown; below, one less.
TALL = 30
KEYS = tuple(f"take_{place}" for place in range(1, PLACES + 1))
EDIT, NONE = "take_edit", "take_none"


def places_of(state: ConsoleState) -> Sequence[ShownItem | None]:
    """What stands at each place."""
    notes = state.study.notes.of(ShownProposals)
    return notes.places if notes is not None else ()


def _lines(state: ConsoleState, height: int) -> int:
    """As many at all times, so that nothing moves when a proposal comes."""
    settings = state.session.history(ProposalHistory).settings
    if settings is None or not settings.sources or state.replay is not None:
        return 0
    return _places(state, height >= TALL) + ("logs" in settings.sources)


def _places(state: ConsoleState, tall: bool) -> int:
    """Rows for what programs propose; on a low screen one, where nothing but likely actions and
    perhaps an assistant is to be expected: a model offers two sentences at a time.
    """
    settings = state.session.history(ProposalHistory).settings
    assert settings is not None
    if tall:
        return PLACES
    few = "logs" in settings.sources and "model" not in settings.sources
    return 1 if few else PLACES - 1


def _rows(state: ConsoleState, frame: PaintFrame) -> Sequence[Row]:
    settings = state.session.history(ProposalHistory).settings
    logs = settings is not None and "logs" in settings.sources
    inner = replace(frame, height=frame.height - logs)
    if (notes := state.study.notes.of(ShownProposals)) is not None:
        notes.settle(inner.height)
    rows: list[Row] = [_likely(state, frame)] if logs else []
    for place, shown in enumerate(places_of(state)[: inner.height]):
        if shown is not None or len(rows) <= place + logs:
            rows += _place(state, inner, place, shown)
    return rows


def _likely(state: ConsoleState, frame: PaintFrame) -> Row:
    """Likely actions with their own keys: what is learnt there stays true tomorrow."""
    row, _ = _likely_items(state, frame)
    return cut(row, frame.width, frame.glyphs.ellipsis)


def _likely_items(state: ConsoleState, frame: PaintFrame) -> tuple[Row, list[ShownItem]]:
    """The row, and what of it there is room for."""
    sets = state.session.history(ProposalHistory).sets.values()
    offered = next((each.offered for each in sets if each.offered.source == "logs"), None)
    row: Row = ((f" {say('proposals.likely', 'likely')} ", "title"),)
    seen: list[ShownItem] = []
    for item in offered.items if offered is not None else ():
        cap = state.keys.get(item.action, "") or frame.glyphs.dash
        row += ((f" {cap} ", "key"), (f" {clean(state.label(item.action))}  ", "strong"))
        if offered is not None and length(row) <= frame.width + 2:  # blanks may be cut off
            seen.append(ShownItem(offered, item))
    return row, seen


def _just_shown(state: ConsoleState, frame: PaintFrame) -> Iterator[AskShown]:
    """Tells of each item when it stands on the wizard's screen for the first time. `frame`: of the
    whole screen.
    """
    notes = state.study.notes.of(ShownProposals)
    lines = _lines(state, frame.height)
    if notes is None or not lines or state.role != "wizard":
        return
    settings = state.session.history(ProposalHistory).settings
    logs = settings is not None and "logs" in settings.sources
    seen = _likely_items(state, frame)[1] if logs else []
    seen += [each for each in notes.places[: lines - logs] if each is not None]
    new: dict[str, list[str]] = {}
    for offered, item in seen:
        if (offered.set, item.id) not in notes.told:
            notes.told.add((offered.set, item.id))
            new.setdefault(offered.set, []).append(item.id)
    for name, items in new.items():
        yield AskShown(set=name, items=items)


def _place(
    state: ConsoleState, frame: PaintFrame, place: int, shown: ShownItem | None
) -> list[Row]:
    """Key, who proposes, what, and how long it still waits."""
    glyphs, cap = frame.glyphs, state.own_keys.get(KEYS[place], "")
    if shown is None:
        if place or any(places_of(state)):
            return [((" ", "plain"),)]
        return [((f" {_why_nothing(state)}", "muted"),)]
    offered, item = shown
    who = clean(offered.who) or offered.source
    asks = say("proposals.asks", "{who} asks:", who=who) if offered.approval else f"{who}:"
    front: Row = ((f" {cap or glyphs.dash} ", "key"), (f" {asks} ", "wait"))
    edit = no = ""
    if not place:
        edits, none = (state.own_keys.get(name, "") for name in (EDIT, NONE))
        if edits and item.text:
            edit = f" {say('proposals.edit_key', '{key} edit', key=edits)} "
        if none:
            no = f" {say('proposals.no_key', '{key} no', key=none)} "
    left = max(0, offered.until - frame.now)
    marks = "".join(f" {word(_MARKS.get(mark, clean(mark)))} " for mark in item.marks)
    ends: Row = ((marks, "warn"), (f" {(left + 999_999) // 1_000_000} s ", "muted"))
    row: Row = (*front, (item_words(state, item, frame), "strong"))
    # The sentence before the hints; what it repeats is worth more than its keys.
    hints = (
        more for more in (edit + no, no) if length(row) + length(ends) + len(more) <= frame.width
    )
    right: Row = ((next(hints, ""), "muted"), *ends)
    rest = _below(state, frame, place)
    first, *more_rows = wrap_row(row, length(front) if rest else 0, frame.width - length(right))
    if len(more_rows) > rest:
        first = cut(row, frame.width - length(right), glyphs.ellipsis)
        more_rows = []
    if more_rows and not right[0][0]:
        room = frame.width - length(more_rows[-1]) - 1
        hint = next((more for more in (edit + no, no) if len(more) <= room), "")
        more_rows[-1] = spread(more_rows[-1], ((hint, "muted"),), frame.width, glyphs.ellipsis)
    return [spread(first, right, frame.width, glyphs.ellipsis), *more_rows]


def _why_nothing(state: ConsoleState) -> str:
    """What stands where nothing is proposed; a model that cannot propose is named."""
    history = state.session.history(ProposalHistory)
    if history.is_quiet():
        return say("proposals.quiet", "nothing is proposed in this trial")
    if history.model is not None:
        told = history.model_state
        why = word(WHY.get(told.why, clean(told.why))) if told is not None else ""
        match told.how if told is not None else "gone":
            case "gone":
                return say("proposals.no_suggest", "no sentences: `woz suggest` does not run")
            case "loading":
                return say("proposals.model_loading", "no sentences yet: the model is loading")
            case "failing":
                return say("proposals.model_failing", "no sentences of the model: {why}", why=why)
            case "dropped":
                return say("proposals.model_dropped", "last answer dropped: {why}", why=why)
    return say("proposals.nothing", "nothing is proposed")


def _below(state: ConsoleState, frame: PaintFrame, place: int) -> int:
    """Empty rows directly below a place: a long sentence goes on there."""
    rows = places_of(state)[place + 1 : frame.height]
    return next((i for i, shown in enumerate(rows) if shown is not None), len(rows))


def is_whole(state: ConsoleState, frame: PaintFrame, place: int) -> bool:
    """Whether the wizard can read all of what stands at a place. `frame`: of the whole screen."""
    shown = places_of(state)[place]
    settings = state.session.history(ProposalHistory).settings
    if shown is None or settings is None:
        return False
    rows = _places(state, frame.height >= TALL)
    if place >= rows:
        return False
    placed = _place(state, replace(frame, height=rows), place, shown)
    seen = "".join(text for row in placed for text, look in row if look == "strong")
    return "".join(seen.split()) == "".join(item_words(state, shown.item, frame).split())


def item_words(state: ConsoleState, item: ProposedItem, frame: PaintFrame) -> str:
    """`“Hello”`, `on nao, interrupts: “Hello”`, the action's label, `gaze yaw 20`."""
    rest = " ".join(_argument(name, value) for name, value in item.args.items() if name != "text")
    if item.action:
        what = f"{state.label(item.action)} {rest}".strip()
    elif item.verb in ("", "say"):
        what = rest
    else:
        what = f"{item.verb} {rest}".strip()
    where = say("proposals.on_robot", "on {robot}", robot=item.on) if item.on else ""
    busy = word(_BUSY.get(item.when_busy, ""))
    front = clean(", ".join(filter(None, (where, busy, what))))
    if not item.text:
        return front
    said = quotation(item.text, frame.glyphs)
    return f"{front}: {said}" if front else said


#: What the wizard is to know of a sentence before she takes it.
_MARKS = {
    "repeats": Sentence("proposals.repeats", "said just now"),
    "asks again": Sentence("proposals.asks_again", "one more question"),
}
#: What a program wants where the robot is still at something else.
_BUSY = {
    "replace": Sentence("proposals.interrupts", "interrupts"),
    "refuse": Sentence("proposals.if_idle", "only if nothing goes on"),
}


def _argument(name: str, value: Json) -> str:
    told = value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
    return f"{name} {told}"


def _trial(message: SuggestTrial, shown: EventContext) -> EventLine | None:
    if message.offered:
        return None
    return EventLine("info", say("proposals.trial_without", "Nothing is proposed in this trial"))


def _model(message: SuggestState, shown: EventContext) -> EventLine | None:
    if message.how == "loading":
        return EventLine("info", say("proposals.model_loads", "The model is loading"))
    if message.how != "ready":
        return None  # a notice says why, or that a program has left
    after = say("proposals.first_word", "first word after {s:.1f} s", s=message.first_us / 1e6)
    return EventLine("info", say("proposals.model_ready", "The model is ready"), after)


def _taken(message: SuggestTaken, shown: EventContext) -> EventLine:
    return EventLine("info", word(_TAKEN.get(message.how, _AS_IT_IS)), message.text)


_AS_IT_IS = Sentence("proposals.taken", "Proposal taken")
_TAKEN = {
    "edited": Sentence("proposals.edited", "Proposal changed and taken"),
    "own_key": Sentence("proposals.own_key", "Played as proposed"),
}
_GONE = {
    "expired": Sentence("proposals.expired", "Proposal: nobody took it in time"),
    "dismissed": Sentence("proposals.dismissed", "Proposal declined"),
    "refused": Sentence("proposals.taken_refused", "Proposal taken, but refused"),
}


def _gone(message: SuggestGone, shown: EventContext) -> EventLine | None:
    said = _GONE.get(message.how)
    return EventLine("info", word(said)) if said else None


SENTENCES = {
    SuggestTaken: _taken,
    SuggestGone: _gone,
    SuggestTrial: _trial,
    SuggestState: _model,
}

_KEYS_MODULE = f"{__package__}.dialog"
CONSOLE = FeatureConsole(
    commands=(
        FeatureCommand(KEYS[0], calls=f"{_KEYS_MODULE}:take_first", found=False),
        FeatureCommand(KEYS[1], calls=f"{_KEYS_MODULE}:take_second", found=False),
        FeatureCommand(KEYS[2], calls=f"{_KEYS_MODULE}:take_third", found=False),
        FeatureCommand(EDIT, calls=f"{_KEYS_MODULE}:open_edit", found=False),
        FeatureCommand(NONE, calls=f"{_KEYS_MODULE}:dismiss_first", found=False),
    ),
    board=Board(_lines, _rows),
    shown=_just_shown,
)
