"""`woz engagement FILE`: the engagement model over samples, without a robot."""

from __future__ import annotations

import contextlib
import functools
import json
import os
import stat
import sys
from argparse import ArgumentParser, ArgumentTypeError, Namespace, RawDescriptionHelpFormatter
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from woz_tui.cli.argument_types import file_or_word, number
from woz_tui.cli.error_sentences import CommandErrors
from woz_tui.cli.safe_streams import json_text
from woz_tui.config.engagement import EngagementSettings
from woz_tui.config.engagement_words import CONDITION, FILTERS, SIGNS, START_UPS, TURNS

if TYPE_CHECKING:
    from woz_tui.sensing.sample_rows import SampleRowReader

#: The longest line that is read, in bytes; the rest of a longer one is thrown away.
LONGEST = 1 << 20
#: So many lines after a damaged first one may tell that a file is a session's log.
_LOOKED_AT = 20
#: What a blank line may consist of, the mark at the beginning of some files included.
_BLANK = b"\xef\xbb\xbf \t\r\n"
#: So many wrong lines are told one by one, the others as a number at the end.
MOST_ERRORS = 10
#: Digits that a threshold may have, so that it is computed with exactly as it was typed.
_DIGITS = 15
#: Loudness of speech on a scale of one's own, such as a sound card's whole numbers.
_LOUDEST = 1e9

_DESCRIPTION = """\
Run the engagement model over recorded or made-up samples, or over a session's log, and print what
it says after each line. A line of samples is a JSON object with any of

  t          seconds; a line without it comes one period (--rate) after the one before
  presence   above 0: somebody is there       gaze   0.5 and above: they look at the robot
  id         their name, or "Unknown"         distance   metres
  rms        loudness                         events     list of what happens, of
             handshake_fail handshake_ok reply_done robot_initiative say_done speech_end
             speech_error speech_start stop think_done

null means that a value is missing, the texts "NaN" and "Infinity" stand for those numbers. Each
line gives one line: t, presence, gaze, id, distance (verdicts: 1, 0, null for none yet), state,
outcome and why (null unless the state changed); besides, where there is something to say, steps
(several changes), stale (signs that have gone silent) and bad (keys whose values say nothing).
"""


class OptionsError(Exception):
    """Options that do not go together; the text says why."""


class SamplesFileError(Exception):
    """A file that is not what it seems to be; the text says why."""


ERRORS = CommandErrors(SamplesFileError, who="woz engagement")


def add(parser: ArgumentParser) -> None:
    parser.description = _DESCRIPTION
    parser.formatter_class = RawDescriptionHelpFormatter
    parser.add_argument(
        "file",
        nargs="?",
        type=file_or_word,
        help="lines of samples, or a session's log; - is standard input",
    )
    parser.add_argument(
        "--experiment", type=Path, help="settings from this file's section engagement"
    )
    add_settings(parser)
    parser.add_argument(
        "--compare",
        action="store_true",
        help="for a session's log: compare its results with the new ones",
    )
    parser.add_argument(
        "--trials", action="store_true",
        help=(
            "for a session's log: stability and delay of the signs, from markers `steady`"
            " and `now`"
        ),
    )  # fmt: skip
    parser.add_argument("--json", action="store_true", help="figures for programs")


def add_settings(parser: ArgumentParser) -> None:
    """Options that stand above the experiment's settings; for all signs where signs differ."""
    setting = parser.add_argument_group("settings", "above those of the experiment, for all signs")
    setting.add_argument(
        "--samples", type=number(1, 1000, whole=True), metavar="N", help="samples in each queue (8)"
    )
    setting.add_argument(
        "--threshold", type=_share, metavar="X", help="share of the queue that is needed (0.5)"
    )
    setting.add_argument(
        "--filter", choices=FILTERS, help="fifo; median: of the distance, others stay fifo; joint"
    )
    setting.add_argument(
        "--start-up", choices=START_UPS, help="queues that are not full (zero-fill)"
    )
    setting.add_argument(
        "--stale", type=number(0.05, 60, "s"), metavar="SECONDS",
        help="time in s after which a sign without samples is unknown (1)",
    )  # fmt: skip
    setting.add_argument(
        "--rate", type=number(0.1, 1000, "Hz"), metavar="HZ",
        help="samples a second: how long a line lasts whose t is missing or goes back (3)",
    )  # fmt: skip
    setting.add_argument(
        "--social-distance",
        type=number(0.1, 10, "m"),
        metavar="M",
        help="social distance in m (1.3)",
    )
    setting.add_argument(
        "--signs", type=_signs, metavar="SIGN,...",
        help=f"what the condition of engagement uses ({','.join(CONDITION)})",
    )  # fmt: skip
    setting.add_argument(
        "--turns", choices=TURNS,
        help="visitor: whoever spoke and has left ends a turn; paper: it lasts until it is over",
    )  # fmt: skip
    setting.add_argument(
        "--loud", type=number(0, _LOUDEST), metavar="X",
        help=(
            "sound above this RMS is speech (0.0732, which is 2400 of 32768); above 1: RMS"
            " on the scale 0 to 32768"
        ),
    )  # fmt: skip


def run(arguments: Namespace) -> int:
    """Print a line for each line; 0, 1 for a file that cannot be read, 2 for wrong options."""
    try:
        if arguments.compare and arguments.trials:
            raise OptionsError("--compare and --trials: take one of them")
        settings = settings_of(arguments)
        if arguments.file is None:
            raise OptionsError("name a file with lines of samples, a session's log, or -")
        with _opened(arguments.file) as file:
            first = file.readline(LONGEST)
            if _is_log(arguments.file, file, first):
                return _log(arguments, settings, file, first)
            if arguments.compare or arguments.trials:
                option = "--compare" if arguments.compare else "--trials"
                raise OptionsError(
                    f"{option} needs a session's log: lines of samples have no results of their own"
                )
            _rows(_Lines(arguments.file, file, first), settings, _live(file))
        return 0
    except OptionsError as error:
        _print_error(str(error))
        return 2


def _log(arguments: Namespace, settings: EngagementSettings, file: BinaryIO, first: bytes) -> int:
    from woz_tui.cli import log_from_stdin  # noqa: PLC0415

    try:
        if arguments.file != log_from_stdin.STDIN:
            return _again(arguments, Path(arguments.file), settings)
        with log_from_stdin.stdin_as_log(file, first) as path:
            return _again(arguments, path, settings)
    except (ValueError, log_from_stdin.PipedError) as error:  # it may only look like a log
        raise SamplesFileError(str(error)) from error


def _again(arguments: Namespace, log: Path, settings: EngagementSettings) -> int:
    """Print a log's transitions, or beside those that were recorded; or how trials went."""
    from woz_tui.cli import engagement_log  # noqa: PLC0415

    options = functools.partial(with_options, arguments)
    begin, above = engagement_log.planned(arguments, log, settings, options)
    if arguments.trials:
        from woz_tui.cli import engagement_trials  # noqa: PLC0415

        engagement_trials.show(log, begin, above, as_json=arguments.json)
        return 0
    recount = engagement_log.run(log, begin, above, lines=not arguments.compare)
    if arguments.compare:
        from woz_tui.cli import engagement_compare  # noqa: PLC0415

        engagement_compare.show(recount, as_json=arguments.json)
    return 0


# -- settings -----------------------------------------------------------------------------------


def settings_of(arguments: Namespace) -> EngagementSettings:
    """The experiment's settings, or the defaults, with the options above them.

    Raises `ExperimentError` for a wrong file and `OptionsError` for options that do not go
    together.
    """
    settings = EngagementSettings()
    if file := arguments.experiment:
        from woz_tui.config.loading import load  # noqa: PLC0415
        from woz_tui.drivers import plugins  # noqa: PLC0415

        engagement = load(file, plugins.installed()).engagement
        if engagement is None:
            _print_error(f"{file} has no section engagement; the defaults are used")
        else:
            settings = engagement.settings
    return with_options(arguments, settings)


def with_options(arguments: Namespace, settings: EngagementSettings) -> EngagementSettings:
    """Settings with the options above them; `OptionsError` for those that do not go together."""
    numbers = ("samples", "threshold", "filter", "stale")
    others = ("start_up", "rate", "signs", "social_distance", "turns")
    changes: dict[str, Any] = {
        name: getattr(arguments, name)
        for name in (*numbers, *others)
        if getattr(arguments, name) is not None
    }
    own: dict[str, Any] = {name: None for name in numbers if name in changes}
    changes |= {sign: replace(settings.sign(sign), **own) for sign in SIGNS}
    if arguments.loud is not None:
        changes["sound"] = replace(settings.sound, threshold=arguments.loud)
    settings = replace(settings, **changes)
    problems = settings.problems()
    if problems:
        raise OptionsError("; ".join(f"{name}: {why}" for name, why in problems))
    return settings


def _share(text: str) -> float:
    """A decimal from 0 to 1; it is computed with as it stands, so it must be exact as a float."""
    value = number(0, 1)(text)
    with contextlib.suppress(ValueError):
        if Fraction(text) == Fraction(str(value)):
            return value
    raise ArgumentTypeError(f"{text!r} has more than {_DIGITS} digits")


def _signs(text: str) -> tuple[str, ...]:
    names = [name.strip() for name in text.split(",")]
    unknown = [name for name in names if name not in CONDITION]
    if unknown or len(set(names)) < len(names):
        raise ArgumentTypeError(f"{text!r} is not some of {','.join(CONDITION)}")
    return tuple(name for name in CONDITION if name in names)


# -- lines --------------------------------------------------------------------------------------


class _Lines:
    """The lines of a file with their numbers, blank ones left out; what is wrong is told."""

    def __init__(self, name: str, file: BinaryIO, first: bytes) -> None:
        self._name = "standard input" if name == "-" else name
        self._file = file
        self._line = first
        self._number = 0
        self.wrong = 0

    def __iter__(self) -> Iterator[dict[str, object] | None]:
        """Each line's object; None for a line that is none."""
        while self._line:
            self._number += 1
            if not self._skip_rest():
                self._is_wrong(f"is longer than {LONGEST} bytes")
                yield None
            elif self._line.strip(_BLANK):
                yield self._row()
            self._line = self._file.readline(LONGEST)

    def _skip_rest(self) -> bool:
        """Throw away the rest of a line that is too long."""
        part = self._line
        if len(part) < LONGEST or part.endswith(b"\n"):
            return True
        while part and not part.endswith(b"\n"):
            part = self._file.readline(LONGEST)
        return False

    def _row(self) -> dict[str, object] | None:
        try:
            row = json.loads(self._line.decode("utf-8").removeprefix("\ufeff"))
        except UnicodeDecodeError:
            self._is_wrong("is not UTF-8 text")
        except RecursionError:
            self._is_wrong("is nested too deeply")
        except ValueError as error:
            self._is_wrong(f"is not JSON: {error}")
        else:
            if isinstance(row, dict):
                return row
            self._is_wrong("is not a JSON object")
        return None

    def _is_wrong(self, why: str) -> None:
        self.wrong += 1
        if self.wrong <= MOST_ERRORS:
            _print_error(f"{self._name}:{self._number}: the line {why}")


def _rows(lines: _Lines, settings: EngagementSettings, live: bool) -> None:
    from woz_tui.sensing.sample_rows import SampleRowReader  # noqa: PLC0415

    rows = SampleRowReader(settings)
    out = sys.stdout.buffer
    for row in lines:
        verdicts = rows.no_row() if row is None else rows.add(row)
        out.write(json_text(verdicts).encode("utf-8") + b"\n")
        if live:
            out.flush()
    out.flush()
    _hints(rows, settings, lines.wrong)


def _hints(rows: SampleRowReader, settings: EngagementSettings, wrong: int) -> None:
    """What may explain that nothing came of it."""
    if wrong > MOST_ERRORS:
        _print_error(f"{wrong} lines are not rows of samples")
    silent = [sign for sign in settings.signs if sign not in rows.sampled]
    if silent:
        _print_error(
            f"no line gave {' or '.join(silent)}, so engagement never began"
            f" (--signs sets the signs of the condition: {','.join(settings.signs)})"
        )
    if rows.over:
        _print_error(
            f"{rows.over} values of rms lie above 1 and were left out"
            " (--loud above 1 puts loudness on another scale)"
        )


def _opened(name: str) -> contextlib.AbstractContextManager[BinaryIO]:
    if name == "-":
        return contextlib.nullcontext(sys.stdin.buffer)
    return Path(name).open("rb")


def _live(file: BinaryIO) -> bool:
    """Whether somebody may be waiting for the next line: anything but a file on disk."""
    try:
        return not stat.S_ISREG(os.fstat(file.fileno()).st_mode)
    except OSError:
        return True


def _is_log(name: str, file: BinaryIO, first: bytes) -> bool:
    """Whether it is a session's log, or the samples beside one: messages name their kind.

    The first line that is an object tells; of a file on disk some more are looked at, because the
    beginning of a log may be damaged.
    """
    line = _object(first)
    if line is None and not _live(file):
        place = file.tell()
        more = (_object(file.readline(LONGEST)) for _ in range(_LOOKED_AT))
        line = next((found for found in more if found is not None), None)
        file.seek(place)
    if line is None:
        return name.endswith(".samples.jsonl") and bool(first)
    return isinstance(line.get("kind"), str)


def _object(text: bytes) -> dict[str, object] | None:
    try:
        line = json.loads(text)
    except (ValueError, RecursionError):
        return None
    return line if isinstance(line, dict) else None


def _print_error(text: str) -> None:
    print(f"woz engagement: {text}", file=sys.stderr)
