"""Where the robot and its tablet get the files of this machine from."""

from __future__ import annotations

from pathlib import Path
from typing import Protocol

from woz_drivers.pepper.file_server import FileServer
from woz_drivers.pepper.parts_task import apart
from woz_drivers.pepper.settings import TabletSettings
from woz_drivers.pepper.tablet_page import is_address
from woz_tui.drivers.contract import DeviceLostError, DriverContext, DriverError

REMEDY = "check its name, and tablet.root"


class RobotAddress(Protocol):
    """A robot, as far as it is served files."""

    @property
    def local_host(self) -> str:
        """This machine's address as the robot reaches it; empty: it is not there."""


class ServedFiles:
    """Serves files where the robot reaches this machine.

    The server begins with the first file, and anew when the robot is reached in another way.
    """

    def __init__(
        self, robot: RobotAddress, settings: TabletSettings, context: DriverContext
    ) -> None:
        self._robot = robot
        self._settings = settings
        self._context = context
        self._server: FileServer | None = None

    async def connected(self) -> None:
        """A server at another address than this robot needs is of no use."""
        if self._server is not None and self._server.host != self._host:
            await self.close()

    async def shown(self, text: str) -> str:
        """Where the tablet fetches a file from; an address is one already. Raises `DriverError`."""
        return text if is_address(text) else await self.address(self._found(text))

    async def address(self, path: Path) -> str:
        """Where the robot fetches this file from. Raises `DriverError`."""
        server = self._serving()
        return await apart(lambda: server.list_file(path))

    async def page(self, html: str) -> str:
        """Where the tablet fetches a page from. Raises `DriverError`."""
        return self._serving().list_page(html)

    async def close(self) -> None:
        """Serve nothing more."""
        server, self._server = self._server, None
        if server is not None:
            await apart(server.close)

    @property
    def _host(self) -> str:
        return self._settings.address or self._robot.local_host

    def _serving(self) -> FileServer:
        if self._server is None:
            host = self._host
            if not host:
                raise DeviceLostError(
                    "the robot is not connected, so no files can be sent", "wait for it"
                )
            self._server = FileServer(host, self._settings.port, self._troubled)
        return self._server

    def _troubled(self, text: str) -> None:
        self._context.notice("warning", text, "show or play it again", tells=("request",))

    def _found(self, text: str) -> Path:
        """A file below the tablet's root, else below the experiment's folder."""
        paths = places(text, self._settings.root, self._context.folder)
        try:
            found = next((path for path in paths if path.exists()), None)
        except OSError as error:
            raise DriverError(f"{text!r} is no file: {error}", "check its name") from None
        if found is None:
            looked = " or ".join(dict.fromkeys(str(path) for path in paths))
            raise DriverError(f"there is no file {looked}", REMEDY)
        return found


def places(text: str, root: str, folder: Path) -> list[Path]:
    """Where the file `text` may be: below the tablet's `root`, if there is one, and below the
    experiment's `folder`. Raises `DriverError` for what is no name of a file.
    """
    roots = [folder / Path(root).expanduser()] if root else []
    try:
        return [place / Path(text).expanduser() for place in (*roots, folder)]
    except (RuntimeError, ValueError) as error:  # somebody's home that there is not
        raise DriverError(f"{text!r} is no file: {error}", "check its name") from None
