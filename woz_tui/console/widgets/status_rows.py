"""The two lines on top: what is being recorded, and how everything is."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from rich.cells import cell_len

from woz_tui.console.drawing.cells import (
    Cells,
    Piece,
    Row,
    clean,
    fit,
    length,
    spread,
)
from woz_tui.console.drawing.glyphs import Glyphs, PaintFrame
from woz_tui.console.drawing.number_text import millis
from woz_tui.console.robot_settings.status import driver_trouble
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.state.replay import wall_time
from woz_tui.console.state.view_models import DriverView
from woz_tui.console.widgets.feature_console import FeatureConsole, under_way
from woz_tui.feature import answer_of, pieces
from woz_tui.protocol.panel_players import part_names
from woz_tui.system.text_cleaning import elapsed

#: Round trips to the terminal from which typing feels slow, and from which it is dangerous (us).
SLOW_LINE_US, BAD_LINE_US = 150_000, 500_000
#: The log is so far behind that an alarm is about time.
LATE_US = 1_000_000
#: Columns from which words stand before figures.
WORDY = 100
#: Cells of the name of what holds (a phase's title), at the most while others want room.
PRESENT = 18
#: Cells between the drivers and what stands at the right.
GAP = 3
#: Cells that a long title keeps beside a trial.
TITLE = 8


@dataclass(frozen=True, slots=True)
class StatusInfo:
    """The line to the wizard's terminal: whether it takes output, its round trip if known; and
    the keys that show what has failed, that say what is wrong with a driver, and that cut short
    what began last. `following`: the key that goes on, and what that begins.
    """

    well: bool = True
    round_trip_us: int | None = None
    failures: str = "enter"
    drivers: str = ""
    cut: str = ""
    following: tuple[str, str] = ("", "")


def status_rows(state: ConsoleState, frame: PaintFrame, line: StatusInfo) -> list[Row]:
    """Two rows of the frame's width. What does not fit is left out from the right, as a whole."""
    glyphs, width = frame.glyphs, frame.width
    vitals: Row = ()
    if state.replay is not None:  # the day of the session, and whether all of its log is there
        began = wall_time(state.settings, 0)
        day = f"  {began:%Y-%m-%d}  " if began is not None else "  "
        whole: Piece = ("log complete ", "muted")
        if state.settings.replay and state.settings.replay.notes:
            whole = (f"{glyphs.warning} log incomplete ", "warn")
        vitals = ((day, "plain"), whole)
    else:
        for part in (_recorder(state, frame), _line(state, line, frame)):
            vitals += (("  ", "plain"), *part)
    for name, each in pieces("console", FeatureConsole).items():
        if each.status is not None:
            vitals = (*answer_of(name, (), each.status, state, frame), *vitals)
    failures = _troubles(state, glyphs, line)
    room = width - length(vitals)
    first = spread(_fitting(_session(state, frame, room), room), vitals, width, glyphs.ellipsis)
    for name, each in pieces("console", FeatureConsole).items():
        if each.under_way is not None:
            left = width - length(failures)
            begun = answer_of(name, (), each.under_way, state, frame, line.cut, left)
            failures = (*begun, *failures)
    room = width - length(failures) - length(present := present_row(state, frame, PRESENT))
    drivers = _drivers(state, glyphs, room - GAP if present else room)
    room -= length(drivers) + GAP
    key, begins = line.following
    following: Row = ((f" {key} ", "key"), (f" {clean(begins)} ", "muted"))
    if not key or length(following) > room:
        following = ()
    present = present_row(state, frame, PRESENT + max(0, room - length(following)))
    return [first, spread(drivers, (*present, *following, *failures), width, glyphs.ellipsis)]


def _fitting(parts: list[Row], width: int) -> Row:
    """As many parts as fit, at least the first."""
    row = parts[0]
    for part in parts[1:]:
        if length(row) + length(part) > width:
            break
        row += part
    return row


def _session(state: ConsoleState, frame: PaintFrame, room: int) -> list[Row]:
    """The more important, the earlier. A long title gives way to the time."""
    glyphs = frame.glyphs
    time = elapsed(frame.now) if state.welcomed else "--:--"
    title = clean(state.plan.title) or "woz"
    values = _values(state, frame)
    badge = _badge(state)
    spare = room - len(time) - 3 - length(badge)
    if state.study.counts:  # then who and what is worth more than the title
        spare -= sum(cell_len(value) + 3 for value in values[:3])
        spare = max(spare, 1 if state.role == "watcher" else TITLE)
    cells = min(cell_len(title), max(1, spare))
    named = ((f" {fit(title, cells, glyphs.ellipsis)}  ", "strong"), (time, "plain"))
    parts: list[Row] = [badge, named] if badge else [named]
    for value in values:
        look = "warn" if value.startswith("no ") else "plain"
        if value.startswith(("break ", "questions ")):
            look = "wait"
        parts.append(((f" {glyphs.middle} ", "faint"), (value, look)))
    # What is left out behind it leaves room for more of the title.
    cells = min(cell_len(title), cells + room - length(_fitting(parts, room)))
    title = fit(title, max(1, cells), glyphs.ellipsis)
    parts[1 if badge else 0] = ((f" {title}  ", "strong"), (time, "plain"))
    return parts


def _badge(state: ConsoleState) -> Row:
    """What this console is, if it does not play."""
    part = clean(state.part)
    if state.role == "watcher":
        what = "NOBODY PLAYS" if state.nobody_plays else "WATCHING"
        return ((f" {what} {part} " if part else f" {what} ", "alarm-soft"),)
    if part:
        return ((f" {part} ", "fill"),)
    if state.replay is not None:
        told = state.settings.replay
        coder = f"CODER {told.coder}" if told and told.coder else "REPLAY"
        return ((f" {coder} ", "fill"),)
    return ()


def _values(state: ConsoleState, frame: PaintFrame) -> list[str]:
    """Who takes part, under which condition, in which trial, and so on."""
    study, start = state.session.study, state.session.start
    others = clean(part_names(state.others, state.others))
    values = [
        clean(study.participant) or "no participant",
        clean(study.condition) or ("no condition" if state.plan.conditions else ""),
        trial_text(state, frame),
        f"with {others}" if others and state.role == "wizard" else "",
    ]
    for name, console in pieces("console", FeatureConsole).items():
        if console.value is not None:
            values.append(answer_of(name, "", console.value, state))
    values.append(f"session {clean(start.session)}" if start is not None and start.session else "")
    return [value for value in values if value]


def trial_text(state: ConsoleState, frame: PaintFrame) -> str:
    """The trial's number and, where the robot process counts them, its time, or the break's."""
    study, now = state.session.study, frame.now
    of = f"{' of ' if frame.width >= WORDY else '/'}{study.planned}" if study.planned else ""
    if study.in_break is not None:
        return f"break {elapsed(now - study.in_break.begin)}"
    if study.trial is not None:
        return f"trial {study.trial.label}{of} {elapsed(now - study.trial.begin)}"
    if under_way(state) is not None:
        return ""  # how far that is has its place
    if study.last_ended is not None:
        return f"trial {study.last_ended.trial}{of} {study.last_ended.outcome:<5}"
    if study.designed:
        return "no trial yet"
    return f"trial {study.number}" if study.number is not None else ""


def _recorder(state: ConsoleState, frame: PaintFrame) -> Row:
    """Whether the log is written; how far it lags, where there is room or it is too much."""
    glyphs = frame.glyphs
    if state.ended:
        return (("session over", "muted"),)
    if state.lost:
        return ((f" {glyphs.error} {state.lost.part.sign} ", "alarm"),)
    recorder = state.session.recorder
    if recorder is None:
        return ((f"{glyphs.no} Not recording yet", "muted"),)
    lag = millis(recorder.lag_us)
    match recorder.level:
        case "ok":
            figure: Row = ((f"{f' ({lag})':<9}", "muted"),) if frame.width >= WORDY else ()
            return ((f"{glyphs.yes} Recording", "good"), *figure)
        case "warn":
            return ((f"{glyphs.warning} Recording {lag} late", "warn"),)
        case "alarm":  # behind the disk, or in trouble with a file: the events say which
            what = f"{lag} LATE" if recorder.lag_us >= LATE_US else "TROUBLE"
            return ((f" {glyphs.error} RECORDING {what} ", "alarm"),)
        case "failed":  # everything is refused, or the wizard goes on all the same
            what = "WITHOUT A RECORD" if recorder.waived else "NOT RECORDED"
            return ((f" {glyphs.error} {what} ", "alarm"),)
        case _:
            return ((f"{glyphs.no} Not recording yet", "muted"),)


def _line(state: ConsoleState, line: StatusInfo, frame: PaintFrame) -> Row:
    """How the terminal is reached; its round trip, where there is room or it is too long. Inside
    tmux, screen or mosh it is they who answer: then nobody knows it.
    """
    glyphs, round_trip = frame.glyphs, line.round_trip_us
    if not line.well:
        return ((f" {glyphs.error} TERMINAL STALLED ", "alarm"),)
    if own := state.line:
        if state.settings.driving == "pressed":
            return ((f"{glyphs.warning} via {own}: a lost line drives on ", "warn"),)
        wide = frame.width >= WORDY
        return ((f"via {own}{', hold a key to drive' if wide else ''} ", "muted"),)
    if round_trip is not None and round_trip >= SLOW_LINE_US:
        look = "bad" if round_trip >= BAD_LINE_US else "warn"
        return ((f"{glyphs.warning} connection {millis(round_trip)} ", look),)
    if frame.width < WORDY:
        return (("connected ", "muted"),)
    shown = glyphs.dash if round_trip is None else millis(round_trip)
    return ((f"connection {shown:<6} ", "muted"),)


_HEALTH = {
    "connected": ("yes", "good", ""),
    "connecting": ("driver", "warn", " connecting"),
    "lost": ("error", "bad", " lost"),
    "faulted": ("warning", "warn", " faulted"),
    "unknown": ("no", "muted", ""),
}


def _drivers(state: ConsoleState, glyphs: Glyphs, room: int) -> Row:
    """Every driver's health. Where they do not fit, a robot of one driver has the robot's name; if
    that is not enough, what troubles a driver is a sign alone, and whoever is not well comes first.
    """
    drivers = [*state.drivers.values()]
    row = _drivers_row(state, glyphs, [(driver, driver.name) for driver in drivers])
    if length(row) <= room:
        return row
    names = state.short_names
    short = [(driver, names[driver.name]) for driver in drivers]
    row = _drivers_row(state, glyphs, short)
    if length(row) <= room:
        return row
    first = sorted(short, key=lambda each: wellness(state, each[0]))
    return _drivers_row(state, glyphs, first, brief=True)


def wellness(state: ConsoleState, driver: DriverView) -> tuple[bool, bool]:
    """Sorts drivers so that whoever is not well comes first."""
    return driver.health == "connected", not driver_trouble(state, driver.name)


def _drivers_row(
    state: ConsoleState,
    glyphs: Glyphs,
    named: Iterable[tuple[DriverView, str]],
    brief: bool = False,
) -> Row:
    row: list[Piece] = [(" ", "plain")]
    for driver, name in named:
        sign, look, word = _HEALTH.get(driver.health, _HEALTH["unknown"])
        row.append((f"{getattr(glyphs, sign)} {clean(name)}{word}", look))
        changed = state.session.modes.get(driver.name)
        if changed is not None and changed.now not in ("", "normal"):
            row.append((f" {changed.now}", "wait"))
        trouble = driver_trouble(state, driver.name)
        if trouble:
            said = f" {glyphs.warning}" if brief else f": {glyphs.warning} {trouble}"
            row.append((said, "warn"))
        row.append(("   ", "plain"))
    return tuple(row[:-1])


def _troubles(state: ConsoleState, glyphs: Glyphs, line: StatusInfo) -> Row:
    """Programs that see what is kept from the wizard; the key that says what is wrong with a
    driver, and what helps, in whole sentences; how much has failed.
    """
    row: Row = ()
    names = ", ".join(map(clean, state.study.seers.values()))
    if names and state.keeps:
        row += ((f" {names} sees all ", "wait"),)
    ill = any(
        driver.health in ("lost", "faulted") or driver_trouble(state, driver.name)
        for driver in state.drivers.values()
    )
    if ill and line.drivers:
        row += ((f" {line.drivers} ", "key"), (" why ", "warn"))
    if failed := len(state.runs.unseen()):
        row += ((f" {glyphs.failed} {failed} failed: {line.failures} ", "alarm"),)
    return row


def present_row(state: ConsoleState, frame: PaintFrame, cells: int) -> Row:
    """What features say of what holds; a name in it has so many cells at the most."""
    row: Row = ()
    for name, each in pieces("console", FeatureConsole).items():
        if each.present is not None:
            row += answer_of(name, (), each.present, state, frame, cells)
    return row


class StatusLines(Cells):
    def paint(self, state: ConsoleState, frame: PaintFrame, line: StatusInfo) -> None:
        """Show the state of the session."""
        self.show(status_rows(state, frame, line))
