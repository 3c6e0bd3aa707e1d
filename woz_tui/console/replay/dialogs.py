"""Dialogs of a replay: go somewhere in the log, set a code, read the keys and about the log."""

from __future__ import annotations

from typing import ClassVar

from textual.binding import Binding, BindingType
from textual.content import Content
from textual.fuzzy import Matcher

from woz_tui.config.screen_language import say, word
from woz_tui.console.drawing.cells import Row, clean, fit
from woz_tui.console.replay.timeline import sign_of
from woz_tui.console.screens.choice import SearchDialog
from woz_tui.console.screens.dialog import Dialog, ReportDialog
from woz_tui.console.screens.help import HelpDialog
from woz_tui.console.screens.note import NoteDialog
from woz_tui.console.state.engagement_text import short_state
from woz_tui.console.state.replay import TimelinePlace, wall_time
from woz_tui.protocol.requests import AskMarker, AskReplay, Reply
from woz_tui.protocol.sentence import Sentence
from woz_tui.protocol.welcome import ReplayedLog
from woz_tui.replay.seek import time_of
from woz_tui.system.text_cleaning import elapsed

TIME, SORT = 8, 14


class GoDialog(SearchDialog[TimelinePlace]):
    """Type `12:34`, or a few letters of a marker; arrows choose among all places."""

    heading = Sentence("replay.go_to", "Go to")
    hint = Sentence("replay.go_keys", "enter goes there · arrows choose · ctrl+q closes")
    placeholder = Sentence(
        "replay.go_what", "12:34, or a few letters of a marker, note, trial, stop ..."
    )
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("pageup", "choose(-10)", priority=True),
        Binding("pagedown", "choose(10)", priority=True),
    ]

    def matching(self, typed: str) -> list[TimelinePlace]:
        """All places; from a time that is typed on, or those that the letters stand for."""
        replay = self.state.replay
        places = list(replay.places) if replay is not None else []
        t = time_of(typed)
        if t is not None:
            return [
                TimelinePlace(t, "time", say("replay.this_time", "this time")),
                *(p for p in places if p.t >= t),
            ]
        matcher = Matcher(typed)
        return [
            p for p in places if not typed or matcher.match(f"{_sort(p.sort)} {_place_text(p)}")
        ]

    def first(self, typed: str) -> int:
        """The next one after now, as long as nothing is typed."""
        later = (n for n, place in enumerate(self.shown) if place.t > self.now)
        return 0 if typed else next(later, len(self.shown) - 1)

    def line(self, item: TimelinePlace) -> Content:
        """Its time, its sort, its text."""
        sign, look = sign_of(item.sort, self.glyphs)
        colour = {"bad": "bold $woz-bad", "plain": ""}.get(look, f"$woz-{look}")
        return Content.assemble(
            fit(elapsed(item.t), TIME, right=True),
            "  ",
            (sign, colour),
            "  ",
            (fit(_sort(item.sort), SORT, self.glyphs.ellipsis), "$woz-muted"),
            clean(_place_text(item)),
        )

    def chose(self, item: TimelinePlace | None, typed: str) -> None:
        """Go to it, or to what was typed."""
        to = f"{item.t / 1_000_000:.6f}" if item is not None else typed
        if to:
            self.requests.ask(AskReplay(what="go", to=to))


#: Sorts of places, of so many cells as they have in the list at the most.
_SORTS = {
    "time": Sentence("replay.time", "time"),
    "stop": Sentence("replay.stop", "stop"),
    "lost": Sentence("replay.lost", "lost"),
    "mistake": Sentence("replay.mistake", "mistake"),
    "marker": Sentence("replay.marker", "marker"),
    "code": Sentence("replay.code", "code"),
    "note": Sentence("replay.note", "note"),
    "questionnaire": Sentence("replay.questionnaire", "questionnaire"),
    "trial": Sentence("replay.trial", "trial"),
    "phase": Sentence("replay.phase", "phase"),
    "break": Sentence("replay.break", "break"),
    "engagement": Sentence("replay.engagement", "engagement"),
    "end": Sentence("replay.end", "end"),
}


def _sort(sort: str) -> str:
    return word(_SORTS.get(sort, sort))


def _place_text(place: TimelinePlace) -> str:
    """What is there, in the words of the screen."""
    return short_state(place.text) if place.sort == "engagement" else word(place.text)


class _PausesReplay(Dialog):
    """Stands still while it is open, and goes on if it went."""

    _played = _over = False

    def on_mount(self) -> None:
        """Stand still."""
        self.requests.ask(AskReplay(what="hold"), self._held)

    def _held(self, reply: Reply) -> None:
        self._played = isinstance(reply.data, dict) and reply.data.get("plays") is True
        if self._over:
            self._go_on()

    def closing(self) -> None:
        """Go on; a dialog may close before it has the reply."""
        super().closing()
        self._over = True
        self._go_on()

    def _go_on(self) -> None:
        if self._played:
            self._played = False
            self.requests.ask(AskReplay(what="pause"))


class CodeDialog(_PausesReplay, SearchDialog[str]):
    """Type a code, or choose one that was set before."""

    heading = Sentence("replay.code_heading", "Code")
    hint = Sentence("replay.code_keys", "enter sets it · arrows choose · ctrl+q closes")
    placeholder = Sentence(
        "replay.code_what",
        'a code, e.g. smiles; or tier: code, e.g. gaze: robot ("gaze:" ends it)',
    )

    def matching(self, typed: str) -> list[str]:
        """What is typed, then codes of before that begin so, the latest in the log first."""
        replay = self.state.replay
        places = replay.places if replay is not None else ()
        before = dict.fromkeys(place.text for place in reversed(places) if place.sort == "code")
        found = [code for code in before if code.casefold().startswith(typed.casefold())]
        return list(dict.fromkeys([typed, *found])) if typed else found

    def line(self, item: str) -> Content:
        return Content(clean(item))

    def chose(self, item: str | None, typed: str) -> None:
        text = item or typed.strip()
        if text:
            self.requests.ask(AskMarker(text=text))


class CodeNoteDialog(_PausesReplay, NoteDialog):
    """Type a sentence about this moment; it goes into the file of codes."""

    hint = Sentence("replay.note_keys", "enter writes it beside the log · ctrl+q closes")


NAME = 14
#: Facts of a log, of so many cells at the most.
_FACTS = {
    "log": Sentence("replay.fact_log", "log"),
    "began": Sentence("replay.fact_began", "began"),
    "length": Sentence("replay.fact_length", "length"),
    "session": Sentence("replay.fact_session", "session"),
    "participant": Sentence("replay.fact_participant", "participant"),
    "condition": Sentence("replay.fact_condition", "condition"),
    "wizard": Sentence("replay.fact_wizard", "wizard"),
    "experiment": Sentence("replay.fact_experiment", "experiment"),
    "software": Sentence("replay.fact_software", "software"),
}


class ReplayHelp(HelpDialog):
    """The keys of the replay, then those of the session as they were."""

    heading = Sentence("replay.keys_heading", "Keys of the replay")

    def lines(self) -> list[Row]:
        """Key and meaning, one a line."""
        first, *others = super().lines()
        del first
        nothing = say("replay.play_nothing", "Replay: the keys of the panels play nothing")
        return [((nothing, "title"),), *others]

    def _by_hand(self) -> list[Row]:
        """None: a replay has no overrides."""
        return []


class AboutDialog(ReportDialog):
    """The log: which session, which experiment, how whole it is."""

    heading = Sentence("replay.about", "This log")
    size_class = "wide"

    def lines(self) -> list[Row]:
        """One fact a line; what is missing in full sentences."""
        state, told = self.state, self.state.settings.replay or ReplayedLog()
        began = wall_time(state.settings, 0)
        start = state.session.start
        length = elapsed(state.replay.length_us) if state.replay is not None else ""
        facts = {
            "log": state.log,
            "began": f"{began:%Y-%m-%d %H:%M:%S} UTC" if began is not None else "",
            "length": length,
            "session": start.session if start is not None else "",
            "participant": state.session.study.participant,
            "condition": state.session.study.condition,
            **{name: getattr(told, name) for name in ("wizard", "experiment", "software")},
        }
        rows: list[Row] = [
            ((fit(word(_FACTS[name]), NAME), "muted"), (clean(str(value)), "plain"))
            for name, value in facts.items()
            if value not in ("", None)
        ]
        rows.append(())
        if not told.notes:
            return [
                *rows,
                (
                    (f"{self.glyphs.yes} ", "good"),
                    (say("replay.complete", "The log is complete."), "plain"),
                ),
            ]
        mark = (f"{self.glyphs.warning} ", "warn")
        return [*rows, *((mark, (clean(note), "plain")) for note in told.notes)]
