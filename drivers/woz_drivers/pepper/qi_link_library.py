"""The package `qi`, brought in so that it is silent: its logs on stdout would ruin a screen."""

from __future__ import annotations

import os
from functools import cache
from importlib.util import find_spec
from types import ModuleType
from typing import Any

from woz_tui.core.leaving import leave_at_once


def installed() -> bool:
    """Whether the package is there."""
    return find_spec("qi") is not None


def usable() -> bool:
    """Whether it is there and loads."""
    if not installed():
        return False
    try:
        library()
    except ImportError:
        return False
    return True


@cache
def library() -> ModuleType:
    """The package. Raises `ImportError` where it is not installed or does not load."""
    # libqi reads this when it is loaded, and logs on stdout from its first thread on.
    os.environ["QI_LOG_LEVEL"] = "0"
    import qi  # noqa: PLC0415 - 40 ms and five threads, for those alone who have a Pepper
    import qi.logging  # noqa: PLC0415

    qi.logging.setLevel(qi.logging.SILENT)
    # Its threads end in an abort now and then, when the process does.
    leave_at_once("libqi")
    loaded: ModuleType = qi
    return loaded


class Login:
    """What libqi wants for a secured line: makes an authenticator for each connection."""

    def __init__(self, user: str, password: str) -> None:
        self._said = {"user": user, "token": password}

    def newAuthenticator(self) -> Login:  # noqa: N802 - libqi's names
        """One authenticator serves them all: it remembers nothing."""
        return self

    def initialAuthData(self) -> dict[str, Any]:  # noqa: N802
        """What is sent first."""
        return dict(self._said)

    def _processAuth(self, _asked: dict[str, Any]) -> dict[str, Any]:  # noqa: N802
        """What is answered to further questions: nothing more than that."""
        return {}
