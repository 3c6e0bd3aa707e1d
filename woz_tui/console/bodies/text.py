"""Describes in words and figures what a body is doing."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from woz_tui.config.screen_language import say
from woz_tui.console.bodies.view import BodyView
from woz_tui.console.drawing.cells import Row, clean, fit
from woz_tui.console.drawing.glyphs import Glyphs
from woz_tui.motion.modes import BLINKS, BREATHES, Mode
from woz_tui.protocol.messages import Json

#: A body that was told no rate of its own breathes once in so many beats.
BEATS_A_BREATH = 4
#: Cells of the names in front of values, and where there is less room than `ROOMY`.
NAMES, SHORT_NAMES, ROOMY = 12, 6, 22


def emotion_of(seen: BodyView) -> tuple[str, float | None]:
    """The emotion that is shown, and how strongly, 0..1; neutral has no intensity."""
    face = seen.face
    emotion = str(seen.value("emotion") or (face.emotion if face is not None else "") or "")
    told = seen.value("intensity")
    strength = told if isinstance(told, int | float) else face.intensity if face else None
    return emotion, None if emotion == "neutral" else strength


def emotion_text(seen: BodyView) -> str:
    """`happy 80 %`."""
    emotion, strength = emotion_of(seen)
    return emotion if strength is None else f"{emotion} {percent(strength)}"


def activity_row(seen: BodyView, glyphs: Glyphs) -> Row:
    """What it does, in one short line: the move, else the mode."""
    move = str(seen.value("move") or "")
    playing: Row = ((f"{glyphs.running} {clean(move)}", "run"),) if move else ()
    if seen.mode != "normal":
        return ((clean(seen.mode), "wait"), *(((" ", "plain"), *playing) if move else ()))
    return playing or ((seen.mode, "muted"),)


def percent(share: Json) -> str:
    """0..1 as a percentage."""
    return f"{share:.0%}".replace("%", " %") if isinstance(share, int | float) else "-"


def short_rows(seen: BodyView, glyphs: Glyphs) -> list[Row]:
    """The two lines for which there is always room."""
    if seen.old:
        return [((seen.old, "stale"),), activity_row(seen, glyphs)]
    return [((clean(emotion_text(seen)), "plain"),), activity_row(seen, glyphs)]


def word_rows(seen: BodyView, glyphs: Glyphs, width: int, height: int) -> list[Row]:
    """As much as fits beside a face, the most important first."""
    move = clean(str(seen.value("move") or "")) or glyphs.dash
    personality = str(seen.value("personality", "name") or "")
    if personality and seen.value("changed") is True:
        # Once a trait was turned it is not quite that.
        personality = say("body.like", "like {personality}", personality=personality)
    lines: list[tuple[str, str, str]] = [
        (say("body.face", "face"), emotion_text(seen) or glyphs.dash, "plain"),
        (say("body.mode", "mode"), seen.mode, "plain" if seen.mode == "normal" else "wait"),
        (say("body.move", "move"), move, "plain" if move == glyphs.dash else "run"),
        (say("body.personality", "personality"), personality or glyphs.dash, "plain"),
        (say("body.breathes", "breathes"), _breathing(seen, glyphs), "plain"),
        (say("body.blinks", "blinks"), _blinking(seen, glyphs), "plain"),
        (say("body.tempo", "tempo"), value_text("tempo", seen.value("tempo"), glyphs), "plain"),
        (say("body.seen", "seen"), seen.old, "stale") if seen.old else ("", "", "plain"),
    ]
    if not seen.values:  # of a body that tells no more than its face and its mode
        lines = [*lines[:2], *lines[-1:]]
    if height < len(lines):
        lines = [line for line in lines if line[1]][: max(1, height)]
    names = NAMES if width >= ROOMY else SHORT_NAMES
    return [
        ((fit(name, names, glyphs.ellipsis), "muted"), (clean(text), look))
        for name, text, look in lines[:height]
    ]


def _moves_by_itself(modes: Collection[Mode], mode: str) -> bool:
    """Whether the body does so by itself in this mode; in an unknown mode it is assumed to."""
    return mode in {known.value for known in modes} or mode not in {known.value for known in Mode}


def _breathing(seen: BodyView, glyphs: Glyphs) -> str:
    if seen.value("breathing_on") is False or not _moves_by_itself(BREATHES, seen.mode):
        return say("meters.says_no", "no")
    rate = _breaths(seen.value("breathing_rate"), seen.value("tempo"))
    return (
        say("meters.says_yes", "yes")
        if rate is None
        else value_text("breathing_rate", rate, glyphs)
    )


def _breaths(rate: Json, tempo: Json) -> Json:
    """Breaths a second: a rate of their own, or by the tempo."""
    return tempo / BEATS_A_BREATH if rate is None and isinstance(tempo, int | float) else rate


def _blinking(seen: BodyView, glyphs: Glyphs) -> str:
    if seen.value("blinking") is False or not _moves_by_itself(BLINKS, seen.mode):
        return say("meters.says_no", "no")
    rate = seen.value("blink_rate")
    return (
        value_text("blink_rate", rate, glyphs)
        if isinstance(rate, int | float)
        else say("meters.says_yes", "yes")
    )


# -- the whole table ------------------------------------------------------------------------------


_PLAIN, _SHARE, _SIGNED = "{:.2f}", "{:.0%}", "{:+.2f}"
_HERTZ, _SECONDS = "{:.2f} Hz", "{:.2f} s"
#: Values in the order of the table, and how their numbers are written.
FORMATS: Mapping[str, str] = {
    "mode": _PLAIN,
    "move": _PLAIN,
    "emotion": _PLAIN,
    "intensity": _SHARE,
    "valence": _SIGNED,
    "arousal": _SIGNED,
    "eye_x": _SIGNED,
    "eye_y": _SIGNED,
    "brightness": _SHARE,
    "personality": _PLAIN,
    "breathing_on": _PLAIN,
    "blinking": _PLAIN,
    "stopped": _PLAIN,
    "tempo": _HERTZ,
    "breathing": "{:.1f}°",
    "breathing_rate": _HERTZ,
    "blink_rate": "{:.0f}/min",
    "blink_time": _SECONDS,
    "blink_irregularity": _PLAIN,
    "smoothing": _SECONDS,
    "compression": _SHARE,
    "speed": _PLAIN,
    "amplitude": _PLAIN,
}


def value_text(name: str, value: Json, glyphs: Glyphs) -> str:
    """A value with its unit."""
    if value is None or value == "":
        return glyphs.dash
    if isinstance(value, bool):
        return say("body.is_on", "on") if value else say("body.is_off", "off")
    if isinstance(value, int | float):
        return glyphs.plain(FORMATS.get(name, _PLAIN).format(value).replace("%", " %"))
    if isinstance(value, list):
        return ", ".join(value_text(name, one, glyphs) for one in value)
    return clean(str(value))


#: Cells of a value at the least.
VALUES = 6
#: What a value is called in the table, where its own name would be misread.
TITLES: Mapping[str, str] = {"breathing_on": "breathes", "blinking": "blinks"}


def table_rows(seen: BodyView, glyphs: Glyphs, width: int, height: int) -> list[Row]:
    """Every value of the body in fixed places, in as many columns as needed."""
    known = {name.replace("-", "_"): value for name, value in seen.values.items()}
    if "breathing_rate" in known:
        known["breathing_rate"] = _breaths(known["breathing_rate"], known.get("tempo"))
    names = [name for name in FORMATS if name in known]
    names += sorted(name for name in known if name not in FORMATS)
    if not names:
        return [((say("body.no_values", "no values from the body yet"), "muted"),)]
    lines = max(1, min(height, len(names)))
    columns = [names[start : start + lines] for start in range(0, len(names), lines)]
    titles = {name: TITLES.get(name, name.replace("_", " ")) for name in names}
    fronts = [max(len(titles[name]) for name in column) + 1 for column in columns]
    each = max(VALUES, (width - sum(fronts)) // len(columns) - 1)
    look = "stale" if seen.old else "plain"
    rows: list[Row] = [() for _ in range(lines)]
    for column, front in zip(columns, fronts, strict=True):
        for line, name in enumerate(column):
            label = fit(titles[name], front, glyphs.ellipsis)
            value = fit(value_text(name, known[name], glyphs), each, glyphs.ellipsis)
            rows[line] += ((label, "muted"), (value, look), (" ", "plain"))
    return rows
