"""Is everything ready for the first participant?"""

from __future__ import annotations

import asyncio
import contextlib
import os
from collections import Counter
from collections.abc import Iterable, Mapping
from typing import ClassVar

import msgspec
from textual import events
from textual.binding import Binding, BindingType
from textual.content import Content
from textual.widget import Widget
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from woz_tui.config.keys.terminals import Terminal
from woz_tui.config.screen_language import say, word, worded_data
from woz_tui.console.drawing.cells import Row, clean
from woz_tui.console.drawing.key_caps import KeyCap, key_name
from woz_tui.console.screens.dialog import ReportDialog, plain, refusal_text
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.state.engagement_text import has_no_sensor, sign_name, signs_of
from woz_tui.console.state.remedy_text import remedy_text
from woz_tui.console.widgets.status_rows import SLOW_LINE_US
from woz_tui.drivers.contract import Finding
from woz_tui.machine.terminal_check import environment, multiplexers
from woz_tui.protocol.requests import AskCheck, AskPreflight, Reply
from woz_tui.protocol.sentence import Sentence

_LOOKS = {"ok": "good", "info": "muted", "warning": "warn", "error": "bad"}
#: The hint where the file has a list of its own.
TICKING = Sentence(
    "preflight.ticking", "space ticks · c checks again · tab: findings · ctrl+q closes"
)
#: What is to be mended stands on top.
_ORDER = {"error": 0, "warning": 1, "info": 2, "ok": 3}
_SIGNS = {"ok": "done", "info": "info", "warning": "warning", "error": "error"}


def _findings(data: object) -> list[Finding]:
    """Those of a reply; anything else in it is left out."""
    found = []
    for item in data if isinstance(data, list) else ():
        with contextlib.suppress(msgspec.ValidationError):
            found.append(msgspec.convert(worded_data(item), Finding))
    return found


def key_findings(state: ConsoleState, caps: Mapping[str, KeyCap]) -> list[Finding]:
    """What the console itself knows: keys of the file that this terminal cannot send."""
    findings = []
    for panel in state.panels:
        for action in panel.actions:
            cap = caps.get(action.name)
            if cap is not None and cap.why:
                level = "info" if cap.reserve else "warning"
                subject = say("preflight.key", "key {key}", key=action.key)
                whose = say("preflight.for_action", "for {label}", label=action.label)
                findings.append(Finding(level, subject, word(cap.why), whose))
    all_sent = say("preflight.keys_sent", "all keys of the file can be sent")
    return findings or [Finding("ok", say("preflight.keys", "keys"), all_sent)]


def sign_findings(state: ConsoleState) -> list[Finding]:
    """Signs of the engagement model that nobody has given so far."""
    shown = state.session.model.shown
    if shown is None:
        return []
    wanted = [name for name in signs_of(shown) if name in shown.uses]
    missing = [name for name in wanted if has_no_sensor(shown.signs[name])]
    subject = say("preflight.engagement", "engagement")
    if not missing:  # `presence, gaze are sensed, distance is given by hand`
        by_hand = [name for name in wanted if shown.signs[name].forced]
        sensed = [name for name in wanted if name not in by_hand]
        told = []
        if sensed:
            told.append(
                say(
                    "preflight.sensed",
                    "{names} are sensed",
                    one="{names} is sensed",
                    names=", ".join(map(sign_name, sensed)),
                    count=len(sensed),
                )
            )
        if by_hand:
            told.append(
                say(
                    "preflight.by_hand",
                    "{names} are given by hand",
                    one="{names} is given by hand",
                    names=", ".join(map(sign_name, by_hand)),
                    count=len(by_hand),
                )
            )
        return [Finding("ok", subject, ", ".join(told))]
    remedy = say("preflight.give_sign", "give it by hand, or wait")
    return [
        Finding(
            *("warning", subject),
            say("preflight.no_sensor", "no sensor gives {sign} yet", sign=sign_name(name)),
            remedy,
        )
        for name in missing
    ]


def line_finding(round_trip_us: int | None) -> Finding:
    """How long a key is on its way from the wizard's terminal, and back."""
    subject = say("preflight.connection", "connection")
    if round_trip_us is None:
        text = say(
            "preflight.no_delay",
            "the terminal has not answered yet; the delay of keys is not known",
        )
        return Finding("info", subject, text, say("preflight.again", "check again"))
    text = say("preflight.delay", "{ms:.0f} ms there and back", ms=round_trip_us / 1000)
    if round_trip_us < SLOW_LINE_US:
        return Finding("ok", subject, text)
    remedy = say("preflight.nearer", "use a cable or a nearer access point")
    return Finding("warning", subject, text, remedy)


def kind_finding(terminal: Terminal, help_key: str) -> Finding:
    """Which keys the terminal can tell apart. `help_key` opens the list of keys."""
    subject = say("preflight.keyboard", "keyboard")
    if terminal.kitty:
        text = say("preflight.kitty", "tells all keys apart (kitty keyboard protocol)")
        return Finding("ok", subject, text)
    text = say("preflight.few_keys", "This terminal cannot send some key combinations")
    if help_key:
        text = say(
            "preflight.few_keys_help",
            "This terminal cannot send some key combinations; {key} shows what to press instead",
            key=help_key,
        )
    return Finding("info", subject, text)


def terminal_findings(environ: Mapping[str, str]) -> list[Finding]:
    """What stands between the wizard's keys and the console. May ask tmux; not for the loop."""
    return [*environment(environ), *multiplexers(environ)]


class PreflightDialog(ReportDialog):
    """The robot side's checks and the console's own; enter runs them again.

    Above them is what the experiment file leaves to a human, each with a sign: to be ticked.
    """

    heading = Sentence("preflight.heading", "Preflight")
    hint = Sentence("preflight.hint", "enter checks again · arrows scroll · ctrl+q closes")
    size_class = "wide"
    indent = 17  # under the text, behind sign and subject
    BINDINGS: ClassVar[list[BindingType]] = [Binding("enter", "check", priority=True)]

    def __init__(self) -> None:
        super().__init__()
        self._findings: list[Finding] = []
        self._status = ""
        self._reply: Reply | None = None
        self._terminal: list[Finding] | None = None
        self._shown: dict[str, bool] = {}

    def body(self) -> Iterable[Widget]:
        """The human's list, then the findings."""
        self._shown = dict(self.state.study.checks)
        if self._shown:
            yield Static(plain(say("preflight.yours", "You check these")), classes="caption")
            yield OptionList(*map(self._check, self._shown), id="checks")
        yield from super().body()

    def _check(self, check: str) -> Option:
        ticked = self._shown[check]
        sign, look = (self.glyphs.done, "$woz-good") if ticked else (self.glyphs.no, "$woz-warn")
        return Option(Content.assemble((f"{sign} ", look), clean(check)))

    def on_mount(self) -> None:
        self._look_again()
        if self._shown:
            self.show_hint(TICKING)

    def on_key(self, event: events.Key) -> None:
        """Space ticks as enter does; tab and a letter check again."""
        if event.key == "space" and self._tick():
            event.stop()
        elif event.character == "c":
            event.stop()
            self._look_again()

    def action_check(self) -> None:
        """Tick what is chosen in the list; without a list, check again."""
        if not self._tick():
            self._look_again()

    def _tick(self) -> bool:
        """Whether the list has the keyboard; then its chosen line is ticked, or not any more."""
        for choices in self.query("#checks").results(OptionList):
            if choices.has_focus and choices.highlighted is not None:
                check = list(self._shown)[choices.highlighted]
                request = AskCheck(check=check, ok=not self.state.study.checks.get(check, False))
                self.requests.ask(request, self._ticked)
                return True
        return False

    def _ticked(self, reply: Reply) -> None:
        if not reply.ok:
            self._status = refusal_text(reply)
            self.renew()

    def refreshed(self) -> None:
        """Show ticks as they come, also those of another console."""
        known = self.state.study.checks
        if known == self._shown:
            return
        changed = [check for check in self._shown if known.get(check) != self._shown[check]]
        self._shown = {check: known.get(check, False) for check in self._shown}
        for choices in self.query("#checks").results(OptionList):
            for check in changed:
                index = list(self._shown).index(check)
                choices.replace_option_prompt_at_index(index, self._check(check).prompt)
        self._judge()
        self.renew()

    def _look_again(self) -> None:
        """Ask the robot process, and look at the terminal meanwhile."""
        checking = say("preflight.checking", "checking")
        self._findings, self._status = [], f"{checking} {self.glyphs.ellipsis}"
        self._reply = self._terminal = None
        self.renew()
        self.requests.ask(AskPreflight(), self._answered)
        self.run_worker(self._check_terminal(), exclusive=True)

    async def _check_terminal(self) -> None:
        self._terminal = await asyncio.to_thread(terminal_findings, os.environ)
        self._conclude()

    def _answered(self, reply: Reply) -> None:
        self._reply = reply
        self._conclude()

    def _conclude(self) -> None:
        """Show everything at once, when both have answered."""
        reply, terminal = self._reply, self._terminal
        if reply is None or terminal is None:
            return
        app = self.console_app
        self._findings = [
            *_findings(reply.data),
            *terminal,
            *([] if self.state.line else [line_finding(app.feed.round_trip_us)]),
            kind_finding(app.terminal, key_name(app.key_of("help"), self.glyphs)),
            *sign_findings(self.state),
            *key_findings(self.state, app.caps),
        ]
        self._findings.sort(key=lambda found: _ORDER.get(found.level, len(_ORDER)))
        self._judge()
        self.renew()

    def _judge(self) -> None:
        """The verdict in words."""
        reply = self._reply
        if reply is None or self._terminal is None:
            return
        levels = Counter(found.level for found in self._findings)
        unticked = len(self.state.study.unticked())
        if not reply.ok:
            self._status = refusal_text(reply)
        elif levels["error"] or levels["warning"] or unticked:
            told = []
            if count := levels["error"]:
                told.append(say("preflight.errors", "{count} errors", one="1 error", count=count))
            if count := levels["warning"]:
                told.append(
                    say("preflight.warnings", "{count} warnings", one="1 warning", count=count)
                )
            if unticked:
                told.append(
                    say(
                        "preflight.unticked",
                        "{count} of your own checks not ticked",
                        one="1 of your own checks not ticked",
                        count=unticked,
                    )
                )
            self._status = ", ".join(told)
        else:
            self._status = say("preflight.ready", "everything is ready")

    def lines(self) -> list[Row]:
        """The verdict, then every finding."""
        rows: list[Row] = [((self._status, "strong"),), ()]
        for found in self._findings:
            sign = str(getattr(self.glyphs, _SIGNS.get(found.level, "info")))
            look = _LOOKS.get(found.level, "plain")
            subject = f"{sign} {word(found.subject):<14} "
            rows.append(((subject, look), (word(found.text), "plain")))
            if found.remedy and found.level != "ok":
                remedy = remedy_text(word(found.remedy), self.state)
                rows.append(((" " * self.indent, "plain"), (remedy, "run")))
        return rows
