"""How a program ends that has loaded a library which does not survive the ordinary end.

Some C++ libraries of robots tear down their own threads when the process exits, in an order of
chance: now and then that ends in an abort, after everything has long been closed, and the exit
code is a lie. Drivers name such a library here when they load it; the program then ends without
giving it the chance.
"""

from __future__ import annotations

import atexit
import logging
import os
import sys
from typing import NoReturn

_libraries: set[str] = set()


def leave_at_once(library: str) -> None:
    """Once this is called, `leave` ends the process without the destructors of C++ libraries."""
    _libraries.add(library)


def leave(code: int) -> NoReturn:
    """End the program with `code`; what was registered with `atexit` is done in any case."""
    if not _libraries:
        sys.exit(code)
    try:
        atexit._run_exitfuncs()  # as the interpreter would; it has no other name
        logging.shutdown()
        for stream in (sys.stdout, sys.stderr):
            if stream is not None and not stream.closed:
                stream.flush()
    finally:
        os._exit(code)
