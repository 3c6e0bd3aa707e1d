"""`woz edit-move`: a move on a time line, on a body that needs no robot."""

from __future__ import annotations

import locale
import os
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Mapping
from pathlib import Path

from woz_tui.cli.error_sentences import CommandErrors
from woz_tui.drivers import plugins
from woz_tui.drivers.contract import Driver
from woz_tui.features.move_editor.move_file import EditedFile
from woz_tui.motion.move_files import MoveFileError
from woz_tui.motion.move_recording import RecordError
from woz_tui.motion.render_target import RenderError, RenderTarget

ERRORS = CommandErrors(RecordError, RenderError, MoveFileError, who="woz edit-move")


def add(parser: ArgumentParser) -> None:
    parser.add_argument("file", type=Path, help="move file; it is made if it does not exist")
    parser.add_argument(
        "--robot", type=Path, required=True, help="robot or experiment file with the body"
    )
    parser.add_argument("--body", default="", help="driver, if there are several bodies")
    parser.add_argument(
        "--session",
        nargs="?",
        const="",
        help="play on the body of this session, too (default: the only one)",
    )


def run(arguments: Namespace) -> int:
    """Edit until the wizard leaves; 1 after saying why that is not possible."""
    return edit(arguments, plugins.installed())


def edit(arguments: Namespace, catalogue: Mapping[str, type[Driver]]) -> int:
    """`run` with the drivers of `catalogue`."""
    # Textual takes longer to load than all that may be wrong with the files.
    target = RenderTarget.of(arguments.robot, catalogue, arguments.body, None)
    file = EditedFile(arguments.file, target.spec.settings)
    file.read()
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        raise RecordError("the editor needs a terminal; `woz render --keys` draws without one")
    from woz_tui.console.drawing.theme import choose_appearance  # noqa: PLC0415
    from woz_tui.console.wizard_terminal import WizardDriver  # noqa: PLC0415
    from woz_tui.features.move_editor.app import MoveEditorApp  # noqa: PLC0415

    look = choose_appearance(os.environ, locale.getencoding())
    MoveEditorApp(
        target, file, look=look, driver_class=WizardDriver, session=arguments.session
    ).run(mouse=False)
    return 0
