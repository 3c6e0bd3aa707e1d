"""The floor of starting a screen: a Textual app with 60 Statics and nothing else."""

from __future__ import annotations

from textual.app import App, ComposeResult
from textual.widgets import Static

STATICS = 60


class Bare(App[None]):
    """Sixty lines of text."""

    def compose(self) -> ComposeResult:
        for number in range(STATICS):
            yield Static(f"Static {number}")


if __name__ == "__main__":
    Bare().run()
