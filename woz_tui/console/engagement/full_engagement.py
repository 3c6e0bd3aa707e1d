"""Draws the whole engagement model: states, signs, condition, past changes, what was heard."""

from __future__ import annotations

from dataclasses import replace

from rich.cells import cell_len

from woz_tui.config.engagement_words import CONDITION, UNKNOWN
from woz_tui.config.screen_language import say
from woz_tui.console.drawing.cells import Piece, Row, clean, cut_rows, fit, length, spread
from woz_tui.console.drawing.glyphs import PaintFrame
from woz_tui.console.drawing.meter_rows import hidden_word, side_by_side
from woz_tui.console.drawing.number_text import seconds
from woz_tui.console.engagement.meter import quoted
from woz_tui.console.engagement.sign_bars import queue_bar
from woz_tui.console.engagement.state_diagram import HEIGHT, WIDTH, diagram
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.state.engagement_text import (
    change_reason,
    condition_row,
    count_text,
    has_no_sensor,
    is_used,
    needed_text,
    path_row,
    run_piece,
    short_state,
    sign_name,
    sign_verdict,
    signs_of,
    state_row,
    visitor_code,
    zone_text,
)
from woz_tui.protocol import messages as m
from woz_tui.protocol.requesters import WATCHER
from woz_tui.sensing.sample_values import FLAGS
from woz_tui.sensing.state_machine import TURN
from woz_tui.session.redactor import COARSE, KEPT
from woz_tui.system.text_cleaning import elapsed

#: Columns of the table of signs: name, sensed, filter, verdict; the bar takes what is left.
_NAME, _SENSED, _FILTER, _VERDICT = 9, 15, 7, 28
#: Cells of a state in the list of changes.
_STATE = 18
#: Cells from which the filter is named.
_WITH_FILTER = 70
#: The bar's cells at the most.
_BAR = 22
#: Cells from which what was heard stands beside the diagram.
SIDE_BY_SIDE = WIDTH + 30
#: Lines of the way at the least; below the diagram gives way to the path in words.
_LEAST_HISTORY = 3
#: Lines of what was heard, where it has no place at the side and lines enough.
_HEARD_LINES = 2
#: From so many lines on there is room for air.
_TALL = 24


def full_rows(state: ConsoleState, shown: m.EngagementShown, frame: PaintFrame) -> list[Row]:
    """As many rows as the frame is high; what matters most stands on top."""
    glyphs = frame.glyphs
    table = _sign_table(state, shown, frame)
    top = [_head(state, shown, frame), _speech_row(state, shown, frame)]
    drawn = frame.width >= WIDTH and frame.height >= len(top) + HEIGHT + len(table) + _LEAST_HISTORY
    heard: list[Row] = []
    if drawn:
        way = [(change.was, change.now) for change in reversed(state.engaged.changes)]
        if not way or way[0][1] != shown.state:  # its message is still on the way, or was left out
            way = list(zip(shown.trail, shown.trail[1:], strict=False))[::-1]
        states = diagram(shown.state, way, glyphs)
        if frame.width >= SIDE_BY_SIDE:
            room = frame.width - WIDTH - 2
            beside = _transcript_rows(state, replace(frame, width=room), HEIGHT)
            states = side_by_side([(states, WIDTH), (beside, room)], HEIGHT, glyphs, 2)
        top += states
    else:
        path = f"{say('engagement.path', 'path')}  "
        row = path_row(shown, frame.width - cell_len(path), glyphs)
        top.append(((path, "muted"), *row))
    if not drawn or frame.width < SIDE_BY_SIDE:
        heard = _transcript_rows(state, frame, _HEARD_LINES if frame.height >= _TALL else 1)
    air: list[Row] = [()] if frame.height >= _TALL else []
    rows = [*top, *air, *table, *air]
    rows += _history(state, frame, max(1, frame.height - len(rows) - len(heard)))
    return cut_rows(rows, frame, heard)


# -- what is now --------------------------------------------------------------------------------


def _head(state: ConsoleState, shown: m.EngagementShown, frame: PaintFrame) -> Row:
    """State, time, run; at the right what is known of the visitor, and attention."""
    glyphs = frame.glyphs
    row = state_row(
        state.engaged,
        shown,
        frame.now,
        glyphs,
        frame.width,
        lost=bool(state.lost),
        watches=state.role == WATCHER,
    )
    if shown.attempt:
        attempt = say("engagement.attempt", "attempt {number}", number=shown.attempt)
        row += ((f"  {attempt}", "plain"),)
    run = run_piece(shown, glyphs)
    if run is not None:
        row += (("   ", "plain"), run)
    parts: list[Piece] = []
    if visitor := visitor_code(shown):
        about = state.engaged.visitors.get(shown.visitor, {})
        told = ", ".join(clean(value) for value in about.values() if value)
        named = say("engagement.visitor_named", "visitor {name}", name=visitor)
        parts.append((f"{named}{f' ({told})' if told else ''}", "run"))
    if shown.attention:
        mode = clean(shown.attention)
        told = say("engagement.attention", "attention {mode}", mode=mode)
        parts.append((told, "muted"))
    right: Row = ()
    for part in parts:
        more = (*right, ("  ", "plain"), part) if right else (part,)
        if length(row) + length(more) + 2 <= frame.width:
            right = more
    return spread(row, right, frame.width, glyphs.ellipsis)


def _speech_row(state: ConsoleState, shown: m.EngagementShown, frame: PaintFrame) -> Row:
    """What is being said, which limits run."""
    glyphs, engaged = frame.glyphs, state.engaged
    if state.lost:
        why = state.lost.part.sentence
        told = say("engagement.all_old", "{why}: all this is old", why=why)
        return ((f"{glyphs.stale} {told}", "stale"),)
    row: Row = (("  ", "plain"),)
    if (segment := engaged.speaking(frame.now)) is not None:
        lasts = seconds(frame.now - segment.begin)
        speech = say("engagement.speech", "speech {time}", time=lasts)
        row += ((f"{glyphs.yes} {speech}   ", "good"),)
    limits = running_limits(state, shown, frame.now)
    return (*row, *((f"{text}   ", look) for text, look in limits))


def _sign_table(state: ConsoleState, shown: m.EngagementShown, frame: PaintFrame) -> list[Row]:
    """A line for each sign beneath the names of the columns; last what they come to."""
    filtered = _FILTER + 1 if frame.width >= _WITH_FILTER else 0
    bar = min(_BAR, max(6, frame.width - _NAME - _SENSED - 2 - filtered - 1 - _VERDICT))
    verdict = say("engagement.verdict", "verdict")
    columns = (
        (say("engagement.sign", "sign"), _NAME + 1),
        (say("engagement.sensed", "sensed"), _SENSED + 1),
        (say("engagement.filter", "filter"), filtered),
        (say("engagement.queue", "queue"), bar + 2),
        (verdict, cell_len(verdict)),
    )
    old = bool(state.lost)
    condition = condition_row(shown, frame.glyphs, old=old)
    if length(condition) > frame.width:
        condition = condition_row(shown, frame.glyphs, old=old, brief=True)
    near = say("engagement.up_to", "near: up to {metres:.2f} m", metres=shown.social_distance)
    near = f"   {near}"
    if "distance" in shown.uses and length(condition) + len(near) <= frame.width:
        condition += ((near, "muted"),)
    inner = replace(frame, width=bar)
    return [
        tuple((fit(title, width), "title") for title, width in columns),
        *(_sign(name, shown, state, inner, filtered) for name in signs_of(shown)),
        condition,
    ]


def _sign(
    name: str, shown: m.EngagementShown, state: ConsoleState, frame: PaintFrame, filtered: int
) -> Row:
    """A sign's line. `frame` is the bar's; the filter's name has `filtered` cells."""
    sign = shown.signs[name]
    glyphs = frame.glyphs
    found = sign_verdict(name, shown, glyphs, old=bool(state.lost), sensors=state.sensors)
    used = is_used(name, shown)
    quiet = sign.forced or found.look == "stale" or not used
    row: Row = (
        (fit(sign_name(name), _NAME + 1), "plain" if used else "muted"),
        (f"{fit(_sensed(name, sign), _SENSED, glyphs.ellipsis)} ", "stale" if quiet else "plain"),
        (fit(sign.filter, filtered, glyphs.ellipsis), "muted"),
        *queue_bar(sign, frame.width, glyphs, "muted" if quiet else "good"),
        (" ", "plain"),
    )
    if not used:
        return (*row, (f" {say('engagement.unused', 'not used')}", "muted"))
    verdict = f"{found.sign} {found.word}"
    if sign.filter == KEPT or (found.look == "stale" and has_no_sensor(sign)):
        return (*row, (f" {verdict}", found.look))
    row += ((f" {fit(verdict, 9, glyphs.ellipsis)}", found.look),)
    if sign.forced:
        return (*row, (f" {glyphs.forced} {say('events.by_hand', 'by hand')}", "wait"))
    if sign.places <= 0:
        return row
    needed = "" if found.look == "stale" else f", {needed_text(sign)}"
    return (*row, (f" {count_text(sign)}{needed}", "muted"))


def _sensed(name: str, sign: m.SignShown) -> str:
    """The last sample, without any filter."""
    if sign.filter in (KEPT, COARSE):
        return hidden_word() if sign.filter == KEPT else say("engagement.blurred", "blurred")
    if name not in CONDITION and sign.raw_name == UNKNOWN:
        return say("engagement.no_identity", "Unknown")
    if name not in CONDITION:
        return clean(sign.raw_name) or say("meters.nothing", "nothing")
    if sign.raw is None:
        return say("meters.nothing", "nothing")
    if name == "distance":
        if sign.raw >= 100:
            return say("meters.far", "far")
        return f"{sign.raw:.2f} m {zone_text(sign.raw)}"
    return say("meters.says_yes", "yes") if FLAGS[name](sign.raw) else say("meters.says_no", "no")


# -- what was -------------------------------------------------------------------------------------


def _history(state: ConsoleState, frame: PaintFrame, room: int) -> list[Row]:
    """The changes, newest on top: when, to what, why, and by whom."""
    glyphs = frame.glyphs
    rows: list[Row] = [
        (
            (f"{elapsed(change.t):>6} ", "muted"),
            (f"{glyphs.forced} " if change.forced else "  ", "wait"),
            (fit(short_state(change.now), _STATE), "plain"),
            (glyphs.plain(clean(change_reason(change))), "muted"),
        )
        for change in reversed(state.engaged.changes)
    ]
    return rows[:room] or [((say("engagement.unchanged", "nothing has changed yet"), "muted"),)]


def _transcript_rows(state: ConsoleState, frame: PaintFrame, room: int) -> list[Row]:
    """What was understood, newest on top."""
    if state.perception.hides("transcript"):
        return [((say("engagement.speech_hidden", "what was said is hidden"), "muted"),)]
    rows: list[Row] = [
        ((f"{elapsed(segment.t):>6} ", "muted"), quoted(segment, frame.glyphs))
        for segment in state.engaged.transcripts()
    ]
    return rows[:room]


#: The limit that counts from the entry into a state.
_LIMITS = {
    "PersonDetected": "approach",
    "UserSpeaks": "listening",
    "RobotThinks": "thinking",
    "RobotReplies": "talking",
    "RobotSpeaks": "talking",
}
#: States that `absent` ends.
_BUSY = ("Handshake", "UserSpeaks", "RobotThinks", "RobotReplies", "RobotSpeaks")
#: From this share of a limit on it is amber.
_SOON = 0.75


def running_limits(state: ConsoleState, shown: m.EngagementShown, now: int) -> list[Piece]:
    """`12 of 60 s to speak` for the present state, and that it ends soon as its visitor left."""
    limits = state.settings.engagement
    limit = limits.timeouts.get(_LIMITS.get(shown.state, ""))
    if shown.state == "Handshake":
        limit = limits.handshake
    pieces: list[Piece] = []
    if limit is not None and limit > 0:
        gone = max(0, now - shown.since) / 1e6
        look = "warn" if gone >= _SOON * limit else "muted"
        pieces.append((_limit_text(shown.state, min(gone, limit), limit), look))
    absent, presence = limits.timeouts.get("absent"), shown.signs.get("presence")
    if absent and shown.state in _BUSY and presence is not None and presence.verdict == 0:
        told = say(
            "engagement.ends_absent", "ends {seconds:g} s after the visitor left", seconds=absent
        )
        pieces.append((told, "muted"))
    elif not shown.engaged and shown.state in TURN and limits.timeouts.get("unengaged"):
        told = say(
            "engagement.ends_unengaged",
            "ends {seconds:g} s after they turned away",
            seconds=limits.timeouts["unengaged"],
        )
        pieces.append((told, "muted"))
    return pieces


def _limit_text(state: str, gone: float, limit: float) -> str:
    """How much of a state's limit is gone, and what ends there."""
    match state:
        case "PersonDetected":
            return say(
                "engagement.to_engage",
                "{gone:.0f} of {limit:.0f} s to engage",
                gone=gone,
                limit=limit,
            )
        case "RobotThinks":
            return say(
                "engagement.to_answer",
                "{gone:.0f} of {limit:.0f} s to answer",
                gone=gone,
                limit=limit,
            )
        case "RobotReplies":
            return say(
                "engagement.to_reply",
                "{gone:.0f} of {limit:.0f} s to reply",
                gone=gone,
                limit=limit,
            )
        case "Handshake":
            return say(
                "engagement.for_handshake",
                "{gone:.0f} of {limit:.0f} s for the handshake",
                gone=gone,
                limit=limit,
            )
    return say(
        "engagement.to_speak", "{gone:.0f} of {limit:.0f} s to speak", gone=gone, limit=limit
    )
