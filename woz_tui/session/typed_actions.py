"""Makes buttons of sentences that the wizard has typed, and writes them into a copy of the file."""

from __future__ import annotations

import os
import string
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from woz_tui.config.experiment import Action, Call, Experiment, Panel, ParallelCalls
from woz_tui.config.file_additions import (
    AppendError,
    append_actions,
    copy_names,
    quoted,
    write_copy,
)
from woz_tui.config.file_position import NOWHERE, ExperimentError
from woz_tui.config.reload_changes import compare
from woz_tui.protocol.markup import sentence
from woz_tui.protocol.panels import TYPED, TYPED_NAME
from woz_tui.protocol.refusal import RequestError
from woz_tui.protocol.sentence import Sentence

#: So many are kept; the first make way.
MOST = 40
#: Letters of a sentence on its button and in its name.
LABEL = 40
_KEYS = (*string.digits[1:], "0", *string.ascii_lowercase, *string.ascii_uppercase)


#: Reads a text as if the experiment file held it; raises `ExperimentError`.
Reader = Callable[[bytes], Experiment]


def with_typed(experiment: Experiment, typed: Sequence[Action]) -> Experiment:
    """The experiment with these buttons instead of those it may have: on its own panel of this
    title, or on one behind all others.
    """
    panels = without_typed(experiment).panels
    own = next((panel for panel in panels if panel.title == TYPED), None)
    if typed and own is not None:
        more = replace(own, actions=(*own.actions, *typed))
        panels = tuple(more if panel is own else panel for panel in panels)
    elif typed:
        panels = (*panels, Panel(TYPED, tuple(typed), NOWHERE))
    return replace(experiment, panels=panels)


def without_typed(experiment: Experiment) -> Experiment:
    """The experiment as its file has it."""
    panels = tuple(
        replace(panel, actions=tuple(one for one in panel.actions if one.place is not NOWHERE))
        if panel.title == TYPED
        else panel
        for panel in experiment.panels
        if panel.place is not NOWHERE
    )
    return replace(experiment, panels=panels)


def with_sentence(
    experiment: Experiment, typed: tuple[Action, ...], text: str, driver: str, key: str = ""
) -> tuple[Action, ...]:
    """`typed` with a button for this sentence of `driver`, on `key` if that is free; as it is, if
    there is one, or one on the file's own panel of this title.
    """
    own = [each for panel in experiment.panels if panel.title == TYPED for each in panel.actions]
    if any(_says(action, text, driver) for action in (*own, *typed)):
        return typed
    used = {action.name for panel in experiment.panels for action in panel.actions}
    words = sentence(text).strip() or text
    label = words if len(words) <= LABEL else f"{words[: LABEL - 3].rstrip()}..."
    name, number = f"{TYPED_NAME}{label}", 2
    while name in used:
        name, number = f"{TYPED_NAME}{label} ({number})", number + 1
    call = Call("say", {"text": text}, driver)
    key = _free_key(experiment, key)
    action = Action(name, label, key, TYPED, (ParallelCalls((call,)),), NOWHERE, help="typed")
    return (*typed, action)[-MOST:]


def _says(action: Action, text: str, driver: str) -> bool:
    return [(call.verb, call.driver, call.args) for call in action.calls] == [
        ("say", driver, {"text": text})
    ]


# -- into a copy of the file ----------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class ExperimentCopy:
    """A copy of the experiment file with the panel *Typed*: what comes in, and all its bytes.

    No sentences: the file has them all.
    """

    file: Path
    sentences: int
    diff: tuple[str, ...] = ()
    data: bytes = b""


def copy_with_sentences(path: Path, typed: Sequence[Action], read: Reader) -> ExperimentCopy:
    """The copy of the file at `path`, checked as `woz check` does. Reads files, writes none.

    Raises:
        ExperimentError: The file as it is now has errors.
        RequestError: It cannot be read, or the sentences have no place in it.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise RequestError(
            Sentence(
                "session.unreadable",
                "{path} cannot be read: {strerror}",
                path=path,
                strerror=error.strerror,
            )
        ) from error
    base = read(data)
    actions = _for_file(base, typed)
    if not actions:
        return ExperimentCopy(path, 0)
    copy = next((name for name in copy_names(path) if not os.path.lexists(name)), path)
    try:
        result = append_actions(data, TYPED, [_line_of_file(base, action) for action in actions])
    except AppendError as error:
        raise RequestError(str(error)) from error
    _check_copy(base, actions, result.data, read)
    return ExperimentCopy(copy, len(actions), tuple(result.diff(path.name, copy.name)), result.data)


def write_beside(path: Path, copy: ExperimentCopy) -> ExperimentCopy:
    """Write it beside the file at `path`; nothing that exists is touched. Raises `RequestError`."""
    try:
        return replace(copy, file=write_copy(path, copy.data))
    except OSError as error:
        why = Sentence(
            "session.no_copy",
            "no copy could be written to {folder}: {problem}",
            folder=path.parent,
            problem=error.strerror or error,
        )
        raise RequestError(why) from error


def _for_file(base: Experiment, typed: Sequence[Action]) -> tuple[Action, ...]:
    """The sentences that the file does not have, as its own actions."""
    found: tuple[Action, ...] = ()
    for action in typed:
        (call,) = action.calls
        text = str(call.args["text"])
        found = with_sentence(with_typed(base, found), found, text, call.driver, action.key)
    used = {action.name for panel in base.panels for action in panel.actions}
    plain = []
    for action in found:
        name = action.name if action.label in used else action.label
        used.add(name)
        plain.append(replace(action, name=name, help=""))
    return tuple(plain)


def _line_of_file(base: Experiment, action: Action) -> str:
    """`{key: "1", label: "One moment", say: "One moment, please."}`."""
    (call,) = action.calls
    speakers = [
        spec.name
        for spec in base.drivers
        if any(verb.name == call.verb for verb in spec.offer.verbs)
    ]
    parts = {
        "key": action.key,
        "label": action.label,
        "name": action.name if action.name != action.label else "",
        "on": call.driver if len(speakers) > 1 else "",
        "say": str(call.args["text"]),
    }
    fields = (f"{name}: {quoted(text)}" for name, text in parts.items() if text)
    return f"{{{', '.join(fields)}}}"


def _check_copy(base: Experiment, actions: Sequence[Action], data: bytes, read: Reader) -> None:
    """Raises `RequestError` unless the new file is right and says what the old one says."""
    try:
        new = read(data)
    except ExperimentError as error:
        # Its words may quote what a wizard who is blind to the condition must not read.
        line = error.problems[0].place.line
        raise RequestError(
            Sentence(
                "session.typed_error",
                "with these sentences the file would have an error in line {line}",
                line=line,
            )
        ) from error
    if compare(with_typed(base, actions), new).changes:
        raise RequestError(
            Sentence(
                "session.no_place", "this file has no place where sentences can be added safely"
            )
        )


def _free_key(experiment: Experiment, wanted: str) -> str:
    """A key that no action has or begins with, `wanted` if it is one; empty: all are taken."""
    taken = {
        action.key.split(" ")[0]
        for panel in experiment.panels
        for action in panel.actions
        if action.key
    }
    return next((key for key in (wanted, *_KEYS) if key and key not in taken), "")
