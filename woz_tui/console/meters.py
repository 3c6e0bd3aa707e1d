"""What the sensors say: distance, loudness, who is there, engagement, the robot's pose."""

from __future__ import annotations

from dataclasses import replace

from rich.cells import cell_len
from textual.geometry import Size

from woz_tui.console.cells import Cells, Piece, Row, clean, cut, fit, heading, length
from woz_tui.console.figures import SILENCE_DB, decibels
from woz_tui.console.glyphs import Frame, Glyphs
from woz_tui.console.parts import SensorPicture
from woz_tui.console.picture import Picture
from woz_tui.core import messages as m

#: Where Hall's intimate, personal and social spaces end, in metres (E. T. Hall, The Hidden
#: Dimension, 1966); beyond is public.
ZONES = ((0.45, "intimate"), (1.2, "personal"), (3.6, "social"))
#: The far end of the distance ruler, in metres.
FARTHEST = 4.8
#: Rows of meters at the most.
MOST = 40
#: Cells of the names at the left and the values at the right.
NAME, VALUE = 10, 17
#: Sensors with a place of their own; all others get a line each.
_KNOWN = ("distance", "loudness", "presence", "gaze", "identity")


def zone(metres: float) -> str:
    """Hall's name for a distance."""
    return next((name for limit, name in ZONES if metres < limit), "public")


def meter_rows(picture: Picture, frame: Frame) -> list[Row]:
    """At most the frame's height; joints fold into one line of text where room is short."""
    joints = _joints(picture)
    rows = [
        *_distance(picture, frame),
        *_loudness(picture, frame),
        *_verdicts(picture, frame),
        *_engagement(picture, frame),
        *_others(picture, frame),
    ]
    if joints:
        room = frame.height - len(rows)
        if room >= len(joints):
            rows += [_joint(picture, name, shown, frame) for name, shown in joints.items()]
        else:
            rows += _folded(picture, joints, frame)
    if not rows:
        rows = [((fit(" no sensor has said anything yet", frame.width), "muted"),)]
    return [cut(row, frame.width, frame.glyphs.ellipsis) for row in rows[: frame.height]]


def _joints(picture: Picture) -> dict[str, str]:
    """Joints by their full name, with the short one where that is no other joint's."""
    full = sorted(
        {
            name.partition(".")[2]
            for name in picture.sensors
            if name.startswith(("joint.", "setpoint."))
        }
    )
    short = [name.rpartition(".")[2] for name in full]
    return {
        name: last if short.count(last) == 1 else name
        for name, last in zip(full, short, strict=True)
    }


def _labelled(name: str, body: Row, value: str, look: str) -> Row:
    return (
        (f" {fit(name, NAME - 1)}", "muted"),
        *body,
        (f" {fit(value, VALUE - 2)} ", look),
    )


def _track(frame: Frame) -> int:
    return max(5, frame.width - NAME - VALUE)


def _stale(picture: Picture, sensor: SensorPicture, frame: Frame) -> bool:
    return picture.is_stale(sensor, frame.now)


def _old(sensor: SensorPicture, frame: Frame) -> str:
    age = max(0, frame.now - sensor.t) / 1e6
    shown = f"{age:.0f} s" if age < 99.5 else f"{age / 60:.0f} min"
    return f"{frame.glyphs.stale}{shown} old"


# -- distance and loudness ----------------------------------------------------------------------


def _distance(picture: Picture, frame: Frame) -> list[Row]:
    sensor = picture.sensors.get("distance")
    if sensor is None:
        return []
    glyphs, width = frame.glyphs, _track(frame)
    ticks = {_at(limit / FARTHEST, width): glyphs.tick for limit, _ in ZONES}
    stale = _stale(picture, sensor, frame)
    if sensor.value is None:
        text = _old(sensor, frame) if stale else "nothing seen"
        return [_labelled("distance", _ruler(width, ticks, {}, glyphs), text, "stale")]
    spot = {_at(sensor.value / FARTHEST, width): (glyphs.spot, "stale" if stale else "strong")}
    text = f"{sensor.value:.2f} m {zone(sensor.value)}"
    if stale:
        text = f"{sensor.value:.1f} m {_old(sensor, frame)}"
    look = "stale" if stale else "plain"
    return [_labelled("distance", _ruler(width, ticks, spot, glyphs), text, look)]


def _at(share: float, width: int) -> int:
    return min(width - 1, max(0, int(share * width)))


def _ruler(
    width: int, ticks: dict[int, str], spots: dict[int, tuple[str, str]], glyphs: Glyphs
) -> Row:
    """A line with ticks on it and spots on top of them."""
    pieces: list[Piece] = []
    for x in range(width):
        text, look = spots.get(x, (ticks.get(x, glyphs.track), "faint"))
        if pieces and pieces[-1][1] == look:
            pieces[-1] = (pieces[-1][0] + text, look)
        else:
            pieces.append((text, look))
    return tuple(pieces)


def _loudness(picture: Picture, frame: Frame) -> list[Row]:
    sensor = picture.sensors.get("loudness")
    if sensor is None:
        return []
    glyphs, width = frame.glyphs, _track(frame)
    stale = _stale(picture, sensor, frame)
    if sensor.value is None or stale:
        empty: Row = ((glyphs.track * width, "faint"),)
        return [_labelled("loudness", empty, _old(sensor, frame), "stale")]
    level = decibels(sensor.value)
    speaking = sensor.state == "speaking"
    full = _at(1 - level / SILENCE_DB, width + 1)
    threshold = _threshold(picture)
    at = None if threshold is None else _at(1 - decibels(threshold) / SILENCE_DB, width)
    loud = "good" if speaking else "run"
    pieces: list[Piece] = []
    for x in range(width):
        look = loud if x < full else "faint"
        text = glyphs.bar if x < full else glyphs.track
        if x == at:
            text, look = glyphs.tick, "strong"
        if pieces and pieces[-1][1] == look:
            pieces[-1] = (pieces[-1][0] + text, look)
        else:
            pieces.append((text, look))
    mark = f"{glyphs.yes} voice" if speaking else clean(sensor.state)
    return [
        _labelled(
            "loudness", tuple(pieces), f"{level:3.0f} dB {mark}", "good" if speaking else "plain"
        )
    ]


def _threshold(picture: Picture) -> float | None:
    """RMS from which a voice counts, as the microphone published it or the host told."""
    published = picture.sensors.get("loudness.threshold")
    if published is not None:
        return published.value
    told = picture.settings.get("loudness_threshold")
    return float(told) if isinstance(told, int | float) else None


# -- who is there, and what the robot makes of it -------------------------------------------------


def _verdicts(picture: Picture, frame: Frame) -> list[Row]:
    """Presence, gaze and identity with a mark each: yes, no, old."""
    pieces: list[Piece] = []
    for name, word in (("presence", "person"), ("gaze", "looks")):
        sensor = picture.sensors.get(name)
        if sensor is None:
            continue
        pieces.append(_verdict(sensor, word, _stale(picture, sensor, frame), frame.glyphs))
        pieces.append(("  ", "plain"))
    who = picture.sensors.get("identity")
    if who is not None:
        name = clean(who.text) or "unknown"
        look = "stale" if _stale(picture, who, frame) else "plain" if who.text else "muted"
        pieces.append((name, look))
    return [((f" {fit('visitor', NAME - 1)}", "muted"), *pieces)] if pieces else []


def _verdict(sensor: SensorPicture, word: str, stale: bool, glyphs: Glyphs) -> Piece:
    if stale:
        return (f"{glyphs.stale} {word}", "stale")
    if sensor.value is not None and sensor.value >= 0.5:
        return (f"{glyphs.yes} {word}", "good")
    return (f"{glyphs.no} {word}", "muted")


def _engagement(picture: Picture, frame: Frame) -> list[Row]:
    changed = picture.engagement
    if changed is None:
        return []
    verdicts = "  ".join(_marked(changed, frame.glyphs))
    first: Row = (
        (f" {fit('engaged', NAME - 1)}", "muted"),
        (clean(changed.now), "strong"),
    )
    if length(first) + cell_len(verdicts) + 2 <= frame.width:
        first += ((f"  {verdicts}", "muted"),)
    why: Row = ((" " * NAME, "plain"), (clean(changed.why), "muted"))
    return [first, why]


def _marked(changed: m.EngagementChanged, glyphs: Glyphs) -> list[str]:
    marked = []
    for name, value in changed.verdicts.items():
        if isinstance(value, bool | int | float):
            marked.append(f"{glyphs.yes if value else glyphs.no} {clean(name)}")
        elif isinstance(value, str):
            marked.append(clean(value))
    return marked


# -- the robot's pose, and everything else ----------------------------------------------------


def _joint(picture: Picture, name: str, shown: str, frame: Frame) -> Row:
    """Where the joint is (full mark) and where it should be (hollow mark), in degrees."""
    glyphs, width = frame.glyphs, _track(frame)
    present, wanted = picture.sensors.get(f"joint.{name}"), picture.sensors.get(f"setpoint.{name}")
    values = [s.value for s in (present, wanted) if s is not None and s.value is not None]
    half = 90.0 if all(abs(value) <= 90 for value in values) else 180.0
    spots: dict[int, tuple[str, str]] = {}
    stale = present is not None and _stale(picture, present, frame)
    look = "stale" if stale else "plain"
    texts = []
    if present is not None and present.value is not None:
        texts.append(f"{present.value:4.0f}{glyphs.degrees}")
    if wanted is not None and wanted.value is not None:
        spots[_at((wanted.value + half) / (2 * half), width)] = (glyphs.target, "run")
        if present is None or present.value is None or abs(wanted.value - present.value) >= 1:
            texts.append(f"{glyphs.next} {wanted.value:.0f}{glyphs.degrees}")
    if present is not None and present.value is not None:
        at = _at((present.value + half) / (2 * half), width)
        spots[at] = (glyphs.position, "stale" if stale else "strong")
    text = _old(present, frame) if stale and present is not None else " ".join(texts)
    return _labelled(shown, _ruler(width, {width // 2: glyphs.tick}, spots, glyphs), text, look)


def _folded(picture: Picture, joints: dict[str, str], frame: Frame) -> list[Row]:
    """All joints as text, in as many lines as are left, at least one."""
    row: list[Piece] = [(" ", "plain")]
    for name, short in joints.items():
        sensor = picture.sensors.get(f"joint.{name}") or picture.sensors[f"setpoint.{name}"]
        stale = _stale(picture, sensor, frame)
        value = "?" if sensor.value is None else f"{sensor.value:.0f}{frame.glyphs.degrees}"
        mark = frame.glyphs.stale if stale else ""
        row.append((f"{short} ", "muted"))
        row.append((f"{mark}{value:<5}", "stale" if stale else "plain"))
    return [tuple(row)]


def _others(picture: Picture, frame: Frame) -> list[Row]:
    rows: list[Row] = []
    for name, sensor in sorted(picture.sensors.items()):
        if name in _KNOWN or name.startswith(("joint.", "setpoint.", "loudness.")):
            continue
        stale = _stale(picture, sensor, frame)
        number = "" if sensor.value is None else f"{sensor.value:.4g} {sensor.unit}".strip()
        text = " ".join(part for part in (clean(sensor.text), number) if part) or "nothing"
        state = _old(sensor, frame) if stale else clean(sensor.state)
        room = max(1, frame.width - NAME - cell_len(state) - 2)
        row: Row = (
            (f" {fit(name, NAME - 1)}", "muted"),
            (fit(text, room), "stale" if stale else "plain"),
            (f" {state} ", "stale" if stale else "muted"),
        )
        rows.append(row)
    return rows


class Meters(Cells):
    """The meters."""

    def paint(self, picture: Picture, frame: Frame) -> None:
        """Show a heading, and what the sensors said last."""
        tall = self.styles.height is not None and self.styles.height.is_auto
        inner = replace(frame, height=MOST if tall else frame.height - 1)
        rows = [heading("Sensors", frame), *meter_rows(picture, inner)]
        grown = len(rows) != len(self.rows)
        self.show(rows)
        if tall and grown:
            self.refresh(layout=True)

    def get_content_height(self, container: Size, viewport: Size, width: int) -> int:
        """Where there is room, as high as its rows."""
        return max(1, len(self.rows))
