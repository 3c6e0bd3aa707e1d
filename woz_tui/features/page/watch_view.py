"""What the page for watchers says, as plain data: the console's own words.

What a wizard must not know never came here: the session takes it out for watchers, too.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from typing import Any

from woz_tui.console.drawing.cells import clean
from woz_tui.console.drawing.glyphs import UNICODE, PaintFrame
from woz_tui.console.drawing.number_text import SILENCE_DB, decibels
from woz_tui.console.engagement.sign_bars import FARTHEST
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.state.engagement_text import state_sentence
from woz_tui.console.state.event_sentences import EventLine
from woz_tui.console.state.stop_confirmation import missing_words, stopped_words
from woz_tui.console.state.view_models import SensorView
from woz_tui.console.widgets.event_list import event_row, listed_events
from woz_tui.console.widgets.meters import figure
from woz_tui.console.widgets.status_rows import present_row, trial_text
from woz_tui.protocol.panel_players import part_names
from woz_tui.sensing.sample_values import FLAGS, zone
from woz_tui.session.redactor import HIDDEN, perceived_kind
from woz_tui.system.text_cleaning import elapsed

#: Events on the page, and cells that a sentence may have: it is the browser that wraps them.
EVENTS, _WIDTH = 12, 600
#: Cells of a phase's title.
_TITLE = 80
#: Sensors with a meter, in the order of the page; those that the file names come behind them.
_METERS = ("distance", "loudness", "presence", "gaze")
#: What the console calls those that are true or not.
_VERDICTS = {"presence": "person", "gaze": "looks"}

View = dict[str, Any]


def watch_view(state: ConsoleState, now: int, kept: Collection[str] = ()) -> View:
    """All that the page shows at `now`, each part under the name of its place; `kept` are words of
    events that nobody may read there, such as codes.
    """
    frame = PaintFrame(_WIDTH, EVENTS, now)
    return {
        "title": clean(state.plan.title) or "woz",
        "time": elapsed(now) if state.welcomed else "--:--",
        "plays": _plays(state),
        "trial": trial_text(state, frame),
        "phase": "".join(text for text, _ in present_row(state, frame, _TITLE)).strip(),
        "stop": _stop(state),
        "over": bool(state.ended),
        "debrief": False,
        "lost": state.lost.part.title if state.lost and not state.ended else "",
        "engagement": _engagement(state),
        "events": [_event(event, state, frame, kept) for event in listed_events(state, EVENTS)],
        "meters": list(_meters(state, now)),
    }


def _plays(state: ConsoleState) -> str:
    if state.ended:
        return "The session is over"
    if not state.welcomed:
        return "The session is looked for"
    wizards = state.session.wizards
    if state.nobody_plays:
        return "Nobody plays the robot"
    parts = part_names(wizards, wizards)
    return f"The wizard plays ({clean(parts)})" if any(wizards.values()) else "The wizard plays"


def _stop(state: ConsoleState) -> str:
    stop = state.session.stop
    if stop is None:
        return ""
    said = stopped_words(stop, state.others, UNICODE).strip()
    away = missing_words(stop.missing, stop.unreached, stop.parts_missing, state.short_names)
    return "; ".join((said, *map(clean, away)))


def _engagement(state: ConsoleState) -> str:
    """The model's state, and why it has come to it."""
    changed = state.session.model.changed
    if changed is None or state.perception.hides("engagement"):
        return ""
    return state_sentence(changed.now, changed.visitor, watches=True)


def _event(event: EventLine, state: ConsoleState, frame: PaintFrame, kept: Collection[str]) -> View:
    """As the console has it: when, its sign, and the pieces of its sentence. `kind` is the sign in
    a word.
    """
    (when, _), (sign, look), *pieces = event_row(event, state, frame)
    return {
        "when": when.strip(),
        "sign": sign.strip(),
        "look": look,
        "kind": event.mark.replace("_", " "),
        "pieces": [[_without(text, kept), look] for text, look in pieces if text.strip()],
    }


def _without(text: str, kept: Collection[str]) -> str:
    for word in kept:
        text = text.replace(word, UNICODE.ellipsis)
    return text.strip()


def _meters(state: ConsoleState, now: int) -> Iterator[View]:
    """A meter for each sensor: its name, its value in words, and if it has a scale how far it is
    (0 to 1).
    """
    named = (*_METERS, *state.settings.sensors)
    for wanted in dict.fromkeys(named):
        for name in state.sensors:
            sensor = state.sensor(name)
            if sensor is not None and wanted in (name, name.rpartition(".")[2]):
                yield _meter(sensor, state, now)


def _meter(sensor: SensorView, state: ConsoleState, now: int) -> View:
    kind = perceived_kind(sensor.name)
    meter: dict[str, Any] = {
        "name": clean(sensor.name),
        "text": HIDDEN,
        "share": None,
        "old": False,
    }
    if state.perception.hides(kind):
        return meter
    meter["old"] = state.is_stale(sensor, now)
    parts = (clean(sensor.text), figure(sensor, UNICODE), clean(sensor.state).replace("ok", ""))
    meter["text"] = " ".join(filter(None, parts)) or "nothing"
    if state.perception.blurs(kind) or sensor.value is None:
        return meter
    robot, dot, last = sensor.name.rpartition(".")
    if last in _VERDICTS:
        meter["name"] = clean(f"{robot}{dot}{_VERDICTS[last]}")
        meter["text"] = "yes" if FLAGS[last](sensor.value) else "no"
    elif last == "distance":
        meter["text"] = f"{sensor.value:.2f} m {zone(sensor.value)}"
        meter["share"] = _share(sensor.value / FARTHEST)
    elif last == "loudness":
        level = decibels(sensor.value)
        meter["text"] = f"{level:.0f} dB {clean(sensor.state).replace('ok', '')}".strip()
        meter["share"] = _share(1 - level / SILENCE_DB)
    return meter


def _share(value: float) -> float:
    return round(min(1.0, max(0.0, value)), 2)
