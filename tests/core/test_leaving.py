"""A program that has loaded a library which dies at its end ends well all the same."""

from __future__ import annotations

import subprocess
import sys

import pytest

#: A library that aborts when the process ends, as libqi does now and then.
_PROGRAM = """
import atexit, ctypes, sys
from woz_tui.core.leaving import leave, leave_at_once
libc = ctypes.CDLL(None)
libc["__cxa_atexit"](ctypes.cast(libc.abort, ctypes.c_void_p), None, None)
atexit.register(print, "tidied up")
print("said")
{named}
leave(3)
"""


@pytest.mark.parametrize(("named", "code"), [("leave_at_once('libqi')", 3), ("", -6)])
def test_its_exit_code_is_the_program_s_and_all_is_tidied_up(named: str, code: int) -> None:
    done = subprocess.run(
        [sys.executable, "-c", _PROGRAM.format(named=named)],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert (done.returncode, done.stdout) == (code, "said\ntidied up\n")
