"""What fails in the server of pages: told to whoever has to know, once, and not in silence."""

from __future__ import annotations

import logging
from collections.abc import Callable

#: Failures that are told; one that comes each second would bury all else.
_MOST = 20

log = logging.getLogger(__name__)


class Failures:
    """Tells what has failed, each failure once; all of them are in the program's own log.

    `tell`: whoever began the pages. `tell_session`: the wizard, once the session is joined.
    """

    def __init__(self, tell: Callable[[str], None]) -> None:
        self._tell = tell
        self.tell_session: Callable[[str], None] = log.debug
        self._told: set[str] = set()

    def tell(self, what: str, error: BaseException) -> None:
        """`what` has failed, and goes on as well as it can."""
        log.error("%s failed", what, exc_info=error)
        text = f"{what} has failed ({type(error).__name__}: {error})"
        if text in self._told or len(self._told) >= _MOST:
            return
        self._told.add(text)
        self._tell(f"woz page: {text}")
        # Without the error's words: they may tell what is kept from some.
        self.tell_session(f"{what} has failed ({type(error).__name__})")
