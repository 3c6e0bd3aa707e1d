"""The move editor on a terminal, blocked once it has found the session.

`python -m tests.features.move_editor.blocked_editor ROBOT FILE SOCKET FOLDER`: it makes the file
`blocked` in the folder, and stands still until there is a file `go`.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

from woz_tui.console.link.stop_line import StopLine
from woz_tui.console.wizard_terminal import WizardDriver
from woz_tui.drivers import plugins
from woz_tui.features.move_editor.app import MoveEditorApp
from woz_tui.features.move_editor.move_file import EditedFile
from woz_tui.motion.render_target import RenderTarget


class BlockedEditor(MoveEditorApp):
    folder: Path

    def look_now(self) -> None:
        super().look_now()
        line = self.keyboard.feed
        if isinstance(line, StopLine) and line.path is not None:
            (self.folder / "blocked").touch()
            while not (self.folder / "go").exists():
                time.sleep(0.01)


def main() -> None:
    robot, file, socket, folder = map(Path, sys.argv[1:])
    target = RenderTarget.of(robot, plugins.installed(), "", None)
    edited = EditedFile(file, target.spec.settings)
    app = BlockedEditor(target, edited, driver_class=WizardDriver, session=str(socket))
    app.folder = folder
    app.run(mouse=False)


if __name__ == "__main__":
    main()
