"""Where the computers of a session's drivers come in: a process of its own that listens for them.

Strangers may open as many connections as they like: descriptors and memory of the robot process are
not among what that costs.
"""

from __future__ import annotations

import asyncio
import contextlib
import importlib.util
from collections.abc import Sequence

import msgspec

from woz_tui.network.certificates import AccessError, Authority
from woz_tui.network.child_line import ChildLine
from woz_tui.network.driver_line import SILENCE_S, LineError, session_key
from woz_tui.network.listen_address import DRIVERS_LISTEN, ListenAddress
from woz_tui.network.shared_child import SharedChild
from woz_tui.network.zenoh_line import MISSING, MISSING_REMEDY

#: The module of the process that listens.
ROUTER = "woz_tui.network.router_child"


class RouterSetup(msgspec.Struct, frozen=True):
    """Where that process listens, for which computers (`let_in`), and the authority's folder."""

    listen: str
    let_in: list[str]
    authority: str
    silence_s: float


class DriverRouter(SharedChild):
    """Where the computers of a session's drivers come in; opened by the first that needs it.

    Args:
        listen: Where.
        places: Names of those computers, as their access files have them.
        authority: Says who may come in; not asked for an address without TLS.
        silence_s: After so long without a sign of life somebody is gone.
    """

    def __init__(
        self,
        listen: str = DRIVERS_LISTEN,
        places: Sequence[str] = (),
        authority: Authority | None = None,
        silence_s: float = SILENCE_S,
    ) -> None:
        super().__init__()
        self.listen = listen
        self._at = ListenAddress.read(listen)
        self.silence_s = silence_s
        self.places = set(places)
        self._authority = authority or Authority()
        #: Those of them that could come in when the line was opened.
        self._let_in: set[str] = set()

    def _admit(self, place: str) -> None:
        if why := self.barred(place):
            raise LineError(why, no_access_remedy(place))
        if self._line is not None and place not in self._let_in:
            raise LineError(f"{place} was given access after the session began", "start it anew")

    def barred(self, place: str) -> str:
        """Why this computer cannot come in; empty: it can."""
        if self._at.plain:
            return ""
        try:
            if not any(each.name == place for each in self._authority.names()):
                return f"{place} has no access"
        except AccessError as error:
            return str(error)
        return self.revoked(place)

    def revoked(self, place: str) -> str:
        """That the access of this computer was revoked; empty: not as far as the list can be read.

        The line knows names and not serial numbers: one that was revoked counts for the name.
        """
        if self._at.plain:
            return ""
        with contextlib.suppress(AccessError):
            if any(each.name == place and each.revoked for each in self._authority.names()):
                return f"the access of {place} was revoked"
        return ""

    def gone(self, place: str) -> str:
        """That this computer is not there any more."""
        if self._line is None or self._line.connected:
            return f"{place} is gone"
        return f"the process that listens for {place} {self._line.why}"

    async def _opened(self) -> ChildLine:
        self._let_in = {each for each in self.places if not self.barred(each)}
        if importlib.util.find_spec("zenoh") is None:
            raise LineError(MISSING, MISSING_REMEDY)
        if not self._at.plain:
            try:
                await asyncio.to_thread(self._authority.context)  # whether its files can be used
            except AccessError as error:
                raise LineError(str(error)) from None
        setup = RouterSetup(
            self.listen, sorted(self._let_in), str(self._authority.place), self.silence_s
        )
        line = ChildLine(
            ROUTER, msgspec.json.encode(setup), f"the process that listens at {self.listen}"
        )
        await line.begin()
        for place in self.places:
            line.show_presence(session_key(place))
        return line


def no_access_remedy(place: str) -> str:
    """What helps a computer that is not let in."""
    return (
        f"woz access new {place}; a revoked name cannot come back: then a new name, also behind"
        " `at:` in both robot files"
    )
