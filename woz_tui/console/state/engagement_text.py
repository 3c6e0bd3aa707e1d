"""Words, signs and looks for the engagement model's signs, states and waits."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import NamedTuple

from rich.cells import cell_len

from woz_tui.config.engagement_words import CONDITION, MODES, SIGNS
from woz_tui.console.drawing.cells import Piece, Row, clean, fit
from woz_tui.console.drawing.glyphs import Glyphs
from woz_tui.console.drawing.number_text import seconds
from woz_tui.console.state.engagement import EngagementView
from woz_tui.protocol import messages as m
from woz_tui.session.redactor import COARSE, HIDDEN, KEPT
from woz_tui.system.text_cleaning import elapsed

#: From here on the wait for an answer is too long for a visitor: people like an answer within a
#: second and suffer two (T. Shiwa et al., How quickly should communication robots respond?, HRI
#: 2008). From the second on our own: long before it, people speak again or turn away.
SLOW_US, LONG_US = 2_000_000, 5_000_000
#: A state in a few words, for the diagram and the path: its name is for files and logs.
SHORT = {
    "Wait": "nobody",
    "PersonDetected": "somebody there",
    "EngagedWithUnknown": "engaged, no name",
    "Handshake": "asks the name",
    "EngagedWithKnown": "engaged, known",
    "UserSpeaks": "visitor speaks",
    "RobotThinks": "waits for answer",
    "RobotReplies": "robot answers",
    "RobotSpeaks": "robot speaks",
    "stop": "ended",
}
#: What a state means for the wizard. `{who}` is `visitor V2`, or `visitor` while nobody knows who;
#: `{whose}` answer is the wizard's, who is another one where somebody only watches.
SENTENCES = {
    "Wait": "nobody there",
    "PersonDetected": "somebody there, not engaged",
    "EngagedWithUnknown": "visitor without a name, engaged",
    "Handshake": "visitor is asked for a name",
    "EngagedWithKnown": "{who}, engaged",
    "UserSpeaks": "{who} speaks",
    "RobotThinks": "{who} waits for {whose} answer",
    "RobotReplies": "robot answers {who}",
    "RobotSpeaks": "robot speaks to {who}",
    "stop": "the model has ended",
}
#: The same wait where it has less room.
_BRIEF = ("waits for your answer", "waits for answer", "waits")
#: From here on a wait is counted in whole seconds, in microseconds.
_WHOLE_US = 10_000_000
#: A sign in a word.
WORD = {"presence": "person", "gaze": "looks", "distance": "near", "identity": "who?"}
#: The mode of attention that nobody needs to be told.
USUAL_ATTENTION = MODES[2]
#: Cells of a state's short name at the most, where nobody has written one.
_SHORT_CELLS = 12
#: What is not known of identities, as the model calls it.
_UNKNOWN = ("", "Unknown")
#: How a change by the wizard's hand begins in the log.
_HAND = re.compile(r"^(forced|stepped) by the wizard( \([^)]*\))?: ")
#: And one by somebody else's.
_OTHER_HAND = re.compile("^(forced|stepped) by (?!the wizard)")


class SignVerdict(NamedTuple):
    """A verdict: its sign, its word, its look."""

    sign: str
    word: str
    look: str


def short_state(state: str) -> str:
    """A state in a few words."""
    return SHORT.get(state) or fit(state, min(_SHORT_CELLS, cell_len(clean(state))))


def signs_of(shown: m.EngagementShown) -> list[str]:
    """Names of the signs that the model has, always in the same order."""
    return [name for name in SIGNS if name in shown.signs]


def is_used(name: str, shown: m.EngagementShown) -> bool:
    """Whether it is part of the condition, or gives a name."""
    return name in shown.uses or name not in CONDITION


def has_no_sensor(sign: m.SignShown) -> bool:
    """Whether nobody has ever given it, neither a sensor nor the wizard."""
    if sign.filter in (KEPT, COARSE):
        return False  # nobody tells the wizard
    named = bool(sign.raw_name) or sign.name not in _UNKNOWN
    return sign.raw is None and not named and not sign.forced


def is_nobody_there(shown: m.EngagementShown) -> bool:
    """Whether presence says so: then a sensor that has nobody to measure is not stale."""
    presence = shown.signs.get("presence")
    return presence is not None and presence.verdict == 0 and not presence.stale


def sign_verdict(
    name: str,
    shown: m.EngagementShown,
    glyphs: Glyphs,
    *,
    old: bool = False,
    sensors: Iterable[str] = (),
) -> SignVerdict:
    """The verdict on one sign; `old`: the connection is lost. `sensors`: those of the session,
    also of one robot among several.
    """
    sign = shown.signs.get(name, m.SignShown())
    if sign.filter == KEPT:
        return SignVerdict(glyphs.middle, HIDDEN, "muted")
    if sign.stale and not (old or sign.forced) and is_nobody_there(shown):
        there = not has_no_sensor(sign) or name in (each.rpartition(".")[2] for each in sensors)
        if there and name in CONDITION:
            return SignVerdict(glyphs.no, "nobody", "muted")
    if old or (sign.stale and not sign.forced):
        return SignVerdict(glyphs.stale, "no sensor" if has_no_sensor(sign) else "stale", "stale")
    if name not in CONDITION:
        known = sign.name not in _UNKNOWN
        named = clean(sign.name) if known else "unknown"
        return SignVerdict(glyphs.yes if known else glyphs.no, named, "good" if known else "muted")
    if sign.verdict is None:
        return SignVerdict("?", "not yet", "muted")
    return (
        SignVerdict(glyphs.yes, "yes", "good")
        if sign.verdict
        else SignVerdict(glyphs.no, "no", "muted")
    )


def count_text(sign: m.SignShown) -> str:
    """`5 of 8`, for a joint filter `87 %`."""
    if sign.places <= 0:
        return ""
    return f"{sign.count} %" if _in_per_cent(sign) else f"{sign.count} of {sign.places}"


def needed_text(sign: m.SignShown) -> str:
    """`needs 4`."""
    return f"needs {sign.needed}{' %' if _in_per_cent(sign) else ''}"


def _in_per_cent(sign: m.SignShown) -> bool:
    """A joint filter counts per cent."""
    return sign.filter == "joint" and sign.places == 100


def state_sentence(
    state: str, visitor: str, glyphs: Glyphs | None = None, *, watches: bool = False
) -> str:
    """A state in words for a person: `visitor V2, engaged`. `watches`: who plays is another one."""
    name = "" if visitor in _UNKNOWN else clean(visitor)
    said = {
        "who": f"visitor {name}" if name else "visitor",
        "whose": "the wizard's" if watches else "your",
    }
    told = SENTENCES[state].format_map(said) if state in SENTENCES else clean(state)
    return glyphs.plain(told) if glyphs is not None else told


def state_row(
    engaged: EngagementView,
    shown: m.EngagementShown,
    now: int,
    glyphs: Glyphs,
    room: int,
    *,
    lost: bool = False,
    watches: bool = False,
) -> Row:
    """The state as a sentence, with its sign and for how long, in `room` cells if it fits; a wait
    grows louder and gets another sign when it is too long. `lost`: the connection is, so that this
    is old.
    """
    told = state_sentence(shown.state, shown.visitor, glyphs, watches=watches)
    if lost:
        return ((f"{glyphs.stale} {told}", "stale"),)
    waited = engaged.waited(now)
    if engaged.off:
        return ((f"{glyphs.stopped} the model is off", "warn"),)
    if waited is None:
        sign: Piece = (f"{glyphs.yes} ", "good") if shown.engaged else (f"{glyphs.no} ", "muted")
        lasted = f" {elapsed(max(0, now - shown.since))}"
        if cell_len(told) + cell_len(lasted) + 2 > room:
            lasted = ""
        return (sign, (told, "strong"), (lasted, "muted"))
    figure = seconds(waited)
    if waited >= _WHOLE_US:  # `41 s`, from 100 s on `04:35`
        figure = f"{waited // 1_000_000} s" if waited < 100_000_000 else elapsed(waited)
    presence = shown.signs.get("presence")
    if presence is not None and presence.verdict == 0:
        figure += ", not seen"  # nobody is lost while the robot thinks: they may have gone
    brief = ["waits for your answer", "waits for answer", "waits"]
    brief = brief[1:] if watches else brief
    for text in (f"{words}, {figure}" for words in (told, *brief)):
        if cell_len(text) + 2 <= room:
            break
    if waited >= LONG_US:
        return ((f"{glyphs.error} {text}", "bad"),)
    if waited >= SLOW_US:
        return ((f"{glyphs.warning} {text}", "warn"),)
    return ((f"{glyphs.waits} {text}", "plain"),)


def run_piece(shown: m.EngagementShown, glyphs: Glyphs, *, terse: bool = False) -> Piece | None:
    """Whether the machine does not run by itself, and where it would go."""
    if shown.run == "off":
        return (f"{glyphs.stopped} off", "warn")
    if shown.run != "hold":
        return None
    if not shown.next:
        return (f"{glyphs.stopped} held", "warn")
    if terse:
        return (f"{glyphs.stopped} held {glyphs.next} {short_state(shown.next)}", "warn")
    return (f"{glyphs.stopped} held: next {short_state(shown.next)}", "warn")


def path_row(shown: m.EngagementShown, width: int, glyphs: Glyphs) -> Row:
    """The last states, the newest at the right; the oldest are left out where room is short."""
    names = [short_state(state) for state in shown.trail] or [short_state(shown.state)]
    arrow = f" {glyphs.next} "
    before = ""
    for number, name in reversed(list(enumerate(names[:-1]))):
        more = f"{name}{arrow}{before}"
        room = width - cell_len(names[-1]) - (cell_len(glyphs.ellipsis + arrow) if number else 0)
        if cell_len(more) > room:
            before = f"{glyphs.ellipsis}{arrow}{before}"
            break
        before = more
    return ((before, "muted"), (names[-1], "strong"))


def condition_row(
    shown: m.EngagementShown, glyphs: Glyphs, *, old: bool = False, brief: bool = False
) -> Row:
    """`not engaged: presence yes AND gaze no (2 of 8, needs 4) AND near yes`; `brief`: without
    figures.
    """
    row: Row = (("engaged", "good") if shown.engaged else ("not engaged", "warn"),)
    for number, name in enumerate(shown.uses):
        sign = shown.signs.get(name, m.SignShown())
        found = sign_verdict(name, shown, glyphs, old=old)
        word = "near" if name == "distance" else clean(name)
        row += ((" AND " if number else ": ", "muted"), (f"{word} {found.word}", found.look))
        if found.word == "no" and not (brief or sign.forced) and sign.places > 0:
            row += ((f" ({count_text(sign)}, {needed_text(sign)})", "muted"),)
        if sign.forced:
            row += ((f" {glyphs.forced}{'' if brief else ' by hand'}", "wait"),)
    return row


def change_reason(change: m.EngagementChanged) -> str:
    """Why it changed, without who did it in front: for lines that have a mark for that."""
    return _HAND.sub("", change.why) if change.forced else change.why


def forced_by_another(change: m.EngagementChanged) -> bool:
    """Whether not the wizard's hand but a program's or a re-run's has moved the model."""
    return change.forced and _OTHER_HAND.match(change.why) is not None


def visitor_code(shown: m.EngagementShown) -> str:
    """The visitor's code, or nothing."""
    return "" if shown.visitor in _UNKNOWN else clean(shown.visitor)
