"""What the wizard can do beside playing actions: a row for each command of the console.

Their keys stand in `config/keys/builtin_keys.json`, because experiments may not take them. Help,
palette, lowest line and keyboard read these rows; `replay/commands.py` has those of a
replay.

Dialogs are imported when they are first opened: the first painting does not wait for them.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from pkgutil import resolve_name
from typing import Any

from woz_tui.config.keys.console_keys import BuiltinKey, builtin_key, played_by
from woz_tui.config.screen_language import say, word
from woz_tui.console.drawing.theme import CHOICES, save_theme
from woz_tui.console.input.keyboard import KeyPress
from woz_tui.console.screens.dialog import (
    EVERYBODY,
    WATCHER,
    WIZARD,
    ConsoleApp,
    ConsoleCommand,
)
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.widgets.feature_console import FeatureCommand, FeatureConsole, KeyHint
from woz_tui.feature import answer_of, pieces
from woz_tui.protocol.requests import (
    AskAction,
    AskCancel,
    AskEmptyQueue,
    AskMarker,
    AskMistake,
    AskTakeOver,
    AskVerb,
)
from woz_tui.protocol.sentence import Sentence

Run = Callable[[ConsoleApp], object]


def open_named(app: ConsoleApp, dialog: str) -> None:
    """Open the dialog `package.module:Class`."""
    app.open_dialog(resolve_name(dialog)())


def opens(dialog: str) -> Run:
    """Open the dialog `module:Class` of this package."""
    return partial(open_named, dialog=f"{__package__}.{dialog}")


def calls(function: str) -> Run:
    """Call the function `module:name` of this package with the app."""
    return partial(_call, f"{__package__}.{function}")


def _call(function: str, app: ConsoleApp) -> None:
    resolve_name(function)(app)


def by_key(commands: Iterable[ConsoleCommand]) -> dict[str, ConsoleCommand]:
    """Commands by the ids of all their keys."""
    return {key.id: command for command in commands for key in command.keys}


def hints(state: ConsoleState, commands: Mapping[str, ConsoleCommand]) -> list[tuple[str, str]]:
    """Keys worth naming in this session: id and word, the most important first."""
    named = sorted(
        (command.hint.rank, name, word(command.hint.word))
        for name, command in commands.items()
        if name == command.name and command.hint is not None
        if command.hint.worth(state) and command.serves(state.role)
    )
    return [(name, text) for _, name, text in named]


def _row(ids: str, run: Run | None = None, **more: Any) -> ConsoleCommand:
    keys = tuple(key for name in ids.split() if (key := builtin_key(name)) is not None)
    return ConsoleCommand(keys, run, **more)


def _has_robot(state: ConsoleState) -> bool:
    return bool(state.robot_outlines)


def _arrow(name: str, verb: str, argument: str, way: int, step: str) -> ConsoleCommand:
    """An arrow key. Left, down and forward are positive."""

    def ask(press: KeyPress) -> AskVerb:
        return AskVerb(
            verb=verb,
            args={argument: way * float(getattr(press.steps, step))},
            source="key",
            on=press.on,
            # A key held down moves on smoothly and leaves no steps behind when let go.
            when_busy="replace",
            **press.fields,
        )

    return _row(name, sends=ask, verb=verb, found=False)


def _cut(app: ConsoleApp) -> None:
    """Cut the last run short."""
    active = app.state.runs.active
    if active:
        app.requests.ask(AskCancel(run=next(reversed(active))))
    else:
        app.news(say("app.nothing_runs", "No action is running"))


def _suspend(app: ConsoleApp) -> None:
    if app.keyboard.on_suspend is not None:
        app.keyboard.on_suspend()


def _next_colours(app: ConsoleApp) -> None:
    """The theme behind this one."""
    at = CHOICES.index(app.theme.removeprefix("woz-"))
    _use_colours(app, CHOICES[(at + 1) % len(CHOICES)])


#: What the themes are called, where one was chosen.
_COLOURS = {
    "dark": Sentence("app.dark", "Dark"),
    "light": Sentence("app.light", "Light"),
    "16": Sentence("app.sixteen", "16"),
}


def _use_colours(app: ConsoleApp, choice: str) -> None:
    app.theme = f"woz-{choice}"
    save_theme(choice, os.environ)
    app.news(
        say(
            "app.colours",
            "{choice} colours, saved as default (--theme auto resets)",
            choice=word(_COLOURS[choice]),
        )
    )


def _colours(name: str, choice: str, words: str) -> ConsoleCommand:
    def run(app: ConsoleApp) -> None:
        _use_colours(app, choice)

    return ConsoleCommand((BuiltinKey(name, "", words),), run, users=WATCHER)


_COMMANDS = (
    _row(
        "stop stop_too",
        lambda app: app.keyboard.stop("palette"),
        hint=KeyHint(1, Sentence("hint.stop", "stop")),
        also=(Sentence("find.word_stop", "stop"),),
        users=WATCHER,
    ),
    _row("release", calls("screens.release:open_release"), found=False),
    _row("say", opens("screens.say:SayDialog"), hint=KeyHint(3, Sentence("hint.say", "say"))),
    _row(
        "find find_too",
        opens("screens.find:FindDialog"),
        found=False,
        hint=KeyHint(4, Sentence("hint.find", "find")),
        users=WATCHER,
    ),
    _row("peek", calls("screens.peek:open_peek"), found=False, users=WATCHER),
    _row(
        "marker",
        sends=lambda press: AskMarker(),
        hint=KeyHint(7, Sentence("hint.mark", "mark")),
        users=WATCHER,
    ),
    _row(
        "note",
        opens("screens.note:NoteDialog"),
        hint=KeyHint(8, Sentence("hint.note", "note")),
        users=WATCHER,
    ),
    _row(
        "mistake_last",
        sends=lambda press: AskMistake(),
        found=False,
        hint=KeyHint(9, Sentence("hint.mistake", "mistake")),
    ),
    _row("mistake", opens("screens.mistake:MistakeDialog")),
    _row(
        "cut",
        _cut,
        hint=KeyHint(0.5, Sentence("hint.cut", "cut"), lambda state: bool(state.runs.composed)),
    ),
    _row(
        "queue",
        opens("screens.queue:QueueDialog"),
        hint=KeyHint(0, Sentence("hint.queue", "queue"), lambda state: bool(state.runs.waiting)),
        users=WATCHER,
    ),
    _row("queue_empty", sends=lambda press: AskEmptyQueue()),
    _row(
        "take_over",
        sends=lambda press: AskTakeOver(),
        found=False,
        users=frozenset({"watcher"}),
    ),
    _row(
        "unrecorded",
        opens("screens.unrecorded:UnrecordedDialog"),
        hint=KeyHint(
            -1,
            Sentence("hint.unrecorded", "go on without a record"),
            lambda state: state.unrecorded,
        ),
    ),
    _row("failures", calls("screens.failures:open_failures"), once=True, users=EVERYBODY),
    _row("events", lambda app: app.filter_events(), opens=False, users=EVERYBODY),
    _row(
        "panel_next page_next",
        lambda app: app.walk(1),
        opens=False,
        hint=KeyHint(12, Sentence("hint.panel", "panel")),
        users=EVERYBODY,
    ),
    _row("panel_back page_back", lambda app: app.walk(-1), opens=False, users=EVERYBODY),
    _arrow("head_up", "nudge", "pitch", -1, "head"),
    _arrow("head_down", "nudge", "pitch", 1, "head"),
    _arrow("head_left", "nudge", "yaw", 1, "head"),
    _arrow("head_right", "nudge", "yaw", -1, "head"),
    _arrow("drive_forward", "drive", "x", 1, "drive"),
    _arrow("drive_back", "drive", "x", -1, "drive"),
    _arrow("drive_left", "drive", "turn", 1, "turn"),
    _arrow("drive_right", "drive", "turn", -1, "turn"),
    _arrow("hip_forward", "hip", "pitch", 1, "hip"),
    _arrow("hip_back", "hip", "pitch", -1, "hip"),
    _arrow("hip_left", "hip", "roll", 1, "hip"),
    _arrow("hip_right", "hip", "roll", -1, "hip"),
    _row("start", opens("screens.start:StartDialog")),
    _row("preflight", opens("screens.preflight:PreflightDialog"), users=WATCHER),
    _row("reload", opens("screens.reload:ReloadDialog")),
    _row("drivers", opens("screens.drivers:DriversDialog"), users=EVERYBODY),
    _row("body", opens("screens.body:BodyDialog"), users=EVERYBODY),
    _row("knobs", opens("screens.knobs:KnobsDialog"), users=EVERYBODY),
    _row("engagement", opens("screens.engagement:EngagementDialog"), users=WATCHER),
    _row(
        "robot",
        opens("screens.robot:RobotDialog"),
        hint=KeyHint(6, Sentence("hint.robot", "robot"), _has_robot),
        also=(
            Sentence("find.word_volume", "volume"),
            Sentence("find.word_speed", "speed"),
            Sentence("find.word_pitch", "pitch"),
            Sentence("find.word_voice", "voice"),
        ),
        users=EVERYBODY,
    ),
    _row(
        "move",
        calls("screens.move:open_move"),
        hint=KeyHint(10, Sentence("hint.gesture", "gesture"), _has_robot),
    ),
    _row(
        "camera",
        opens("screens.camera:CameraDialog"),
        hint=KeyHint(11, Sentence("hint.camera", "camera"), _has_robot),
        users=WATCHER,
    ),
    _row("redraw", lambda app: app.refresh(layout=True), opens=False, users=EVERYBODY),
    _row("theme", _next_colours, users=WATCHER),
    _row(
        "help",
        opens("screens.help:HelpDialog"),
        hint=KeyHint(5, Sentence("hint.keys", "keys")),
        also=(Sentence("find.word_help", "help"), Sentence("find.word_keys", "keys")),
        users=WATCHER,
    ),
    _row("suspend", _suspend, users=WATCHER),
    _row(
        "leave",
        calls("screens.lost:open_leave"),
        hint=KeyHint(13, Sentence("hint.leave", "leave")),
        also=(
            Sentence("find.word_end", "end"),
            Sentence("find.word_exit", "exit"),
            Sentence("find.word_leave", "leave"),
            Sentence("find.word_close", "close"),
        ),
        users=WATCHER,
    ),
    ConsoleCommand(
        (
            BuiltinKey(
                "keep_typed",
                "",
                Sentence(
                    "keys.keep_typed", "put the typed sentences into a copy of the experiment file"
                ),
            ),
        ),
        opens("screens.typed:KeepTypedDialog"),
    ),
    _colours("dark", "dark", Sentence("keys.dark", "dark colours")),
    _colours("light", "light", Sentence("keys.light", "light colours")),
    _colours("sixteen", "16", Sentence("keys.sixteen", "the terminal's own sixteen colours")),
)


def _of_feature(command: FeatureCommand) -> ConsoleCommand:
    action = played_by(command.key)

    def ask(press: KeyPress) -> AskAction:
        return AskAction(action=action, source="key", **press.fields)

    def run(app: ConsoleApp) -> None:
        if action:
            key = app.key_of(command.key)
            app.requests.ask(AskAction(action=action, source="key", key=key))
        open_named(app, command.opens)

    more: dict[str, Any] = {
        "hint": command.hint,
        "found": command.found,
        "also": command.also,
        "users": WATCHER if command.watchers else WIZARD,
    }
    if command.calls:
        return _row(command.key, partial(_call, command.calls), **more)
    if not command.opens:
        return _row(command.key, sends=command.sends or ask, once=command.once, **more)
    # What the screen carries out passes the keyboard twice, so it cannot count once there.
    return _row(command.key, run, **more)


def _with_features() -> Iterator[ConsoleCommand]:
    """Ours and theirs, of which features may carry out something else at times."""
    consoles = pieces("console", FeatureConsole)
    theirs = (_of_feature(each) for console in consoles.values() for each in console.commands)
    for command in (*_COMMANDS, *theirs):
        for name, console in consoles.items():
            if command.run is not None and command.name in console.instead:
                run = partial(_run_either, name, command.run, console.instead[command.name])
                command = replace(command, run=run)  # noqa: PLW2901 - several may take it
        yield command


def _run_either(
    feature: str, run: Run, instead: Callable[[ConsoleState], str | None], app: ConsoleApp
) -> None:
    dialog = answer_of(feature, None, instead, app.state)
    if dialog is None:
        run(app)
    elif dialog:
        open_named(app, dialog)


COMMANDS = tuple(_with_features())
