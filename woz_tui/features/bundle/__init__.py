"""`woz bundle`: one folder with all that is deposited of a study."""

from woz_tui.feature import CommandLine, Feature


class Bundle(Feature):
    """Redacted logs, tables with a codebook, figures, methods text, and what a reader asks for."""

    name = "bundle"
    command = CommandLine(
        "bundle",
        "one folder to deposit: redacted logs, tables, codebook, figures, methods text",
        module="command",
        behind="export",
    )
