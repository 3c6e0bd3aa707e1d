"""Words, signs and looks for the engagement model's signs, states and waits."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import NamedTuple

from rich.cells import cell_len

from woz_tui.config.engagement_words import CONDITION, MODES, SIGNS
from woz_tui.config.screen_language import inner_text, say, word
from woz_tui.console.drawing.cells import Piece, Row, clean, fit
from woz_tui.console.drawing.glyphs import Glyphs
from woz_tui.console.drawing.meter_rows import hidden_word
from woz_tui.console.drawing.number_text import seconds
from woz_tui.console.state.engagement import EngagementView
from woz_tui.console.state.view_models import READING_WORDS
from woz_tui.console.state.wizard_overrides import SIGN_NAMES
from woz_tui.protocol import messages as m
from woz_tui.protocol.requesters import OF_WIZARD
from woz_tui.protocol.sentence import Sentence
from woz_tui.sensing.sample_values import zone
from woz_tui.session.redactor import COARSE, KEPT
from woz_tui.system.text_cleaning import elapsed

#: From here on the wait for an answer is too long for a visitor: people like an answer within a
#: second and suffer two (T. Shiwa et al., How quickly should communication robots respond?, HRI
#: 2008). From the second on our own: long before it, people speak again or turn away.
SLOW_US, LONG_US = 2_000_000, 5_000_000
#: A state in a few words, for the diagram and the path: its name is for files and logs. The
#: diagram has no room for words that are longer than the English ones.
SHORT: Mapping[str, Sentence] = {
    "Wait": Sentence("engagement.nobody", "nobody"),
    "PersonDetected": Sentence("engagement.somebody", "somebody there"),
    "EngagedWithUnknown": Sentence("engagement.no_name", "engaged, no name"),
    "Handshake": Sentence("engagement.asks_name", "asks the name"),
    "EngagedWithKnown": Sentence("engagement.known", "engaged, known"),
    "UserSpeaks": Sentence("engagement.visitor_speaks", "visitor speaks"),
    "RobotThinks": Sentence("engagement.waits_for_answer", "waits for answer"),
    "RobotReplies": Sentence("engagement.robot_answers", "robot answers"),
    "RobotSpeaks": Sentence("engagement.robot_speaks", "robot speaks"),
    "stop": Sentence("engagement.ended", "ended"),
}
#: From here on a wait is counted in whole seconds, in microseconds.
_WHOLE_US = 10_000_000
#: A sign in a word.
_WORD: Mapping[str, Sentence] = {
    "presence": Sentence("engagement.person", "person"),
    "gaze": Sentence("engagement.looks", "looks"),
    "distance": Sentence("engagement.near", "near"),
    "identity": Sentence("engagement.who", "who?"),
}
#: The mode of attention that nobody needs to be told.
USUAL_ATTENTION = MODES[2]
#: Cells of a state's short name at the most, where nobody has written one.
_SHORT_CELLS = 12
#: What is not known of identities, as the model calls it.
_UNKNOWN = ("", "Unknown")
#: The reasons of changes by somebody's hand.
_BY_HAND = frozenset({"why.forced_by", "why.stepped_by"})
#: How a change by the wizard's hand begins in the log.
_HAND = re.compile(r"^(forced|stepped) by the wizard( \([^)]*\))?: ")
#: And one by somebody else's.
_OTHER_HAND = re.compile("^(forced|stepped) by (?!the wizard)")


class SignVerdict(NamedTuple):
    """A verdict: its sign, its word, its look; whether it speaks `against` engagement."""

    sign: str
    word: str
    look: str
    against: bool = False


def short_state(state: str) -> str:
    """A state in a few words."""
    if state in SHORT:
        return word(SHORT[state])
    return fit(state, min(_SHORT_CELLS, cell_len(clean(state))))


def sign_word(name: str) -> str:
    """A sign in a word that says what it is if it is there."""
    return word(_WORD.get(name, name))


def sign_name(name: str) -> str:
    """What the screen calls a sign."""
    return word(SIGN_NAMES.get(name, name))


def zone_text(metres: float) -> str:
    """Hall's space at a distance."""
    name = zone(metres)
    return word(READING_WORDS.get(name, name))


def nothing_seen() -> str:
    """What a distance says that measures nothing."""
    return say("meters.nothing_seen", "nothing seen")


def roughly(text: str) -> str:
    """What is shown in place of a value that the wizard may see roughly alone."""
    return word(READING_WORDS.get(text, text)) or nothing_seen()


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
        return SignVerdict(glyphs.middle, hidden_word(), "muted")
    if sign.stale and not (old or sign.forced) and is_nobody_there(shown):
        there = not has_no_sensor(sign) or name in (each.rpartition(".")[2] for each in sensors)
        if there and name in CONDITION:
            return SignVerdict(glyphs.no, say("engagement.nobody", "nobody"), "muted")
    if old or (sign.stale and not sign.forced):
        told = say("meters.stale", "stale")
        if has_no_sensor(sign):
            told = say("engagement.no_sensor", "no sensor")
        return SignVerdict(glyphs.stale, told, "stale")
    if name not in CONDITION:
        known = sign.name not in _UNKNOWN
        named = clean(sign.name) if known else say("meters.unknown", "unknown")
        return SignVerdict(glyphs.yes if known else glyphs.no, named, "good" if known else "muted")
    if sign.verdict is None:
        return SignVerdict("?", say("engagement.not_yet", "not yet"), "muted")
    if sign.verdict:
        return SignVerdict(glyphs.yes, say("meters.says_yes", "yes"), "good")
    return SignVerdict(glyphs.no, say("meters.says_no", "no"), "muted", against=True)


def count_text(sign: m.SignShown) -> str:
    """`5 of 8`, for a joint filter `87 %`."""
    if sign.places <= 0:
        return ""
    if _in_per_cent(sign):
        return f"{sign.count} %"
    return say("engagement.count", "{done} of {places}", done=sign.count, places=sign.places)


def needed_text(sign: m.SignShown) -> str:
    """`needs 4`."""
    needed = f"{sign.needed}{' %' if _in_per_cent(sign) else ''}"
    return say("engagement.needs", "needs {needed}", needed=needed)


def _in_per_cent(sign: m.SignShown) -> bool:
    """A joint filter counts per cent."""
    return sign.filter == "joint" and sign.places == 100


def state_sentence(
    state: str, visitor: str, glyphs: Glyphs | None = None, *, watches: bool = False
) -> str:
    """A state in words for a person: `visitor V2, engaged`. `watches`: who plays is another one."""
    name = "" if visitor in _UNKNOWN else clean(visitor)
    who = say("engagement.visitor", "visitor")
    if name:
        who = say("engagement.visitor_named", "visitor {name}", name=name)
    told = _sentence(state, who, watches=watches)
    return glyphs.plain(told) if glyphs is not None else told


def _sentence(state: str, who: str, *, watches: bool) -> str:
    match state:
        case "Wait":
            return say("engagement.nobody_there", "nobody there")
        case "PersonDetected":
            return say("engagement.not_engaged_yet", "somebody there, not engaged")
        case "EngagedWithUnknown":
            return say("engagement.nameless", "visitor without a name, engaged")
        case "Handshake":
            return say("engagement.is_asked", "visitor is asked for a name")
        case "EngagedWithKnown":
            return say("engagement.who_engaged", "{who}, engaged", who=who)
        case "UserSpeaks":
            return say("engagement.who_speaks", "{who} speaks", who=who)
        case "RobotThinks" if watches:
            return say(
                "engagement.waits_for_wizard", "{who} waits for the wizard's answer", who=who
            )
        case "RobotThinks":
            return say("engagement.waits_for_you", "{who} waits for your answer", who=who)
        case "RobotReplies":
            return say("engagement.answers_who", "robot answers {who}", who=who)
        case "RobotSpeaks":
            return say("engagement.speaks_to", "robot speaks to {who}", who=who)
        case "stop":
            return say("engagement.model_ended", "the model has ended")
    return clean(state)


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
        return ((f"{glyphs.stopped} {say('engagement.is_off', 'the model is off')}", "warn"),)
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
        # Nobody is lost while the robot thinks: they may have gone.
        figure = say("engagement.unseen", "{time}, not seen", time=figure)
    brief = [
        say("engagement.waits_for_answer", "waits for answer"),
        say("engagement.waits", "waits"),
    ]
    if not watches:
        brief.insert(0, say("engagement.waits_for_yours", "waits for your answer"))
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
        return (f"{glyphs.stopped} {say('engagement.is_switched_off', 'off')}", "warn")
    if shown.run != "hold":
        return None
    held = say("engagement.held", "held")
    if shown.next:
        state = short_state(shown.next)
        held = f"{held} {glyphs.next} {state}"
        if not terse:
            held = say("engagement.held_next", "held: next {state}", state=state)
    return (f"{glyphs.stopped} {held}", "warn")


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
    row: Row = ((say("engagement.not_engaged", "not engaged"), "warn"),)
    if shown.engaged:
        row = ((say("engagement.engaged", "engaged"), "good"),)
    both, by_hand = say("engagement.and", "AND"), say("events.by_hand", "by hand")
    for number, name in enumerate(shown.uses):
        sign = shown.signs.get(name, m.SignShown())
        found = sign_verdict(name, shown, glyphs, old=old)
        told = sign_word(name) if name == "distance" else clean(sign_name(name))
        row += ((f" {both} " if number else ": ", "muted"), (f"{told} {found.word}", found.look))
        if found.against and not (brief or sign.forced) and sign.places > 0:
            row += ((f" ({count_text(sign)}, {needed_text(sign)})", "muted"),)
        if sign.forced:
            row += ((f" {glyphs.forced}{'' if brief else f' {by_hand}'}", "wait"),)
    return row


def change_reason(change: m.EngagementChanged) -> str:
    """Why it changed, without that the wizard did it in front: for lines that have a mark for
    that.
    """
    if forced_by_another(change) or not change.forced:
        return change.why
    hand = _hand(change)
    return str(inner_text(hand["why"])) if "why" in hand else _HAND.sub("", change.why)


def forced_by_another(change: m.EngagementChanged) -> bool:
    """Whether not the wizard's hand but a program's or a re-run's has moved the model."""
    by = _hand(change).get("by")
    if isinstance(by, dict):
        return not str(by.get("code")).startswith(OF_WIZARD)
    return change.forced and _OTHER_HAND.match(change.why) is not None


def _hand(change: m.EngagementChanged) -> Mapping[str, object]:
    """By whom it was moved by hand, and why, as code and values; nothing where it was not, or where
    the log does not say codes.
    """
    told = change.wording.get("why")
    return told.values if told is not None and told.code in _BY_HAND else {}


def visitor_code(shown: m.EngagementShown) -> str:
    """The visitor's code, or nothing."""
    return "" if shown.visitor in _UNKNOWN else clean(shown.visitor)
