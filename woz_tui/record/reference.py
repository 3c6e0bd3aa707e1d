"""What every field of a log means, and the tables of it in docs/session-log.md.

    python -m woz_tui.record.reference docs/session-log.md

writes the tables anew; a test keeps them fresh.
"""

from __future__ import annotations

import inspect
import sys
from pathlib import Path
from typing import Any, get_args

import msgspec

from woz_tui.core.messages import AnyMessage, Message

BEGIN = "<!-- tables: begin (python -m woz_tui.record.reference docs/session-log.md) -->"
END = "<!-- tables: end -->"

#: Unit (empty: none) and meaning of every field, by name: one name means one thing everywhere.
FIELDS: dict[str, tuple[str, str]] = {
    "about": ("", "what is known of the visitor: `age_group`, `address`; absent: nothing"),
    "actions": ("", "name of each action -> its steps: see the line's description"),
    "action": ("", "name of the action in the experiment file"),
    "answered": ("", "how many items were answered"),
    "answered_us": ("µs", "from the item's being shown to its answer; absent: not measured"),
    "args": ("", "the verb's arguments as they were asked for"),
    "attempt": ("", "how often this handshake has asked for a name; absent: not once"),
    "attention": ("", "what draws the robot's attention elsewhere; absent: nothing"),
    "bad": ("", "fields of this line that were not finite numbers and have become null"),
    "began": ("µs", "moment, on the `t` axis, at which it began"),
    "blurred": ("", "what is shown, but not legibly"),
    "brightness": ("", "of the lights, 0 to 1; absent: 1"),
    "by": ("", "id of the command or the run that took its place"),
    "changes": ("", "what differs, one sentence each"),
    "check": ("", "the item of the preflight list, in words"),
    "clock": ("", "where `t` comes from, and the wall clock at `t` = 0"),
    "code": ("", "why, as a word: see the line's description"),
    "command": ("", "id of the command"),
    "commands": ("", "how many commands are to be sent again"),
    "condition": ("", "the participant's condition"),
    "conditions": ("", "all conditions of the experiment"),
    "confirmed": ("", "drivers that said in time that they stand still"),
    "conflicts": ("", "settings that work against each other, a sentence each"),
    "console": ("", "id of the connection it came over"),
    "copied": ("", "whether the file is a copy of all that was in a deleted one"),
    "cue": ("", "id of the cue; empty: there was none"),
    "cued": ("µs", "moment, on the `t` axis, of the cue"),
    "cues": ("", "which cues count: see the line's description"),
    "deadline_us": ("µs", "moment, on the `t` axis, after which it may not begin; absent: none"),
    "detail": ("", "what exactly"),
    "driver": ("", "name of the driver in the robot file"),
    "drivers": ("", "names of all drivers"),
    "dropped": ("lines", "lines lost so far, samples not counted"),
    "dropped_samples": ("lines", "samples lost so far"),
    "due": ("µs", "moment, on the `t` axis, at which it should have happened"),
    "duration_us": ("µs", "from the driver's start to its end"),
    "elapsed_us": ("µs", "from the stop to this line"),
    "emotion": ("", "what the face shows"),
    "ended": ("µs", "moment, on the `t` axis, at which it ended"),
    "engaged": ("", "whether the condition of engagement holds"),
    "expected_us": ("µs", "how much longer it will take, from this line on"),
    "expects": ("", "actions that answer the cue rightly"),
    "experiment": ("", "the experiment file"),
    "experiment_sha256": ("", "SHA-256 of the experiment file, hexadecimal"),
    "file": ("", "the recording, relative to the log's folder; absent: none was kept"),
    "files": ("", "name of each file -> its text"),
    "floor_us": ("µs", "from the cue to the robot's act, at least"),
    "forced": ("", "whether the wizard did it, or decided a verdict on which it rests"),
    "format": ("", "always `woz-session`"),
    "hidden": ("", "what is not shown at all"),
    "intensity": ("", "how much of it the face shows, 0 to 1"),
    "item": ("", "name of the questionnaire's item"),
    "items": ("", "the questionnaire's items: see the line's description"),
    "jitter_us": ("µs", "up to so much more, at random"),
    "judged": ("", "what the wizard made of the cue: see the line's description"),
    "key": ("", "the key that was pressed"),
    "keyboard": ("", "layout of the keyboard"),
    "lag_us": ("µs", "longest that a line had to wait for the disk since the last such report"),
    "lane": ("", "which of the driver's queues"),
    "late_max_us": ("µs", "the latest of all"),
    "late_p50_us": ("µs", "half of them were later than this"),
    "late_us": ("µs", "how much later than it should have been"),
    "latency_us": ("µs", "from the request to the driver's start"),
    "left_out": ("", "files that are too large to be kept in a log"),
    "level": ("", "how serious: see the line's description"),
    "limit_s": ("s", "how long it may run; absent: 30"),
    "lines": ("lines", "lines of actions before this one, samples not counted"),
    "lit": ("", "buttons whose light is on"),
    "locked": ("", "whether it is locked now"),
    "log": ("", "the beginning that the names of all files of this session share"),
    "loudest": ("", "RMS of the loudest part, 0 to 1 of full scale; null: not measured"),
    "median_us": ("µs", "median of the reaction times; -1: none"),
    "method": ("", "how the order was found: see the line's description"),
    "missed": ("", "cues without an answer in time"),
    "missing": ("", "drivers that did not say in time that they stand still"),
    "name": (
        "",
        "how a program calls itself; absent: it does not say, or sees no more than the wizard",
    ),
    "right": ("", "cues that were answered rightly"),
    "sees": ("", "`all`: it gets what is kept from the wizard; absent: it does not"),
    "telling": ("", "those of `changes` that may tell which condition is which"),
    "tells": (
        "",
        "what its words tell that may be kept from some: see *What is kept*; absent: nothing",
    ),
    "uncalled": ("", "actions while no cue waited"),
    "unfilled": ("", "those of `args` that tell it, with variables left in place; absent: none"),
    "unreached": ("", "those of `missing` whose hardware was not connected; absent: none"),
    "missing_parts": ("", "driver -> those of its parts that did not say so; absent: none"),
    "next": ("", "where the machine would go if it were not held; absent: it would stay"),
    "next_file": ("", "file in which the log goes on; absent: this line begins a file"),
    "now": ("", "what it is from this line on"),
    "number": ("", "which segment of the log, from 1"),
    "order": ("", "conditions in the order in which the participant gets them"),
    "original": ("", "name of the other session's log"),
    "original_command": ("", "the command's id in the other session"),
    "original_session": ("", "the other session's code"),
    "original_sha256": ("", "SHA-256 of the other log's lines of actions, hexadecimal"),
    "outcome": ("", "name of the transition"),
    "panel": ("", "title of the panel"),
    "panels": ("", "the panels with their actions, as consoles show them"),
    "participant": ("", "participant's code"),
    "parts": ("", "driver -> those of its parts that said so: `speech`, `motion` ..."),
    "path": ("", "the file, the home folder as `~`"),
    "planned": ("", "how many trials, or cues, there are to be; absent: nobody said"),
    "phase": ("", "name of the phase; empty: none holds; of a script absent: the file's own"),
    "planned_us": ("µs", "how long the phase is to last; absent: nobody said"),
    "played": ("", "lines of the script that were played, from 0; absent: all before `position`"),
    "halted": ("", "how the line ended at which the script stands still; absent: it does not"),
    "position": ("", "the script's next line, from 0"),
    "previous": ("", "the file before this one, relative to this one's folder"),
    "profile": ("", "the profile in use; empty: none, everything may be used"),
    "question": ("", "the item's words"),
    "questionnaire": ("", "name of the questionnaire"),
    "raw": ("device's", "what the device said, before any conversion"),
    "reaction_us": ("µs", "from the cue to the request; absent: there was none"),
    "reason": ("", "why, in words"),
    "remedy": ("", "what to do about it"),
    "role": ("", "`wizard`, `watcher` or `program`"),
    "row": ("", "row of the square or place in the blocks, from 0; absent: none"),
    "rows": ("", "the lights, row by row in hexadecimal: see the line's description"),
    "run": (
        "",
        "id of one run of an action; ties its lines together. The machine's: run, hold, off",
    ),
    "schema": ("", "version of this format"),
    "scope": ("", "what the stop reaches: `all` or `drive`"),
    "script": ("", "actions in the script's order"),
    "seed": ("", "seed of everything random"),
    "segment": ("", "which utterance of the visitor, from 1"),
    "sensor": ("", "the quantity that is sensed"),
    "sent": ("", "what really went to the hardware, after limits"),
    "sent_again": ("", "how many commands were sent again"),
    "session": ("", "session's code"),
    "settings": ("", "as an object: see the line's description"),
    "sha256": ("", "SHA-256 of all lines of actions before this one, hexadecimal"),
    "signs": ("", "by the sign's name: see *How a sign is shown*"),
    "since": ("µs", "moment, on the `t` axis, at which the state was entered"),
    "skipped": ("", "whether the item was left out on purpose"),
    "skipped_commands": ("", "how many commands were not sent again"),
    "social_distance": ("m", "near enough to talk"),
    "software": ("", "name and version of the program"),
    "sort": ("", "what kind of cue it is: see the line's description"),
    "source": (
        "",
        "where it came from: `key`, `script`, `palette`, `program`, `wizard`, `participant` ...",
    ),
    "spill": ("", "folders in which the log goes on if its own fails"),
    "state": ("", "the state of the sensor, training or engagement machine from this line on"),
    "targets": ("", "where each waiting control begins to count, 0 to 127"),
    "text": ("", "what was said, typed or recognised"),
    "title": ("", "title of the experiment or of the questionnaire"),
    "took_us": ("µs", "from the end of speech to this line; absent: not measured"),
    "trail": ("", "the last states, oldest first, the present one at the end"),
    "trial": ("", "number of the trial"),
    "unit": ("", "unit of `value`"),
    "until": ("µs", "moment, on the `t` axis, at which it begins"),
    "uses": ("", "the signs that make up the condition of engagement"),
    "value": (
        "`unit`",
        "the measured value, or a questionnaire's answer on its scale; null if there was none",
    ),
    "values": ("", "by name: see the line's description"),
    "variables": ("", "what may stand in braces in an utterance"),
    "verb": ("", "what to do: `say`, `play`, `pose` ..."),
    "verbs": ("", "driver -> the verbs it offers"),
    "verdicts": (
        "",
        "what the engagement model made of each sign: 0, 1 or null; of the identity a name",
    ),
    "visitor": ("", "the visitor's code, never a name; absent: nobody is known"),
    "waiting": ("", "controls that do not count yet: the robot's value is another"),
    "waits_since": (
        "µs",
        "moment, on the `t` axis, since which the visitor waits for an answer; absent: nobody does",
    ),
    "wall": ("", "wall clock, RFC 3339 UTC"),
    "wanted": ("", "what was asked for, of those values that are otherwise; absent: all are so"),
    "was": ("", "what it was before"),
    "what": ("", "what happened to the visitor's entry: see the line's description"),
    "when_busy": ("", "`queue`, `replace` or `refuse`; absent: `queue`"),
    "why": ("", "why, in words"),
    "width": ("lights", "of a row of the face"),
    "window_us": ("µs", "time in which the answer must come"),
    "wizard": ("", "wizard's code"),
    "wrong": ("", "cues that were answered by another action"),
}

#: On every line; explained once, above the tables.
COMMON = tuple(field.name for field in msgspec.structs.fields(Message))

_NAMES = {"integer": "whole number", "object": "object", "array": "list", "string": "text"}


def tables() -> str:
    """A section of Markdown for each kind of line, in the order in which the code has them."""
    return "\n\n".join(_section(each) for each in get_args(AnyMessage))


def _section(each: type[Message]) -> str:
    rows = [
        f"| `{field.encode_name}` | {_type(field)} | {FIELDS[field.encode_name][0]} "
        f"| {'yes' if _always(field) else ''} | {FIELDS[field.encode_name][1]} |"
        for field in msgspec.structs.fields(each)
        if field.name not in COMMON
    ]
    text = " ".join(inspect.cleandoc(each.__doc__ or "").split())
    head = ["| field | type | unit | always | meaning |", "|---|---|---|---|---|"]
    return "\n".join([f"### `{each.__struct_config__.tag}`", "", text, "", *head, *rows])


def _always(field: msgspec.structs.FieldInfo) -> bool:
    """Whether the field is in every line of its kind; one that holds its default is left out."""
    return field.required or field.default_factory not in (msgspec.NODEFAULT, list, dict)


def _type(field: msgspec.structs.FieldInfo) -> str:
    """A field that would be null by default is left out instead, so it is never null."""
    words = json_type(field.type)
    return words if field.required else words.removesuffix(" or null")


def json_type(annotation: Any) -> str:
    """A field's type as a researcher would say it."""
    schema = msgspec.json.schema(annotation)
    words = [  # a struct is only named in a schema
        f"list of {_NAMES.get(option['items'].get('type', ''), 'anything')}s"
        if option.get("type") == "array" and "type" in option.get("items", {})
        else _NAMES.get(option.get("type", "object"), option.get("type", ""))
        for option in schema.get("anyOf", [schema])
    ]
    return " or ".join(words)


def refreshed(page: str) -> str:
    """`page` with the tables between its two marks as they are today."""
    return replaced(page, BEGIN, END, tables())


def replaced(page: str, begin: str, end: str, text: str) -> str:
    """`page` with `text` between two marks. Raises `ValueError` if it lacks them."""
    before, _, rest = page.partition(begin)
    _, found, after = rest.partition(end)
    if not found:
        raise ValueError("the page lacks the marks between which the tables stand")
    return f"{before}{begin}\n\n{text}\n\n{end}{after}"


if __name__ == "__main__":
    target = Path(sys.argv[1])
    target.write_text(refreshed(target.read_text(encoding="utf-8")), encoding="utf-8")
