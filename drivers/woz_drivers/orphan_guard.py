"""Kills what children left behind when the robot process itself was killed.

The kernel ends a direct child with us, but not what that child started: both programs of
`sh -c "piper | aplay"` would go on. So one small shell reads from a pipe which process groups
there are. When we are gone, however that happened, the pipe ends, and it kills those that are left.
"""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

_SHELL = Path("/bin/sh")
#: `+ 12` adds a group, `- 12` takes it away; numbers of groups are unique for as long as they run.
_SCRIPT = """
trap '' HUP INT TERM
while read -r sign group; do
  left=
  for one in $groups; do [ "$one" = "$group" ] || left="$left $one"; done
  [ "$sign" = - ] || left="$left $group"
  groups=$left
done
for one in $groups; do kill -s KILL -- "-$one"; done
"""


class Guard:
    """The shell and the pipe to it; it is started with the first group.

    Attributes:
        pid: The shell's, None before.
    """

    def __init__(self) -> None:
        self.pid: int | None = None
        self._pipe = -1

    def watch(self, group: int) -> None:
        """Kill this process group should we end before `release`."""
        if self.pid is None:
            self._start()
        self._write(f"+ {group}\n")

    def release(self, group: int) -> None:
        """The group has ended; its number may be given to somebody else."""
        self._write(f"- {group}\n")

    def _start(self) -> None:
        reading, self._pipe = os.pipe()  # neither end is inherited by other children
        os.set_blocking(self._pipe, False)
        silent = [(os.POSIX_SPAWN_OPEN, fd, os.devnull, os.O_WRONLY, 0) for fd in (1, 2)]
        try:
            self.pid = os.posix_spawn(
                _SHELL,
                (_SHELL.name, "-c", _SCRIPT),
                {},
                file_actions=[(os.POSIX_SPAWN_DUP2, reading, 0), *silent],
                setsid=True,
            )
        except (OSError, NotImplementedError):
            os.close(self._pipe)  # then without: the kernel still ends direct children
            self._pipe = -1
        finally:
            os.close(reading)

    def _write(self, line: str) -> None:
        with contextlib.suppress(OSError):
            os.write(self._pipe, line.encode())


#: The one of this process.
guard = Guard()
