"""The command `woz`; each of its commands is a module that is imported only when it is used."""

from __future__ import annotations

import gc
import importlib
import re
import shutil
import sys
import textwrap
from argparse import SUPPRESS, Action, ArgumentParser, RawDescriptionHelpFormatter
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NoReturn

from woz_tui import __version__
from woz_tui.cli.error_sentences import CommandErrors, is_output_error
from woz_tui.cli.safe_streams import clean_streams
from woz_tui.feature import features
from woz_tui.system import terminal_size

if TYPE_CHECKING:
    from argparse import _SubParsersAction

    _Commands = _SubParsersAction["_Parser"]

#: Command -> its module's one-line summary. A module has `add(parser)`, which declares its
#: options, and `run`, a function from the parsed arguments to the exit code; where the command has
#: commands of its own, `add` sets which of them runs. `ERRORS` are those that are told in a
#: sentence, if they are not just those of all commands. In the order of `woz --help`.
COMMANDS = {
    "run": "start the robot process and the console: a session",
    "demo": "start a session with a simulated robot and a simulated visitor",
    "attach": "join a running session",
    "host": "start only the robot process",
    "new": "write an experiment file to begin with",
    "check": "check an experiment file and show its keys",
    "robots": "show which robots there are and what each offers",
    "convert": "write a WoZ4U config.yaml as an experiment file",
    "visitors": "named visitors: list, show, add, rename, forget, profile",
    "engagement": "run the engagement model on samples or on a session's log",
    "schema": "print the JSON Schema of experiment files, for editors",
    "say": "hear how a text sounds",
    "voices": "list the voices of this machine or of an experiment's robot",
    "render": "compute the setpoints and the face of a body, as lines or curves",
    "record-move": "record a layer of a move by puppeteering",
    "hands": "play with a gamepad, Stream Deck, 6-D mouse or the like, also over ssh",
    "midi": "learn the controls of a MIDI panel, or show their functions",
    "listen": "write the sound of the robot's microphone to standard output",
    "talk": "send a voice from standard input to the robot's loudspeaker",
    "bridge": "play what a planner sends on the topics of a robot's own software (EyePi)",
    "mcp": "offer a running session to an assistant, as tools (Model Context Protocol)",
    "access": "give access from other machines: new, list, revoke",
    "drivers": "offer drivers of this computer to a session on another one",
    "replay": "replay a session on the screen or on the robot",
    "coding": "list codes that were set in replays, and the agreement of two coders",
    "compare": "compare two sessions, or a session and its re-run",
    "report": "report the figures of one or more sessions: tables, plots, CSV, web page",
    "export": "export sessions for other programs: tables, ELAN, BIDS, Praat, MCAP",
    "participants": "list the codes of a study, find one's files, take a participant out",
    "methods": "write a paragraph for the method section of a paper",
    "doctor": "check this machine, its devices and this terminal for an experiment",
    "reset": "put this terminal back after a console that was killed",
    "completion": "print what completes commands in a shell: bash, zsh, fish",
}
#: The first command of each group that `woz --help` shows -> what the group is for.
GROUPS = {
    "run": "a session",
    "new": "an experiment",
    "say": "a robot's voice and moves",
    "hands": "other hands, programs and machines",
    "replay": "afterwards",
    "doctor": "this computer",
}
#: What `woz` alone says: a console has to be seen before a list of commands helps.
FIRST_STEPS = """\
woz: a wizard plays a social robot from a terminal.

  woz demo                      play a simulated robot, with a simulated visitor
  woz new guide.yaml            write an experiment of your own: five questions
  woz run guide.yaml            a session with it
  woz report recordings         what happened in your sessions

Esc stops the robot; ctrl+q leaves the console; ? shows all keys.
`woz --help` lists all commands, `woz COMMAND --help` explains one."""
#: Nearly all that a command makes while it starts stays: looking for garbage in it took a tenth of
#: the time. Later, collecting young objects is quick, and a full collection must not fall into a
#: key press.
GC_THRESHOLDS = (50_000, 20, 100)


def all_commands() -> dict[str, tuple[str, str]]:
    """Each command's module and summary, those of features in their places."""
    commands = {
        name: (f"{__package__}.{name.replace('-', '_')}", summary)
        for name, summary in COMMANDS.items()
    }
    for feature in features().values():
        if (own := feature.command) is not None:
            names = [*commands]
            at = names.index(own.behind) + 1 if own.behind in commands else len(names)
            names.insert(at, own.name)
            place = f"{type(feature).__module__}.{own.module}", own.summary
            commands = {name: commands.get(name, place) for name in names}
    return commands


class _Parser(ArgumentParser):
    """Says what was probably meant by a wrong word or option; commands' own commands, too."""

    def error(self, message: str) -> NoReturn:
        """Print usage and `message`, and exit."""
        from woz_tui.config.problems import hint  # noqa: PLC0415 - only for this

        wrong = re.search(r"invalid choice: '(.*)' \(choose from (.*)\)", message)
        if wrong is not None:
            message += hint(wrong[1], re.findall(r"[^', ]+", wrong[2]))
        elif option := re.search(r"unrecognized arguments: (--[^\s=]+)", message):
            message += hint(option[1], re.findall(r"--[a-z-]+", self.format_usage()))
        super().error(message)


def whole_parser() -> ArgumentParser:
    """All commands with all of their options, which takes a second: for programs that write what
    completes them.
    """
    parser, commands = _program_parser()
    for name, (place, summary) in all_commands().items():
        _declare(commands.add_parser(name, help=summary), place)
    return parser


def _program_parser() -> tuple[ArgumentParser, _Commands]:
    parser = _Parser(
        prog="woz",
        usage="woz [-h] [--version] COMMAND ...",
        description="A wizard plays a social robot from a terminal.",
        formatter_class=RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action=_Version, help="show version and commit, and leave")
    return parser, parser.add_subparsers(prog="woz", metavar="COMMAND", required=True)


def _declare(command: ArgumentParser, place: str) -> None:
    module = importlib.import_module(place)
    errors = getattr(module, "ERRORS", CommandErrors())
    command.set_defaults(run=module.run, errors=errors)
    module.add(command)


def _grouped(commands: Mapping[str, tuple[str, str]]) -> str:
    """Each command in its group; argparse has one list for all of them."""
    wide, lines = max(map(len, commands)), []
    columns = max(shutil.get_terminal_size().columns - 2, wide + 24)
    for name, (_, summary) in commands.items():
        if name in GROUPS:
            lines += ["", f"{GROUPS[name]}:"]
        first, *rest = textwrap.wrap(summary, columns - wide - 4)
        lines.append(f"  {name:<{wide}}  {first}")
        lines += [f"{'':<{wide + 4}}{line}" for line in rest]
    return "\n".join([*lines[1:], "", "`woz COMMAND --help` explains one."])


class _Version(Action):
    """Asks for the commit when it is wanted alone: git takes as long as all the rest."""

    def __init__(self, option_strings: Sequence[str], dest: str, help: str) -> None:  # noqa: A002
        super().__init__(option_strings, dest, nargs=0, help=help)

    def __call__(self, parser: ArgumentParser, *_: object) -> NoReturn:
        from woz_tui.system.provenance import source, with_commit  # noqa: PLC0415

        print(with_commit(f"woz-tui {__version__}", source()))
        parser.exit()


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit code."""
    clean_streams()
    terminal_size.settle()
    words = list(sys.argv[1:] if arguments is None else arguments)
    if not words:
        print(FIRST_STEPS)
        return 2
    parser, commands = _program_parser()
    command_name = next((word for word in words if not word.startswith("-")), "")
    known = all_commands()
    if words[0] == command_name and command_name not in known:
        print(f"woz: {_no_command(command_name)}", file=sys.stderr)
        return 2
    if command_name not in known:  # it asks for help, or for the version
        commands.help = SUPPRESS
        parser.epilog = _grouped(known)
    used = parser
    for name, (place, summary) in known.items():
        command = commands.add_parser(name, help=summary, description=f"woz {name}: {summary}")
        if name == command_name:
            _declare(command, place)
            used = command
    parsed, unknown = parser.parse_known_args(words)
    if unknown:
        used.error(f"unrecognized arguments: {' '.join(unknown)}")
    try:
        code: int = parsed.errors.told(parsed.run, parsed)
        if sys.stdout is not None:  # it may have been closed: >&-
            sys.stdout.flush()
    except KeyboardInterrupt:
        return 130
    except BrokenPipeError:
        sys.stderr.close()
        return 141
    except UnicodeEncodeError as error:
        sign = f"U+{ord(error.object[error.start]):04X}"
        return _cut_short(
            f"this terminal cannot show {sign}: its encoding is {error.encoding};"
            " set LC_ALL=C.UTF-8"
        )
    except OSError as error:
        if not is_output_error(error):
            raise
        return _cut_short(f"standard output: {error.strerror}")
    return code


def _no_command(word: str) -> str:
    """That `word` is no command, and what was probably meant."""
    from woz_tui.config.problems import nearest_word, quoted  # noqa: PLC0415 - only for this

    if word.endswith((".yaml", ".yml")):
        return f"a command is missing before {quoted(word)}; did you mean `woz run {word}`?"
    near = nearest_word(word, all_commands())
    remedy = f"did you mean `woz {near}`?" if near else "`woz --help` lists them"
    return f"there is no command {quoted(word)}; {remedy}"


def _cut_short(why: str) -> int:
    """Say why what was printed is not whole; what is left of it must not fail again at the end."""
    print(f"woz: {why}", file=sys.stderr)
    sys.stdout = None
    return 1


def program() -> NoReturn:
    """The command `woz`: `main`, and the end of the process."""
    gc.set_threshold(*GC_THRESHOLDS)
    try:
        code = main()
    finally:
        gc.freeze()  # the interpreter looks for garbage once more when it ends
    sys.exit(code)
