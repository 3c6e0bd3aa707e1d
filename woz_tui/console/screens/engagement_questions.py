"""What the hand on the engagement model asks before it acts: which state, who it is."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import partial

from textual.widget import Widget
from textual.widgets import Input, Static

from woz_tui.config.screen_language import say
from woz_tui.console.drawing.cells import Row, clean, fit
from woz_tui.console.screens.choice import ChoiceDialog, ListChoice
from woz_tui.console.screens.dialog import (
    ConsoleApp,
    Dialog,
    EntryDialog,
    FormDialog,
    content,
    plain,
)
from woz_tui.console.state.engagement import EngagementView
from woz_tui.console.state.engagement_text import short_state
from woz_tui.console.state.wizard_overrides import (
    Override,
    forceable,
    is_offered,
    needs_name,
    override_request,
    verb_request,
)
from woz_tui.protocol.sentence import Sentence

#: Cells of a state in the list.
_STATE = 18
#: Visitors that are listed at the most.
_KNOWN = 6


def dialog_for(order: Override, engaged: EngagementView, key: str = "") -> Dialog | None:
    """The dialog that `order` needs as things stand, or None."""
    if order.id == "force":
        return ForceDialog(key)
    if order.id == "identity":
        return IdentityDialog(key)
    if order.id == "visitor" or (order.id == "greeted" and needs_name(engaged)):
        return VisitorDialog(key)
    return None


def steer(app: ConsoleApp, order: Override, key: str = "") -> None:
    """The wizard's hand on the engagement model; some orders ask for more first."""
    engaged = app.state.engaged
    if not is_offered(engaged, app.state.verbs):
        app.news(say("hand.no_model", "This session has no engagement model"))
        return
    dialog = dialog_for(order, engaged, key)
    if dialog is not None:
        app.open_dialog(dialog)
    else:
        app.requests.ask(override_request(order, engaged, key))


class _OverrideDialog(Dialog):
    """Belongs to the key that opened it, which the log names."""

    def __init__(self, key: str = "") -> None:
        super().__init__()
        self._key = key


class ForceDialog(_OverrideDialog, ChoiceDialog):
    """States and outcomes; the log says that it was the wizard."""

    heading = Sentence("hand.force", "Force")
    hint = Sentence("hand.force_hint", "arrows choose · enter forces it · ctrl+q closes")

    def lines(self) -> list[Row]:
        """Where it begins."""
        shown = self.state.session.model.shown
        here = say("hand.unknown", "not known")
        if shown is not None:
            here = short_state(shown.state)
        begins, marked = (
            say("hand.from", "from"),
            say("hand.marked", "; the log marks it as forced"),
        )
        return [((f"{begins} ", "muted"), (here, "strong"), (marked, "muted"))]

    def choices(self) -> Sequence[ListChoice]:
        """Where an outcome leads from here first, then every other state; the outcome as it is in
        the log.
        """
        shown = self.state.session.model.shown
        self._from = shown.state if shown is not None else ""
        return [
            ListChoice(content([self._row(to, state)]), partial(self._force, to, state))
            for to, state in forceable(shown)
        ]

    def _row(self, to: str, state: str) -> Row:
        words = fit(short_state(state or to), _STATE, self.glyphs.ellipsis)
        return ((words, "plain"), (to if state else "", "muted"))

    def _force(self, to: str, state: str) -> None:
        """By its outcome; by its state if the model has moved on meanwhile."""
        shown = self.state.session.model.shown
        moved = shown is not None and shown.state != self._from
        self.requests.ask(
            verb_request("force", {"to": state if state and moved else to}, self._key)
        )


class IdentityDialog(_OverrideDialog, EntryDialog):
    """Who it is, in place of a camera; an empty line means nobody who is known."""

    heading = Sentence("hand.who", "Who is it?")
    hint = Sentence("hand.who_hint", "enter says so · empty: unknown · ctrl+q closes")
    placeholder = Sentence("hand.code", "code of the visitor (never a name)")
    default = "Unknown"

    def below(self) -> Iterable[Widget]:
        """Those of whom this session knows."""
        known = list(self.state.engaged.visitors)[-_KNOWN:]
        if known:
            told = ", ".join(clean(name) for name in reversed(known))
            known_ones = say("hand.known", "known: {names}", names=told)
            yield Static(content([((known_ones, "muted"),)]), classes="caption")

    def submit(self, text: str) -> None:
        self.requests.ask(verb_request("sense", {"sign": "identity", "value": text}, self._key))


class VisitorDialog(_OverrideDialog, FormDialog):
    """Who stands there, from now on in the store; during a handshake that ends it well."""

    heading = Sentence("hand.visitor", "Visitor")
    hint = Sentence("hand.visitor_hint", "tab next field · enter accepts · ctrl+q closes")

    def body(self) -> Iterable[Widget]:
        """Code, and what the robot may want to know of them."""
        shown = self.state.session.model.shown
        name = shown.visitor if shown is not None else ""
        about = self.state.engaged.visitors.get(name, {})
        code = say("hand.visitor_code", "Code of the visitor (never a name)")
        yield Static(plain(code), classes="caption")
        yield Input(clean(name), id="code")
        age = say("hand.age_group", "Age group, such as child or adult (may stay empty)")
        yield Static(plain(age), classes="caption")
        yield Input(clean(about.get("age_group", "")), id="age_group")
        address = say("hand.address", "Form of address (may stay empty)")
        yield Static(plain(address), classes="caption")
        yield Input(clean(about.get("address", "")), id="address")
        yield Static("", id="wrong", classes="wrong")

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Accept everything at once; stay open until it is accepted."""
        event.stop()
        told = {
            field: self.query_one(f"#{field}", Input).value.strip()
            for field in ("code", "age_group", "address")
        }
        if not told["code"]:
            self.complain(say("hand.no_code", "A visitor needs a code."))
            return
        args = {name: value for name, value in told.items() if value}
        self.requests.ask(verb_request("visitor", {**args}, self._key), self.answered)
