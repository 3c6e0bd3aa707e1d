"""A timeline editor for moves: frames and layers that one sees, changes and plays."""

from woz_tui.feature import CommandLine, Feature


class MoveEditor(Feature):
    """The command `woz edit-move`, a screen without a session."""

    name = "move-editor"
    command = CommandLine(
        "edit-move",
        "edit the frames of a move on a time line, and see and play them without a robot",
        module="command",
        behind="record-move",
    )
