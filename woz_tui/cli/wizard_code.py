"""The wizard's code: asked for once, then remembered for this user of this computer."""

from __future__ import annotations

import contextlib
from collections.abc import Callable

from woz_tui.log.file_names import check_code
from woz_tui.system.user_folders import WIZARD, state_folder

_QUESTION = "Your code as the wizard, such as W1 (no name; enter: none): "


def wizard_code(given: str, ask: Callable[[str], str] = input) -> str:
    """`given`, which is remembered; else what was remembered; else what is typed now. Empty: none,
    which is remembered as well, so that nobody is asked twice.
    """
    known = given or remembered_wizard()
    if known is None:
        try:
            known = _ask(ask)
        except EOFError:  # nobody answers: somebody may the next time
            return ""
    with contextlib.suppress(OSError, RuntimeError, ValueError):  # no reason not to play
        if known:
            check_code("wizard", known)
        file = state_folder() / WIZARD
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(f"{known}\n", encoding="utf-8")
    return known


def remembered_wizard() -> str | None:
    """The code that was given last; empty: this wizard wants none; None: nobody was asked."""
    with contextlib.suppress(OSError, RuntimeError, ValueError):
        code = (state_folder() / WIZARD).read_text(encoding="utf-8").strip()
        return check_code("wizard", code) if code else ""
    return None


def _ask(ask: Callable[[str], str]) -> str:
    """A code with a digit, or none: what has no digit is probably a name."""
    while typed := ask(_QUESTION).strip():
        try:
            check_code("wizard", typed)
        except ValueError as error:
            print(f"  {error}")
            continue
        if any(letter.isdigit() for letter in typed):
            print("  Remembered on this computer; another wizard gives theirs with --wizard.")
            return typed
        print(f"  {typed}1, perhaps? A code has a digit; a name does not belong in a log.")
    return ""
