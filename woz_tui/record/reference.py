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
    "action": ("", "name of the action in the experiment file"),
    "args": ("", "the verb's arguments as they were asked for"),
    "attempt": ("", "how often this handshake has asked for a name; absent: not once"),
    "attention": ("", "what draws the robot's attention elsewhere; absent: nothing"),
    "bad": ("", "fields of this line that were not finite numbers and have become null"),
    "began": ("µs", "moment, on the `t` axis, at which it began"),
    "brightness": ("", "of the lights, 0 to 1; absent: 1"),
    "by": ("", "id of the command that took its place"),
    "changes": ("", "what differs, one sentence each"),
    "clock": ("", "where `t` comes from, and the wall clock at `t` = 0"),
    "code": ("", "why, as a word: see the line's description"),
    "command": ("", "id of the command"),
    "condition": ("", "the participant's condition"),
    "confirmed": ("", "drivers that said in time that they stand still"),
    "console": ("", "id of the connection it came over"),
    "deadline_us": ("µs", "moment, on the `t` axis, after which it may not begin; absent: none"),
    "detail": ("", "what exactly"),
    "driver": ("", "name of the driver in the robot file"),
    "dropped": ("lines", "lines lost so far, samples not counted"),
    "dropped_samples": ("lines", "samples lost so far"),
    "duration_us": ("µs", "from the driver's start to its end"),
    "elapsed_us": ("µs", "from the stop to this line"),
    "emotion": ("", "what the face shows"),
    "ended": ("µs", "moment, on the `t` axis, at which it ended"),
    "engaged": ("", "whether the condition of engagement holds"),
    "expected_us": ("µs", "how much longer it will take, from this line on"),
    "experiment": ("", "the experiment file"),
    "experiment_sha256": ("", "SHA-256 of the experiment file, hexadecimal"),
    "file": ("", "the recording, relative to the log's folder; absent: none was kept"),
    "forced": ("", "whether the wizard did it, or decided a verdict on which it rests"),
    "format": ("", "always `woz-session`"),
    "intensity": ("", "how much of it the face shows, 0 to 1"),
    "key": ("", "the key that was pressed"),
    "lag_us": ("µs", "longest that a line had to wait for the disk since the last such report"),
    "lane": ("", "which of the driver's queues"),
    "latency_us": ("µs", "from the request to the driver's start"),
    "level": ("", "how serious: see the line's description"),
    "limit_s": ("s", "how long it may run; absent: 30"),
    "lines": ("lines", "lines of actions before this one, samples not counted"),
    "lit": ("", "buttons whose light is on"),
    "locked": ("", "whether it is locked now"),
    "log": ("", "the beginning that the names of all files of this session share"),
    "loudest": ("", "RMS of the loudest part, 0 to 1 of full scale; null: not measured"),
    "missing": ("", "drivers that did not say in time that they stand still"),
    "next": ("", "where the machine would go if it were not held; absent: it would stay"),
    "now": ("", "what it is from this line on"),
    "number": ("", "which segment of the log, from 1"),
    "outcome": ("", "name of the transition"),
    "panel": ("", "title of the panel"),
    "participant": ("", "participant's code"),
    "path": ("", "the file, the home folder as `~`"),
    "position": ("", "the script's next line, from 0"),
    "previous": ("", "the file before this one, relative to this one's folder"),
    "profile": ("", "the profile in use; empty: none, everything may be used"),
    "raw": ("device's", "what the device said, before any conversion"),
    "reason": ("", "why, in words"),
    "remedy": ("", "what to do about it"),
    "role": ("", "`wizard`, `watcher` or `program`"),
    "rows": ("", "the lights, row by row in hexadecimal: see the line's description"),
    "run": (
        "",
        "id of one run of an action; ties its lines together. The machine's: run, hold, off",
    ),
    "schema": ("", "version of this format"),
    "scope": ("", "what the stop reaches: `all` or `drive`"),
    "seed": ("", "seed of everything random"),
    "segment": ("", "which utterance of the visitor, from 1"),
    "sensor": ("", "the quantity that is sensed"),
    "sent": ("", "what really went to the hardware, after limits"),
    "session": ("", "session's code"),
    "settings": ("", "the section `engagement`, every setting given; empty: there is none"),
    "sha256": ("", "SHA-256 of all lines of actions before this one, hexadecimal"),
    "signs": ("", "by the sign's name: see *How a sign is shown*"),
    "since": ("µs", "moment, on the `t` axis, at which the state was entered"),
    "social_distance": ("m", "near enough to talk"),
    "software": ("", "name and version of the program"),
    "source": ("", "where it came from: `key`, `script`, `palette`, `program` ..."),
    "state": ("", "the state of the sensor or of the engagement machine from this line on"),
    "targets": ("", "where each waiting control begins to count, 0 to 127"),
    "text": ("", "what was said, typed or recognised"),
    "took_us": ("µs", "from the end of speech to this line; absent: not measured"),
    "trail": ("", "the last states, oldest first, the present one at the end"),
    "trial": ("", "number of the trial"),
    "unit": ("", "unit of `value`"),
    "uses": ("", "the signs that make up the condition of engagement"),
    "value": ("`unit`", "the measured value; null if there was none"),
    "values": ("", "by name: see the line's description"),
    "verb": ("", "what to do: `say`, `play`, `pose` ..."),
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
    "was": ("", "what it was before"),
    "what": ("", "what happened to the visitor's entry: see the line's description"),
    "when_busy": ("", "`queue`, `replace` or `refuse`; absent: `queue`"),
    "why": ("", "why, in words"),
    "width": ("lights", "of a row of the face"),
    "wizard": ("", "wizard's code"),
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
    words = [
        f"list of {_NAMES.get(option['items'].get('type', ''), 'anything')}s"
        if option["type"] == "array" and "type" in option.get("items", {})
        else _NAMES.get(option["type"], option["type"])
        for option in schema.get("anyOf", [schema])
    ]
    return " or ".join(words)


def refreshed(page: str) -> str:
    """`page` with the tables between its two marks as they are today."""
    before, _, rest = page.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not end:
        raise ValueError("the page lacks the marks between which the tables stand")
    return f"{before}{BEGIN}\n\n{tables()}\n\n{END}{after}"


if __name__ == "__main__":
    target = Path(sys.argv[1])
    target.write_text(refreshed(target.read_text(encoding="utf-8")), encoding="utf-8")
