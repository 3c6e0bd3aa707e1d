"""Makes a session on another machine usable here, for as long as a command runs."""

from __future__ import annotations

import contextlib
import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

from woz_tui.network.certificates import AccessError, AccessFile

#: How long the process may take to end, in seconds.
_END_S = 3.0


@contextlib.contextmanager
def remote_session(access: Path, address: str) -> Iterator[Path | None]:
    """The local socket of the session at `address` (empty: the one in the access file); None after
    printing why there is none. While the network is gone the socket is gone, too.
    """
    try:
        place = address or AccessFile.read(access).address
    except AccessError as error:
        print(f"woz: {error}", file=sys.stderr)
        yield None
        return
    if not place:
        print(f"woz: where is the robot? woz attach --access {access} HOST:PORT", file=sys.stderr)
        yield None
        return
    process = subprocess.Popen(
        [
            *(sys.executable, "-P", "-m", "woz_tui.remote.remote_session"),
            *("--access", str(access), "--address", place),
        ],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        start_new_session=True,  # ctrl+c is the wizard's stop
    )
    try:
        yield _socket(process)
    finally:
        assert process.stdin is not None
        assert process.stdout is not None
        with contextlib.suppress(OSError):
            process.stdin.close()
        process.stdout.close()
        try:
            process.wait(_END_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def _socket(process: subprocess.Popen[bytes]) -> Path | None:
    """Where it can be joined, once it can; troubles on the way are printed."""
    assert process.stdout is not None
    shown = ""
    for line in process.stdout:
        announced = json.loads(line)
        if "socket" in announced:
            return Path(announced["socket"])
        if announced["trouble"] != shown:
            shown = announced["trouble"]
            print(f"woz: {shown}", file=sys.stderr)
            if not announced.get("final"):
                print("woz: it is tried again; ctrl+c gives up", file=sys.stderr)
    return None
