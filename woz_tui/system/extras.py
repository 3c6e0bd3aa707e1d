"""What to type when a package is missing that only an extra of woz-tui installs."""

from __future__ import annotations

import shlex
import sys
from importlib.util import find_spec


def install_command(extra: str) -> str:
    """The command that installs an extra where it is missing: beside this interpreter.

    A plain `pip` may be another one, which Debian refuses. woz-tui itself is there already, so
    pip looks for what the extra adds and for nothing else. What uv installed has no pip.
    """
    python = shlex.quote(sys.executable)
    pip = f"{python} -m pip install" if find_spec("pip") else f"uv pip install --python {python}"
    return f"{pip} 'woz-tui[{extra}]'"
