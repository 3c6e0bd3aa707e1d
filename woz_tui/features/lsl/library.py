"""The library of the Lab Streaming Layer. Only the process of `woz lsl` loads it."""

from __future__ import annotations

import contextlib
import ctypes
import importlib
import importlib.util
import sys
import warnings
from typing import Any

from woz_tui.system.extras import install_command

#: Where pylsl has no library: it is another package's, or that of its authors.
WITHOUT_LIBRARY = "pylsl has no library liblsl on this computer"
REMEDY = (
    "the package labrecorder has one, on 64-bit Arm too"
    f" ({sys.executable} -m pip install --no-deps --pre labrecorder), and so have"
    " https://github.com/sccn/liblsl/releases; name the file: PYLSL_LIB=.../liblsl.so"
)


class LslMissingError(Exception):
    """There is no Lab Streaming Layer here; `remedy` says where it comes from."""

    def __init__(self, what: str, remedy: str) -> None:
        super().__init__(f"{what}: {remedy}")
        self.what = what
        self.remedy = remedy


def load() -> Any:
    """The module `pylsl`. Raises `LslMissingError`."""
    if importlib.util.find_spec("pylsl") is None:
        raise LslMissingError("`woz lsl` needs the package pylsl", install_command("lsl"))
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return importlib.import_module("pylsl")
    except (ImportError, OSError, RuntimeError, AttributeError) as error:
        # On 64-bit Arm, and with a glibc before 2.35, pip takes a pylsl without a library.
        what = WITHOUT_LIBRARY
        if not isinstance(error, RuntimeError):
            what = f"the library of pylsl cannot be loaded ({error})"
        raise LslMissingError(what, REMEDY) from error


def version(lsl: Any) -> str:
    """`pylsl 1.18.6, liblsl 1.18`."""
    number = int(lsl.library_version())
    return f"pylsl {lsl.__version__}, liblsl {number // 100}.{number % 100}"


def clock_offset(lsl: Any, inlet: Any, seconds: float) -> tuple[float, float, float]:
    """What to add to a stamp of the inlet's stream, how wrong that can be (half of a round trip),
    and when that was measured on the stream's own clock; in seconds. Raises what pylsl raises.
    """
    measured, uncertainty = ctypes.c_double(), ctypes.c_double()
    error = ctypes.c_int()
    call = lsl.lib.lib.lsl_time_correction_ex
    call.restype = ctypes.c_double
    offset = call(
        inlet.obj,
        ctypes.byref(measured),
        ctypes.byref(uncertainty),
        ctypes.c_double(seconds),
        ctypes.byref(error),
    )
    lsl.util.handle_error(error)
    return float(offset), uncertainty.value, measured.value


def text_of(value: object) -> str:
    """A text that came over a stream, whatever its bytes."""
    if isinstance(value, bytes):
        with contextlib.suppress(UnicodeDecodeError):
            return value.decode()
        return value.decode("latin-1")
    return str(value)
