"""The password for a secured line: read where it is needed, shown nowhere."""

from __future__ import annotations

import os

_HIDDEN = "***"


class Secret:
    """A password that no log and no error text shows by mistake."""

    __slots__ = ("_text",)

    def __init__(self, text: str) -> None:
        self._text = text

    def reveal(self) -> str:
        """The password itself, for the wire alone."""
        return self._text

    def hidden_in(self, text: str) -> str:
        """`text` without the password, for what a robot or a library says."""
        return text.replace(self._text, _HIDDEN) if self._text else text

    def __bool__(self) -> bool:
        return bool(self._text)

    def __repr__(self) -> str:
        return "Secret(***)" if self._text else "Secret()"

    __str__ = __repr__


def password(variable: str) -> Secret:
    """What the environment variable holds; empty if it is not set."""
    return Secret(os.environ.get(variable, "") if variable else "")
