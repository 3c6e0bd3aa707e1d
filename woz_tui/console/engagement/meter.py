"""Rows of the engagement model among the meters: state, then what is to be done, then why.

How much of it is shown follows from the height alone, and every row has its place: nothing moves
about while visitors come and go.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import zip_longest

from rich.cells import cell_len

from woz_tui.config.screen_language import say
from woz_tui.console.drawing.cells import Piece, Row, clean, cut, fit, length
from woz_tui.console.drawing.glyphs import Glyphs
from woz_tui.console.drawing.meter_rows import (
    SECOND,
    MeterFrame,
    age_note,
    hidden_row,
    hidden_word,
    meter_row,
    name_piece,
)
from woz_tui.console.drawing.number_text import age, seconds
from woz_tui.console.engagement.sign_bars import distance_bar, queue_bar
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.state.engagement_text import (
    USUAL_ATTENTION,
    change_reason,
    count_text,
    is_nobody_there,
    is_used,
    nothing_seen,
    roughly,
    run_piece,
    sign_verdict,
    sign_word,
    signs_of,
    state_row,
    zone_text,
)
from woz_tui.protocol import messages as m
from woz_tui.protocol.requesters import WATCHER
from woz_tui.session.redactor import KEPT, perceived_kind

#: Lines from which path and reason have a row each, and from which each sign has one.
MIDDLE, FULL = 8, 14
#: What was heard stays for so long where it shares its row with the path, in microseconds.
HEARD_US = 30_000_000

#: Draws the rows of the loudness, given how long somebody has been speaking.
Loudness = Callable[[ConsoleState, MeterFrame, str], list[Row]]


def block_rows(
    state: ConsoleState, shown: m.EngagementShown, frame: MeterFrame, loudness: Loudness
) -> dict[str, list[Row]]:
    """The parts for a session with a model; `loudness` draws the rows that are not the model's."""
    lost = bool(state.lost)
    segment = None if lost else state.engaged.speaking(frame.now)
    lasts = "" if segment is None else seconds(frame.now - segment.begin)
    loud = loudness(state, frame, lasts)
    asks = _attention_pieces(shown, frame, "" if loud else lasts)
    row = state_row(
        state.engaged,
        shown,
        frame.now,
        frame.glyphs,
        frame.width - 1,
        lost=lost,
        watches=state.role == WATCHER,
    )
    attempt = ""
    if shown.attempt:
        attempt = f" {say('engagement.attempt', 'attempt {number}', number=shown.attempt)}"
    rows: list[Row] = [((" ", "plain"), *row, (attempt, "muted"))]
    heard: list[Row] = []
    if frame.height >= FULL:
        rows.append((name_piece(say("engagement.now", "now"), frame), *(asks or [_dash(frame)])))
        rows.append(_why(state, frame))
        rows += [_single(name, shown, state, frame) for name in signs_of(shown)]
        heard.append(
            (name_piece(say("events.heard", "heard"), frame), *_transcript_row(state, frame))
        )
    else:
        # What asks for the wizard now with what was just heard, or else what was heard last.
        last = state.engaged.transcripts()[:1]
        if asks and last and frame.now - last[0].t < HEARD_US:
            asks += [("  ", "plain"), quoted(last[0], frame.glyphs)]
        told = asks or _transcript_row(state, frame)
        if [*told] == [_dash(frame)]:
            told = [(say("engagement.nothing_heard", "nothing heard yet"), "muted")]
        rows.append(((" ", "plain"), *told))
        if frame.height >= MIDDLE:
            rows.append(_why(state, frame))
        rows += _pairs(state, shown, frame)
    distance = _distance(state, shown, frame)
    return {"engagement": rows, "distance": distance, "loudness": loud, "heard": heard}


# -- state, waiting, path, why ------------------------------------------------------------------


def _attention_pieces(shown: m.EngagementShown, frame: MeterFrame, unheard: str) -> list[Piece]:
    """What asks for the wizard at this moment; `unheard`: how long speech
    has lasted that no other row has.
    """
    glyphs = frame.glyphs
    found: list[Piece] = []
    if (run := run_piece(shown, glyphs, terse=frame.height < FULL)) is not None:
        found += [("  ", "plain"), run]
    if unheard:
        speech = say("engagement.speech", "speech {time}", time=unheard)
        found += [("  ", "plain"), (f"{glyphs.yes} {speech}", "good")]
    if shown.attention not in ("", USUAL_ATTENTION):
        found += [("  ", "plain"), (clean(shown.attention), "wait")]
    return found[1:]


def _dash(frame: MeterFrame) -> Piece:
    return (frame.glyphs.dash, "faint")


def _why(state: ConsoleState, frame: MeterFrame) -> Row:
    """Why the last change came about."""
    changes = state.engaged.changes
    last = changes[-1] if changes else state.session.model.changed
    if last is None:
        return (name_piece(say("engagement.why", "why"), frame), _dash(frame))
    hand: Row = ((f"{frame.glyphs.forced} ", "wait"),) if last.forced else ()
    return (
        name_piece(say("engagement.why", "why"), frame),
        *hand,
        (frame.glyphs.plain(clean(change_reason(last))), "muted"),
    )


def _transcript_row(state: ConsoleState, frame: MeterFrame) -> Row:
    """What was understood last, and when."""
    if state.perception.hides("transcript"):
        return ((hidden_word(), "muted"),)
    so_far, firm = _so_far(state, frame)
    if so_far:
        glyphs = frame.glyphs
        said, sure = glyphs.plain(clean(so_far)), glyphs.plain(clean(firm))
        sure = sure if said.startswith(sure) else ""
        return (
            (f"{glyphs.opening}{sure}", "good"),
            (f"{said.removeprefix(sure)} {glyphs.ellipsis}", "faint"),
        )
    heard = state.engaged.transcripts()
    if not heard:
        return (_dash(frame),)
    last = heard[0]
    ago = say("engagement.ago", "{age} ago", age=age(frame.now - last.t))
    return ((f"{ago} ", "muted"), quoted(last, frame.glyphs))


def _so_far(state: ConsoleState, frame: MeterFrame) -> tuple[str, str]:
    """What was understood up to now of what is being said, where a driver tells; and the firm
    beginning of it.
    """
    segment = None if state.lost else state.engaged.speaking(frame.now)
    if segment is None:
        return "", ""
    found = [state.sensor(name) for name in state.sensors if perceived_kind(name) == "transcript"]
    text = next(
        (
            sensor.text
            for sensor in found
            if sensor is not None and sensor.driver == segment.driver and sensor.t >= segment.begin
        ),
        "",
    )
    return text, state.engaged.firm(segment.driver)


def quoted(heard: m.SpeechText, glyphs: Glyphs) -> Piece:
    """What somebody said, in quotation marks."""
    said = glyphs.plain(clean(heard.text))
    return (f"{glyphs.opening}{said}{glyphs.closing}", "run")


# -- signs --------------------------------------------------------------------------------------


def _pairs(state: ConsoleState, shown: m.EngagementShown, frame: MeterFrame) -> list[Row]:
    """Two signs in a row: mark, word, fill of the queue."""
    found = [
        _pair(name, shown, state, frame, ("  ", SECOND - 1) if number % 2 else (" ", frame.name))
        for number, name in enumerate(signs_of(shown))
    ]
    return [
        (*first, *second) for first, second in zip_longest(found[::2], found[1::2], fillvalue=())
    ]


def _pair(
    name: str,
    shown: m.EngagementShown,
    state: ConsoleState,
    frame: MeterFrame,
    place: tuple[str, int],
) -> Row:
    """`place`: blanks before the mark, and cells before the bar."""
    sign, glyphs, (indent, cells) = shown.signs[name], frame.glyphs, place
    found = sign_verdict(name, shown, glyphs, old=bool(state.lost), sensors=state.sensors)
    is_named = name == "identity" and found.look == "good"
    told = f"{indent}{found.sign} {found.word if is_named else sign_word(name)}"
    if is_named and cell_len(told) >= cells:  # who it is comes before how sure that is
        return cut(((told, found.look),), cells + frame.track, glyphs.ellipsis)
    if not is_used(name, shown):
        back: Row = ((say("engagement.unused", "not used"), "muted"),)
    elif sign.filter == KEPT:
        back = ((hidden_word(), "muted"),)
    elif sign.forced:
        back = ((f"{glyphs.forced} {say('events.by_hand', 'by hand')}", "wait"),)
    elif found.look == "stale":
        back = ((found.word, "stale"),)
    else:
        back = queue_bar(sign, frame.track, glyphs)
    if length(back) <= frame.track:  # words that are longer begin where they can
        told = fit(told, cells - 1, glyphs.ellipsis)
    front: Piece = (f"{told} ", found.look)
    return cut((front, *back), cells + frame.track, glyphs.ellipsis)


def _single(name: str, shown: m.EngagementShown, state: ConsoleState, frame: MeterFrame) -> Row:
    """A row of its own: name, fill of the queue, verdict with its count."""
    sign, glyphs = shown.signs[name], frame.glyphs
    found = sign_verdict(name, shown, glyphs, old=bool(state.lost), sensors=state.sensors)
    quiet = found.look == "stale" or sign.forced or not is_used(name, shown)
    bar = queue_bar(sign, frame.track, glyphs, "muted" if quiet else "good")
    if not is_used(name, shown):
        unused = say("engagement.unused", "not used")
        return meter_row(sign_word(name), bar, unused, "muted", frame)
    if sign.forced:
        told = f"{found.sign} {found.word} {glyphs.forced} {say('engagement.hand', 'hand')}"
        return meter_row(sign_word(name), bar, told, "wait", frame)
    value = f"{found.sign} {found.word}"
    counted = f"{value} {count_text(sign)}"
    if found.look != "stale" and cell_len(counted) <= frame.value:
        value = counted
    return meter_row(sign_word(name), bar, value, found.look, frame)


def _distance(state: ConsoleState, shown: m.EngagementShown, frame: MeterFrame) -> list[Row]:
    """Where the visitor stands among Hall's spaces; no row in a session without a distance."""
    sign = shown.signs.get("distance")
    sensor, title = state.sensor("distance"), say("meters.distance", "distance")
    if sign is not None and sensor is not None and state.perception.keeps("distance"):
        if state.perception.hides("distance"):
            return [hidden_row(title, frame)]
        # The wizard sees near and far alone.
        stale = state.is_stale(sensor, frame.now)
        text = age_note(sensor.t, frame) if stale else roughly(sensor.text)
        bar: Row = ((frame.glyphs.track * frame.track, "faint"),)
        return [meter_row(title, bar, text, "stale" if stale else "plain", frame)]
    if sign is None or (sign.raw is None and sensor is None):
        return []
    stale = bool(state.lost) or sign.stale
    bar = distance_bar(
        sign.raw,
        shown.social_distance,
        frame.track,
        frame.glyphs,
        stale=stale,
    )
    if sign.raw is None:
        return [meter_row(title, bar, nothing_seen(), "muted", frame)]
    figure = f"{sign.raw:.2f} m" if sign.raw < 100 else say("meters.far", "far")
    if sign.stale and not state.lost and is_nobody_there(shown):
        nobody = say("engagement.nobody_there", "nobody there")
        bar = distance_bar(None, shown.social_distance, frame.track, frame.glyphs)
        return [meter_row(title, bar, nobody, "muted", frame)]
    if stale:
        stale_word = say("meters.stale", "stale")
        text = f"{frame.glyphs.stale} {figure} {stale_word}"
        return [meter_row(title, bar, text, "stale", frame)]
    return [meter_row(title, bar, f"{figure} {zone_text(sign.raw)}", "plain", frame)]
