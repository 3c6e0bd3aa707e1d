"""What every field of a log means, and the tables of it in docs/reference/session-log.md."""

from __future__ import annotations

import inspect
from typing import Any

import msgspec

from tools import replaced
from woz_tui.protocol.kinds import message_kinds
from woz_tui.protocol.messages import Message

#: Unit (empty: none) and meaning of every field, by name: one name means one thing everywhere.
FIELDS: dict[str, tuple[str, str]] = {
    "after_us": ("µs", "from the offer to its end; of settings: no sooner after speech"),
    "answer": ("", "all that the model wrote; absent: nothing"),
    "asked": ("", "the request to the model as it went out"),
    "error": ("", "why nothing came of it; absent: something did"),
    "fits": ("", "one of the actions answers the cue"),
    "model": ("", "the name with which the model's server answered; absent: it did not"),
    "fingerprint": ("", "the server's word for the version of its model; absent: none"),
    "offered": ("", "proposals are offered in this trial"),
    "prompt": ("", "what the model is told before the dialogue"),
    "prompt_sha256": ("", "SHA-256 of the prompt"),
    "sampling": ("", "temperature, seed and length with which the model is asked"),
    "url": ("", "the model's address"),
    "approval": ("", "the program does nothing that is not taken; absent: it only offers"),
    "programs": ("", "names of programs that only propose; absent: none"),
    "dictation": ("", "number of the dictated text, from 1"),
    "on": ("", "whether it is open"),
    "dictations": ("", "the dictated texts in the sentence, by their numbers"),
    "lasted_us": ("µs", "how long the wizard spoke"),
    "distance": ("", "how much of the text was changed before it was said, 0 to 1"),
    "reasons": ("", "why each item was chosen, in their order"),
    "scores": ("", "how likely each item is (0 to 1), in their order"),
    "how": ("", "how the set ended, or how it stands with the model: see the line's description"),
    "set": ("", "id of the set of proposals"),
    "sources": ("", "what proposes: logs, model, program; absent: nothing"),
    "who": ("", "name of the program; absent: none"),
    "slot": ("", "name of the slot in the experiment file"),
    "keep": ("", "for how long its value is kept: `trial`, `participant`; absent: it is not"),
    "fields": ("", "what is known of the participant: fields of `participants` by name"),
    "chosen": ("", "by what: `rule`, or the wizard's `hand`"),
    "face": ("", "number of a face before a camera; absent: nobody's"),
    "about": ("", "data of the visitor: `age_group`, `address`; absent: nothing"),
    "actions": ("", "name of each action -> its steps: see the line's description"),
    "action": ("", "name of the action in the experiment file"),
    "answered": ("", "number of answered items"),
    "given": (
        "",
        "who answered: `self` (at the wizard's screen), `read_aloud`, `own_terminal`, `browser`",
    ),
    "private": ("", "the answer is in no export unless somebody asks for it"),
    "answered_us": ("µs", "from the display of the item to its answer; absent: not measured"),
    "args": ("", "the verb's arguments as requested"),
    "at": ("µs", "moment, on the `t` axis, that is meant; of a marker absent: this line's"),
    "attempt": ("", "number of times this handshake asked for a name; absent: 0"),
    "attention": ("", "what distracts the robot; absent: nothing"),
    "bad": ("", "fields of this line that were not finite numbers and were replaced by null"),
    "began": ("µs", "moment, on the `t` axis, at which it began"),
    "blurred": ("", "what is shown only roughly"),
    "brightness": ("", "of the lights, 0 to 1; absent: 1"),
    "by": ("", "id of the command or the run that replaced it"),
    "stopped": ("", "whether the stop, or the end of the session, cut it short"),
    "call": ("", "the call of the driver that held it up, such as `perform say`"),
    "cause": ("", "why it stood still: see the line's description"),
    "changes": ("", "what differs, one sentence each"),
    "check": ("", "the item of the preflight list, in words"),
    "clock": (
        "",
        "where `t` comes from: the wall clock at `t` = 0, and `monotonic_us`, what CLOCK_MONOTONIC"
        " of that computer said then",
    ),
    "code": ("", "why, as a word: see the line's description"),
    "command": ("", "id of the command"),
    "commands": ("", "how many commands are to be sent again"),
    "condition": ("", "the participant's condition"),
    "conditions": ("", "all conditions of the experiment"),
    "confidence": ("", "how sure the program is, 0 to 1"),
    "confirmed": ("", "drivers that confirmed the stop in time"),
    "conflicts": ("", "settings that conflict, one sentence each"),
    "console": ("", "id of the connection it came over"),
    "copied": ("", "whether the file is a copy of all that was in a deleted one"),
    "cue": (
        "",
        "id of the cue; of a proposal: driver and segment of the words; empty: there was none",
    ),
    "cued": ("µs", "moment, on the `t` axis, of the cue"),
    "cues": ("", "which cues count: see the line's description"),
    "deadline_us": ("µs", "moment, on the `t` axis, after which it may not begin; absent: none"),
    "detail": ("", "what exactly"),
    "driver": ("", "name of the driver in the robot file"),
    "drivers": ("", "names of all drivers"),
    "dropped": ("lines", "lines lost so far, samples not counted"),
    "dropped_samples": ("lines", "samples lost so far"),
    "due": ("µs", "moment, on the `t` axis, for which it is planned"),
    "duration_us": (
        "µs",
        "how long it took: from the driver's start to its end, or from joining to leaving",
    ),
    "elapsed_us": ("µs", "from the key (`pressed` of the stop; 0: its line) to this line"),
    "emotion": ("", "what the face shows"),
    "ended": ("µs", "moment, on the `t` axis, at which it ended"),
    "engaged": ("", "whether the condition of engagement holds"),
    "evidence": ("", "on what it stands that it was done: see the line's description"),
    "expected_us": ("µs", "remaining duration, from this line on"),
    "expects": ("", "correct answers: names of actions"),
    "experiment": ("", "the experiment file"),
    "experiment_sha256": (
        "",
        "SHA-256 of the experiment file and its robot files, one behind the other, hexadecimal",
    ),
    "file": ("", "the recording, relative to the log's folder; absent: none was kept"),
    "file_sha256": ("", "SHA-256 of the experiment file, hexadecimal; absent: not recorded"),
    "files_sha256": ("", "name of each file -> its SHA-256"),
    "files": ("", "name of each file -> its text"),
    "floor_us": ("µs", "shortest time from the cue to the robot's action"),
    "forced": (
        "",
        "whether somebody did it by hand, or set a sign by hand that caused it; `why` says who",
    ),
    "format": ("", "always `woz-session`"),
    "hidden": ("", "what is hidden"),
    "intensity": ("", "how much of it the face shows, 0 to 1"),
    "item": ("", "name of the questionnaire's item, or id of the proposal's"),
    "items": ("", "items of the questionnaire or the proposal: see the line's description"),
    "jitter_us": ("µs", "longest random time that is added"),
    "judged": ("", "how the wizard answered the cue: see the line's description"),
    "key": ("", "the key that was pressed"),
    "keyboard": ("", "layout of the keyboard"),
    "lag_us": ("µs", "longest time that a line waited for the disk since the last such report"),
    "lane": ("", "which of the driver's queues"),
    "late_max_us": ("µs", "largest lateness"),
    "late_p50_us": ("µs", "median lateness"),
    "late_us": ("µs", "how late it was"),
    "latency_us": ("µs", "from the request to the driver's start"),
    "left_out": ("", "files that are too large to be kept in a log"),
    "level": ("", "how serious: see the line's description"),
    "limit_s": ("s", "time limit; absent: 30"),
    "lines": ("lines", "lines of actions before this one, samples not counted"),
    "lit": ("", "buttons whose light is on"),
    "locked": ("", "whether it is locked now"),
    "log": ("", "the beginning that the names of all files of this session share"),
    "first_us": ("µs", "to the first text, from when speech or request began; null, -1: none"),
    "language": ("", "in which it was understood, where the program says so"),
    "lost_us": ("µs", "what was dropped, so as not to be heard late"),
    "loudest": ("", "RMS of the loudest part, 0 to 1 of full scale; null: not measured"),
    "median_us": ("µs", "median of the reaction times; -1: none"),
    "method": ("", "how the order was found: see the line's description"),
    "missed": ("", "cues without an answer in time"),
    "missing": ("", "drivers that did not confirm the stop in time"),
    "name": (
        "",
        "how a program calls itself; absent: it does not say, or it is a console",
    ),
    "right": ("", "cues that were answered rightly"),
    "robot": ("", "the robot that plays instead of the file's own; absent: none"),
    "redacted": ("", "texts and dates were taken out"),
    "sees": ("", "`all`: it also gets what is hidden from the wizard; absent: it does not"),
    "telling": ("", "those of `changes` that could reveal which condition is which"),
    "uncalled": ("", "actions while no cue waited"),
    "unfilled": ("", "those of `args` that reveal it, with variables not filled in; absent: none"),
    "edited": ("", "whether its sentence was typed anew before it was said; absent: no"),
    "without": ("", "what this robot does not do of it; absent: nothing"),
    "unable": ("", "names of verbs; absent: none"),
    "unreached": ("", "drivers of `missing` whose hardware was not connected; absent: none"),
    "missing_parts": ("", "driver -> its parts that did not confirm the stop; absent: none"),
    "next": ("", "next state if the machine were not held; absent: no change"),
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
    "line": (
        "",
        "what stands between a console and its terminal: tmux, screen, mosh; absent: nothing",
    ),
    "driving": (
        "",
        "whether a wizard's keys drive while `held` or once `pressed`; absent: no wizard",
    ),
    "part": ("", "which part of the panels its wizard plays; absent: none in particular"),
    "parts": ("", "driver -> its parts that confirmed the stop: `speech`, `motion` ..."),
    "path": ("", "the file, the home folder as `~`"),
    "place": ("", "the line of code"),
    "planned": ("", "number of planned trials or cues; absent: not set"),
    "phase": ("", "name of the phase; empty: none holds; of a script absent: the file's own"),
    "planned_us": ("µs", "planned duration of the phase; absent: not set"),
    "played": ("", "lines of the script that were played, from 0; absent: all before `position`"),
    "halted": (
        "",
        "how the line ended at which the script stopped; absent: the script did not stop",
    ),
    "position": ("", "the script's next line, from 0"),
    "pressed": ("µs", "moment, on the `t` axis, of the key, or of what stopped by itself"),
    "previous": ("", "the file before this one, relative to this one's folder"),
    "profile": ("", "the profile in use; empty: none, everything may be used"),
    "question": ("", "the item's words"),
    "questionnaire": ("", "name of the questionnaire"),
    "raw": ("device's", "value of the device before any conversion"),
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
    "every_s": ("s", "from one reading to the next, where they are seldom by nature; 0: not told"),
    "sensor": ("", "the quantity that is sensed"),
    "sent": ("", "what really went to the hardware, after limits"),
    "sent_again": ("", "how many commands were sent again"),
    "session": ("", "session's code"),
    "settings": ("", "as an object: see the line's description"),
    "sha256": ("", "SHA-256 of all lines of actions before this one, hexadecimal"),
    "signs": ("", "by the sign's name: see *How a sign is shown*"),
    "simulated": ("", "drivers whose hardware was simulated; absent or null: nobody knows"),
    "since": ("µs", "moment, on the `t` axis, at which the state was entered"),
    "host": ("", "the computer from which it comes"),
    "offset_us": ("µs", "what to add to a stamp of the stream to have one of this computer"),
    "outgoing": ("", "whether it is one of those as which the session is sent"),
    "prefix": ("", "with what the names of the session's streams begin"),
    "sensors": ("", "names of the sensors that are sent"),
    "shares": ("", "what else of the log is sent: texts, conditions, codes"),
    "source_id": ("", "how the program that sends it calls it, the same at each start"),
    "stream": ("", "the stream's name"),
    "taken": ("", "whether a recorder or another program takes it"),
    "takes": ("", "streams of other programs that are taken: see the line's description"),
    "too_fast": ("", "values of the stream so far that were left out"),
    "type": ("", "the stream's type, such as `Markers`"),
    "uid": ("", "the stream's number in the Lab Streaming Layer, another at each start"),
    "uncertainty_us": ("µs", "how wrong the offset can be"),
    "skipped": ("", "whether the item was skipped on purpose"),
    "skipped_commands": ("", "how many commands were not sent again"),
    "social_distance": ("m", "social distance"),
    "software": (
        "",
        "name, version, `commit`, `dirty` (edited since: `yes` or `no`), Python, libraries",
    ),
    "begin": ("µs", "moment, on the `t` axis, at which it begins"),
    "behaviours": ("", "each with `id`, `sort`, what the robot `does`, and its `points` (µs)"),
    "block": ("", "id of the block"),
    "problem": ("", "what is not played: its `sort`, `about` which behaviour, `text`"),
    "problems": ("", "each as `problem`; absent: none"),
    "sort": ("", "what kind of cue or mark it is: see the line's description"),
    "source": (
        "",
        "where it came from: `key`, `script`, `palette`, `program`, `wizard`, `participant` ...",
    ),
    "spill": ("", "folders in which the log goes on if its own fails"),
    "state": ("", "the state of the sensor, training or engagement machine from this line on"),
    "targets": ("", "where each waiting control begins to count, 0 to 127"),
    "text": ("", "what was said, typed or recognised"),
    "own": ("", "it is the robot's own voice; null: nobody has judged"),
    "overlap": ("", "a visitor spoke into the robot's sentence"),
    "partials": ("", "texts so far that were shown"),
    "revised": ("", "how many of them took back a word of the one before"),
    "title": ("", "title of the experiment or of the questionnaire"),
    "took_us": ("µs", "from the end of speech to this line; absent: not measured"),
    "trail": ("", "the last states, oldest first, the present one at the end"),
    "trial": ("", "number of the trial"),
    "over": (
        "",
        "numbers of trials that the participant has had in this order; absent: not recorded",
    ),
    "trials": ("", "trials in each condition; absent: as the experiment file says"),
    "day": ("", "day (UTC)"),
    "last_removed": ("", "number of the last line that was taken out"),
    "removed": ("lines", "lines of actions that were taken out"),
    "removed_samples": ("lines", "samples that were taken out"),
    "removed_until": ("µs", "moment, on the `t` axis, of the last line that was taken out"),
    "version": ("", "version of woz-tui"),
    "unit": ("", "unit of `value`"),
    "until": ("µs", "moment, on the `t` axis, at which it begins, or until which it holds"),
    "uses": ("", "the signs that make up the condition of engagement"),
    "value": (
        "`unit`",
        "the measured value, or a questionnaire's answer on its scale; null if there was none",
    ),
    "unwritten_since": ("µs", "moment, on the `t` axis, since which no folder took the log"),
    "values": ("", "by name: see the line's description"),
    "roles": ("", "for whom pages are: watch, answer"),
    "encrypted": ("", "nobody in the network can read along"),
    "address": ("", "where pages are"),
    "class_code": ("", "what a class types there; it ends with the pages"),
    "choice": ("", "the choice of the experiment file"),
    "options": ("", "what stands on the buttons"),
    "pictures": ("", "the names of their pictures; empty where there is none"),
    "option": ("", "what stands on the button that was chosen"),
    "ticked": ("", "of several choices: what is stored of each that was chosen"),
    "via": ("", "name of the access file with which it came from another machine"),
    "variables": ("", "what may stand in braces in an utterance"),
    "verb": ("", "what to do: `say`, `play`, `pose` ..."),
    "verbs": ("", "driver -> the verbs it offers"),
    "verdicts": (
        "",
        "what the engagement model made of each sign: 0, 1 or null; of the identity a name",
    ),
    "visitor": ("", "the visitor's code, never a name; absent: no visitor is identified"),
    "waiting": ("", "controls that have no effect yet: the robot's value differs"),
    "waived": ("", "the wizard goes on without a record"),
    "warm_up": ("", "before anybody had said anything; absent: it was asked for an answer"),
    "waived_at": (
        "µs",
        "moment, on the `t` axis, at which the wizard went on without a record; absent: not",
    ),
    "waits_since": (
        "µs",
        "moment, on the `t` axis, since which the visitor waits for an answer; absent: no"
        " visitor waits",
    ),
    "wall": ("", "wall clock, RFC 3339 UTC"),
    "wanted": ("", "requested values, where they differ; absent: none differ"),
    "was": ("", "what it was before"),
    "what": ("", "what happened to the visitor's entry: see the line's description"),
    "when_busy": ("", "`queue`, `replace` or `refuse`; absent: `queue`"),
    "why": ("", "why, in words; of a model: a word"),
    "width": ("lights", "of a row of the face"),
    "window_us": ("µs", "time limit for the answer"),
    "wizard": ("", "wizard's code"),
    "words": (
        "",
        "each with `text`, `began` and `ended` (µs, on the `t` axis), perhaps `confidence`",
    ),
    "wrong": ("", "cues that were answered by another action"),
}

#: On every line, and what a line of many kinds may have; explained once, above the tables.
COMMON = (*(field.name for field in msgspec.structs.fields(Message)), "tells", "wording")

_NAMES = {"integer": "whole number", "object": "object", "array": "list", "string": "text"}


def tables() -> str:
    """A section of Markdown for each kind of line, in the order in which the code has them."""
    return "\n\n".join(_section(each) for each in message_kinds())


def _section(each: type[Message]) -> str:
    rows = [_row(field) for field in msgspec.structs.fields(each) if field.name not in COMMON]
    text = " ".join(inspect.cleandoc(each.__doc__ or "").split())
    head = ["| field | type | unit | always | meaning |", "|---|---|---|---|---|"]
    return "\n".join([f"### `{each.__struct_config__.tag}`", "", text, "", *head, *rows])


def _row(field: msgspec.structs.FieldInfo) -> str:
    name = field.encode_name
    unit, meaning = FIELDS.get(name, ("", "**to be explained**, in `FIELDS` of this program"))
    return f"| `{name}` | {_type(field)} | {unit} | {'yes' if _always(field) else ''} | {meaning} |"


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
    """`page` with the tables as they are today."""
    return replaced(page, "tables", tables())
