"""Find any action, panel or console command by typing a few of its letters."""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

from rich.cells import cell_len
from textual.content import Content
from textual.fuzzy import Matcher

from woz_tui.config.keys.console_keys import played_by
from woz_tui.config.screen_language import say, word
from woz_tui.console.drawing.cells import clean, fit
from woz_tui.console.drawing.key_caps import KeyCap, caption, key_name
from woz_tui.console.screens.choice import ConfirmDialog, SearchDialog
from woz_tui.console.screens.engagement_questions import steer
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.state.wizard_overrides import OVERRIDES, is_offered
from woz_tui.console.widgets.bottom_rows import asked_words, quoted
from woz_tui.console.widgets.feature_console import FeatureConsole
from woz_tui.feature import answers_of, pieces
from woz_tui.protocol.messages import Json
from woz_tui.protocol.requests import AskAction, AskLock, AskVerb
from woz_tui.protocol.sentence import Sentence


@dataclass(frozen=True, slots=True)
class OfferedCall:
    """A verb with its arguments, and what it does in the wizard's words."""

    verb: str
    text: str
    args: Mapping[str, Json]


OFFERED_CALLS = (
    OfferedCall("picture", Sentence("find.picture", "picture of its camera, as a file"), {}),
    OfferedCall(
        "record_sound",
        Sentence("find.record_robot", "record its microphones, on the robot"),
        {"on": True},
    ),
    OfferedCall(
        "record_sound",
        Sentence("find.end_robot", "end the recording on the robot"),
        {"on": False},
    ),
    OfferedCall(
        "listen",
        Sentence("find.record_log", "record its microphones, beside the log"),
        {"on": True},
    ),
    OfferedCall(
        "listen",
        Sentence("find.end_log", "end the recording beside the log"),
        {"on": False},
    ),
    OfferedCall(
        "tablet", Sentence("find.tablet_default", "tablet: the default again"), {"what": "default"}
    ),
    OfferedCall("tablet", Sentence("find.tablet_hide", "tablet: show nothing"), {"what": "hide"}),
    OfferedCall(
        "tablet", Sentence("find.tablet_wifi", "tablet: switch its wifi on"), {"what": "wifi"}
    ),
)


def offered_calls(state: ConsoleState) -> Iterator[tuple[str, OfferedCall]]:
    """Driver and order, of the drivers that tell of a whole robot and offer the verb."""
    for driver in state.robot_outlines:
        for order in OFFERED_CALLS:
            if order.verb in state.verbs.get(driver, ()):
                yield driver, order


#: Cells for a key and for a name at the most.
KEY, LABEL = 7, 38


@dataclass(frozen=True, slots=True)
class SearchItem:
    """Something that can be found: what it is called, where it belongs, what it does, what it says.

    `acts`: it is an action of the experiment, and no command of the console. `asks`: what enter
    asks before it is done; empty: it is done at once.
    """

    name: str
    key: str
    where: str
    do: Callable[[], None]
    search: str
    utterance: str = ""
    acts: bool = False
    asks: str = ""


def _rank(matcher: Matcher, typed: str, find: SearchItem) -> tuple[int, float]:
    """How well it fits what is typed; 0: not at all.

    Labels come before what is said, whole pieces before letters in their order, and of two labels
    speech before gaze and gesture. What is no action of the experiment is found by beginnings of
    its words alone: enter must carry out no command that merely has these letters somewhere.
    """
    whole = typed.casefold()
    pieces = whole.split()
    if not find.acts:
        texts = ((4, find.name), (3, find.utterance), (0, find.search))
        rank = next((rank for rank, text in texts if _begins_words(text, pieces)), None)
        if whole in find.search.casefold().split("; "):
            rank = 7
        return (0, 0.0) if rank is None else (rank, 1.0 + (whole in find.name.casefold()))
    letters = matcher.match(find.name)
    if whole in find.name.casefold():
        exact = whole == find.name.casefold()
        return (8 if exact else 6 if find.utterance else 5), letters
    if find.utterance and all(piece in find.utterance.casefold() for piece in pieces):
        return 3, letters
    if letters:
        return (2 if find.utterance else 1), letters
    return 0, float(all(piece in find.search.casefold() for piece in pieces))


def _search(*texts: str) -> str:
    """What is searched, in the language of the screen, and in English, which manuals have."""
    return "; ".join(dict.fromkeys((*map(word, texts), *map(str, texts))))


def _begins_words(text: str, pieces: list[str]) -> bool:
    """Whether each piece is where a word of the text begins."""
    words = re.split(r"[\s\W_]+", text.casefold())
    joined = text.casefold().split()
    return all(any(word.startswith(piece) for word in (*words, *joined)) for piece in pieces)


class FindDialog(SearchDialog[SearchItem]):
    """Type, choose with the arrows, enter plays."""

    heading = Sentence("find.heading", "Find")
    hint = Sentence("find.hint", "enter plays it · arrows choose · ctrl+q closes")
    placeholder = Sentence("find.letters", "a few letters of an action, its words or its panel")
    nothing = Sentence("find.nothing", "Nothing found: other letters, or ctrl+q")

    @cached_property
    def _all(self) -> list[SearchItem]:
        """All there is, in the file's order."""
        return [*self._actions(), *self._beside_actions(), *self._commands()]

    @cached_property
    def _label(self) -> int:
        """Cells for names of actions: what is said gets the rest."""
        longest = max((cell_len(find.name) for find in self._all if find.acts), default=LABEL)
        return max(LABEL // 2, min(LABEL, longest))

    def _actions(self) -> Iterable[SearchItem]:
        """Those first that are likely to follow the last act, then those of the present phase."""
        then, front = self.state.then, {panel.title for panel in self.state.front}
        actions = [(each, panel) for panel in self.state.panels for each in panel.actions]
        actions.sort(key=lambda pair: pair[1].title not in front)
        actions.sort(key=lambda pair: (pair[0].name not in then, *map(pair[0].name.__ne__, then)))
        for action, panel in actions:
            cap = self.console_app.caps.get(action.name, KeyCap(action.key))
            said = quoted(self.state, action.name, self.glyphs)
            title = self.state.title(panel)
            where = title if not action.help else f"{title}: {action.help}"
            request = AskAction(action=action.name, source="palette")
            do: Callable[[], None] = functools.partial(self.requests.ask, request)
            if action.name in asked_words(self.state):
                do = functools.partial(self.console_app.ask_words, action.name, "")
            yield SearchItem(
                action.label,
                caption(cap, self.glyphs),
                f"{said}  {where}".lstrip(),
                do,
                " ".join((action.label, action.help, title)),
                said,
                acts=True,
            )

    def _beside_actions(self) -> Iterable[SearchItem]:
        """What features find; locks of panels; what the hand may do to the engagement model, in a
        session that has one; what a robot can do that needs no button.
        """
        ask = self.requests.ask
        for feature, each in pieces("console", FeatureConsole).items():
            finds = each.finds
            for found in answers_of(feature, finds, self.state) if finds is not None else ():
                do = functools.partial(ask, found.request)
                name = word(found.name)
                yield SearchItem(name, "", word(found.what), do, _search(found.name))
        for panel in self.state.panels:
            locked = self.state.is_locked(panel)
            title = self.state.title(panel)
            name = Sentence("find.lock", "Lock {panel}", panel=title)
            asks = say("find.asks_lock", "Lock {panel}? Its keys then play nothing.", panel=title)
            if locked:
                name, asks = Sentence("find.unlock", "Unlock {panel}", panel=title), ""
            do = functools.partial(ask, AskLock(panel=panel.title, locked=not locked))
            what = say("find.panel", "panel")
            yield SearchItem(word(name), "", what, do, _search(name), asks=asks)
        if is_offered(self.state.engaged, self.state.verbs):
            for order in OVERRIDES:
                steers = functools.partial(steer, self.console_app, order)
                name, what = word(order.text), say("find.engagement", "engagement")
                asks = f"{name}?" if order.id == "off" else ""
                yield SearchItem(name, "", what, steers, _search(order.text), asks=asks)
        key = self.console_app.key_of("find")
        for driver, call in offered_calls(self.state):
            args = dict(call.args)
            request = AskVerb(verb=call.verb, args=args, on=driver, source="key", key=key)
            name = word(call.text)
            asks = f"{name}?" if call.args.get("on") is False else ""
            do = functools.partial(ask, request)
            yield SearchItem(name, "", driver, do, f"{_search(call.text)} {call.verb}", asks=asks)

    def _commands(self) -> Iterable[SearchItem]:
        app, console = self.console_app, say("find.console", "console")
        for name, command in app.commands.items():
            bound = name in app.keymap.builtins or not command.keys[0].chord
            serves = bound and command.found and command.serves(self.state.role)
            if name == command.name and serves:
                key, words = key_name(app.key_of(name), self.glyphs), command.words
                said = quoted(self.state, played_by(name), self.glyphs)
                do = functools.partial(app.do, name)
                search = _search(command.keys[0].description, *command.also)
                yield SearchItem(words, key, said or console, do, search, said)

    def matching(self, typed: str) -> list[SearchItem]:
        """The best first, in the file's order where they are as good."""
        if not typed:
            return self._all
        matcher = Matcher(typed)
        ranked = [(_rank(matcher, typed, find), find) for find in self._all]
        hits = sorted(ranked, key=lambda hit: hit[0], reverse=True)
        return [find for rank, find in hits if any(rank)]

    def line(self, item: SearchItem) -> Content:
        """On one line; where a help is cut off, the list of keys has it whole."""
        ellipsis = self.glyphs.ellipsis
        where = clean(item.where)
        label = self._label if item.acts else LABEL
        # Inside the frame, as wide as the theme says, and beside a scrollbar.
        width = min(self.app.size.width * 9 // 10, 100) - 6
        room = max(1, width - KEY - label - 2)
        return Content.assemble(
            fit(item.key, KEY, ellipsis),
            fit(item.name, label, ellipsis),
            "  ",
            (fit(where, min(room, cell_len(where)), ellipsis), "$woz-muted"),
        )

    def chose(self, item: SearchItem | None, typed: str) -> None:
        """Play it, or ask first."""
        if item is not None and item.asks:
            self.console_app.open_dialog(ConfirmDialog(item.asks, item.name, item.do))
        elif item is not None:
            item.do()
