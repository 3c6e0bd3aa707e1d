"""What a session can be asked for, and what is foretold of it: the data of two replies."""

from __future__ import annotations

import msgspec

from woz_tui.protocol.envelope import Json


class ArgumentDescription(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """One argument of a verb.

    `kind`: text, number, whole, flag, choice, file, seconds, joints (an object: joint -> degrees)
    or poses (a list of `{joints, seconds}`); `type` is the JSON type of each. Without a `default`
    the robot decides. `low` and `high` are in `unit`; null: no limit. `choices`: all that it may
    be; empty: anything.
    """

    name: str
    kind: str
    type: str
    summary: str = ""
    required: bool = False
    default: Json = None
    unit: str = ""
    low: float | None = None
    high: float | None = None
    choices: list[str] = []


class VerbDescription(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """One verb of one driver. The first of its `arguments` is the main one.

    Commands of one `lane` of a driver wait for each other. `stream`: only the newest counts.
    `drives`: needs a wizard who watches. `brief`: done at once. `arrives`: after `command.done`
    comes `motion.arrived` or `motion.interrupted`. `limit_s`: it may take so long, in seconds.
    `evidence`: on what its end usually stands, as in `messages.Done`.
    """

    name: str
    driver: str
    lane: str
    limit_s: float
    summary: str = ""
    arguments: list[ArgumentDescription] = []
    stream: bool = False
    drives: bool = False
    brief: bool = False
    arrives: bool = False
    evidence: str = ""


class SensorDescription(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """One sensor as messages call it, with the unit of its values (empty: none, or not known)."""

    name: str
    driver: str
    unit: str = ""


class Description(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """What can be asked for: the `data` of the reply to `describe`."""

    verbs: list[VerbDescription] = []
    sensors: list[SensorDescription] = []


class PredictedMark(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """A point within a command, `at_us` after its beginning; `sort` and `text` as in
    `messages.CommandMark`.
    """

    at_us: int
    sort: str
    text: str = ""


class PredictedCommand(msgspec.Struct, frozen=True, kw_only=True):
    """One command of what is foretold. Null: nobody knows.

    `begins_us` counts from the beginning of the whole. `marks`: null where the driver cannot say.
    """

    verb: str
    driver: str
    begins_us: int | None
    duration_us: int | None
    marks: list[PredictedMark] | None


class Prediction(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """How an action or a verb would go if it began now and nothing else went on: the `data` of the
    reply to `predict`. `duration_us`: of the whole; null: nobody knows.
    """

    duration_us: int | None
    commands: list[PredictedCommand]
