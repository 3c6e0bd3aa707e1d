"""The two lines on top: what is being recorded, and how everything is."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from rich.cells import cell_len

from woz_tui.config.screen_language import say, word
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
from woz_tui.console.state.event_sentences import TRIAL_OUTCOMES
from woz_tui.console.state.replay import wall_time
from woz_tui.console.state.view_models import DriverView
from woz_tui.console.widgets.feature_console import FeatureConsole, under_way
from woz_tui.feature import answer_of, pieces
from woz_tui.protocol.panel_players import part_names
from woz_tui.protocol.sentence import Sentence
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
#: Cells that a long title keeps between trials, and beside one that runs.
TITLE, TITLE_IN_TRIAL = 8, 4


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
        whole: Piece = (f"{say('status.log_complete', 'log complete')} ", "muted")
        if state.settings.replay and state.settings.replay.notes:
            lacks = say("status.log_incomplete", "log incomplete")
            whole = (f"{glyphs.warning} {lacks} ", "warn")
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
        spare -= sum(cell_len(value) + 3 for value, _ in values[:3])
        kept = TITLE if state.session.study.trial is None else TITLE_IN_TRIAL
        spare = max(spare, 1 if state.role == "watcher" else kept)
    cells = min(cell_len(title), max(1, spare))
    named = ((f" {fit(title, cells, glyphs.ellipsis)}  ", "strong"), (time, "plain"))
    parts: list[Row] = [badge, named] if badge else [named]
    parts += [((f" {glyphs.middle} ", "faint"), value) for value in values]
    # What is left out behind it leaves room for more of the title.
    cells = min(cell_len(title), cells + room - length(_fitting(parts, room)))
    title = fit(title, max(1, cells), glyphs.ellipsis)
    parts[1 if badge else 0] = ((f" {title}  ", "strong"), (time, "plain"))
    return parts


def _badge(state: ConsoleState) -> Row:
    """What this console is, if it does not play."""
    part = clean(state.part)
    if state.role == "watcher":
        return ((f" {_watching(state, part)} ", "alarm-soft"),)
    if part:
        return ((f" {part} ", "fill"),)
    if state.replay is not None:
        told = state.settings.replay
        what = say("status.replay", "REPLAY")
        if told and told.coder:
            what = say("status.coder", "CODER {coder}", coder=told.coder)
        return ((f" {what} ", "fill"),)
    return ()


def _watching(state: ConsoleState, part: str) -> str:
    if state.nobody_plays:
        if part:
            return say("status.nobody_plays_part", "NOBODY PLAYS {part}", part=part)
        return say("status.nobody_plays", "NOBODY PLAYS")
    if part:
        return say("status.watching_part", "WATCHING {part}", part=part)
    return say("status.watching", "WATCHING")


def _values(state: ConsoleState, frame: PaintFrame) -> list[Piece]:
    """Who takes part, under which condition, in which trial, and so on."""
    study, start = state.session.study, state.session.start
    others = clean(part_names(state.others, state.others))
    values: list[Piece] = [
        (clean(study.participant), "plain")
        if study.participant
        else (say("status.no_participant", "no participant"), "warn")
    ]
    if study.condition:
        values.append((clean(study.condition), "plain"))
    elif state.plan.conditions:
        values.append((say("status.no_condition", "no condition"), "warn"))
    values.append(_trial(state, frame))
    if others and state.role == "wizard":
        values.append((say("status.with", "with {others}", others=others), "plain"))
    for name, console in pieces("console", FeatureConsole).items():
        if console.value is not None:  # something is open
            values.append((answer_of(name, "", console.value, state), "wait"))
    if start is not None and start.session:
        code = say("status.session", "session {code}", code=clean(start.session))
        values.append((code, "plain"))
    return [(text, look) for text, look in values if text]


def trial_text(state: ConsoleState, frame: PaintFrame) -> str:
    """The trial's number and, where the robot process counts them, its time, or the break's."""
    return _trial(state, frame)[0]


def _trial(state: ConsoleState, frame: PaintFrame) -> Piece:
    study, now = state.session.study, frame.now
    if study.in_break is not None:
        lasts = elapsed(now - study.in_break.begin)
        return say("status.break", "break {lasts}", lasts=lasts), "wait"
    if study.trial is not None:
        number = _of_planned(study.trial.label, study.planned, frame)
        lasts = elapsed(now - study.trial.begin)
        told = say("status.trial_lasts", "trial {number} {lasts}", number=number, lasts=lasts)
        return told, "plain"
    if under_way(state) is not None:
        return "", "plain"  # how far that is has its place
    if (ended := study.last_ended) is not None:
        number = _of_planned(ended.trial, study.planned, frame)
        how = word(TRIAL_OUTCOMES.get(ended.outcome, ended.outcome))
        return say("status.trial_ended", "trial {number} {how:<5}", number=number, how=how), "plain"
    if study.designed:
        return say("status.no_trial", "no trial yet"), "warn"
    if study.number is None:
        return "", "plain"
    return say("status.trial", "trial {number}", number=study.number), "plain"


def _of_planned(number: object, planned: int, frame: PaintFrame) -> str:
    """`2 of 8`, or `2/8` where room is short."""
    if not planned:
        return f"{number}"
    if frame.width < WORDY:
        return f"{number}/{planned}"
    return say("status.number_of", "{number} of {planned}", number=number, planned=planned)


def _recorder(state: ConsoleState, frame: PaintFrame) -> Row:
    """Whether the log is written; how far it lags, where there is room or it is too much."""
    glyphs = frame.glyphs
    if state.ended:
        return ((say("status.session_over", "session over"), "muted"),)
    if state.lost:
        return ((f" {glyphs.error} {state.lost.part.sign} ", "alarm"),)
    not_yet: Row = ((f"{glyphs.no} {say('status.not_recording', 'Not recording yet')}", "muted"),)
    recorder = state.session.recorder
    if recorder is None:
        return not_yet
    lag = millis(recorder.lag_us)
    match recorder.level:
        case "ok":
            figure: Row = ((f"{f' ({lag})':<9}", "muted"),) if frame.width >= WORDY else ()
            return ((f"{glyphs.yes} {say('status.recording', 'Recording')}", "good"), *figure)
        case "warn":
            late = say("status.recording_late", "Recording {lag} late", lag=lag)
            return ((f"{glyphs.warning} {late}", "warn"),)
        case "alarm":  # behind the disk, or in trouble with a file: the events say which
            what = say("status.recording_trouble", "RECORDING TROUBLE")
            if recorder.lag_us >= LATE_US:
                what = say("status.recording_very_late", "RECORDING {lag} LATE", lag=lag)
            return ((f" {glyphs.error} {what} ", "alarm"),)
        case "failed":  # everything is refused, or the wizard goes on all the same
            what = say("status.not_recorded", "NOT RECORDED")
            if recorder.waived:
                what = say("status.without_record", "WITHOUT A RECORD")
            return ((f" {glyphs.error} {what} ", "alarm"),)
        case _:
            return not_yet


def _line(state: ConsoleState, line: StatusInfo, frame: PaintFrame) -> Row:
    """How the terminal is reached; its round trip, where there is room or it is too long. Inside
    tmux, screen or mosh it is they who answer: then nobody knows it.
    """
    glyphs, round_trip = frame.glyphs, line.round_trip_us
    if not line.well:
        stalled = say("status.terminal_stalled", "TERMINAL STALLED")
        return ((f" {glyphs.error} {stalled} ", "alarm"),)
    if own := state.line:
        if state.settings.driving == "pressed":
            told = say("status.drives_on", "via {own}: a lost line drives on", own=own)
            return ((f"{glyphs.warning} {told} ", "warn"),)
        told = say("status.via", "via {own}", own=own)
        if frame.width >= WORDY:
            told = say("status.hold_to_drive", "via {own}, hold a key to drive", own=own)
        return ((f"{told} ", "muted"),)
    if round_trip is not None and round_trip >= SLOW_LINE_US:
        look = "bad" if round_trip >= BAD_LINE_US else "warn"
        slow = say("status.slow", "connection {time}", time=millis(round_trip))
        return ((f"{glyphs.warning} {slow} ", look),)
    if frame.width < WORDY:
        return ((f"{say('status.connected', 'connected')} ", "muted"),)
    shown = glyphs.dash if round_trip is None else millis(round_trip)
    return ((f"{say('status.connection', 'connection {time:<6}', time=shown)} ", "muted"),)


_HEALTH = {
    "connected": ("yes", "good", ""),
    "connecting": ("driver", "warn", Sentence("status.connecting", "connecting")),
    "lost": ("error", "bad", Sentence("status.lost", "lost")),
    "faulted": ("warning", "warn", Sentence("status.faulted", "faulted")),
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
        sign, look, state_word = _HEALTH.get(driver.health, _HEALTH["unknown"])
        how = f" {word(state_word)}" if state_word else ""
        row.append((f"{getattr(glyphs, sign)} {clean(name)}{how}", look))
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
        row += ((f" {say('status.sees_all', '{names} sees all', names=names)} ", "wait"),)
    ill = any(
        driver.health in ("lost", "faulted") or driver_trouble(state, driver.name)
        for driver in state.drivers.values()
    )
    if ill and line.drivers:
        row += ((f" {line.drivers} ", "key"), (f" {say('status.why', 'why')} ", "warn"))
    if failed := len(state.runs.unseen()):
        key = line.failures
        told = say("status.failed", "{number} failed: {key}", number=failed, key=key)
        row += ((f" {glyphs.failed} {told} ", "alarm"),)
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
