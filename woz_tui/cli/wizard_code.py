"""The wizard's code: asked for once, then remembered for this user of this computer."""

from __future__ import annotations

import contextlib
from collections.abc import Callable

from woz_tui.config.screen_language import say
from woz_tui.log.file_names import check_code
from woz_tui.system.user_folders import WIZARD, state_folder


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
        if known and not _is_code(known):
            return known  # as it was given, for this session alone
        file = state_folder() / WIZARD
        if file.exists() and file.read_text(encoding="utf-8").strip() == known:
            return known
        from woz_tui.system.files import replacing  # noqa: PLC0415 - few starts write it

        file.parent.mkdir(parents=True, exist_ok=True)
        with replacing(file, f"{known}\n"):
            pass
    return known


def _is_code(typed: str) -> bool:
    """Whether it can be a code and is hardly a name: it has a digit. Raises `ValueError`."""
    check_code("wizard", typed)
    return any(letter.isdigit() for letter in typed)


def remembered_wizard() -> str | None:
    """The code that was given last; empty: this wizard wants none; None: nobody was asked."""
    with contextlib.suppress(OSError, RuntimeError, ValueError):
        code = (state_folder() / WIZARD).read_text(encoding="utf-8").strip()
        return check_code("wizard", code) if code else ""
    return None


def _ask(ask: Callable[[str], str]) -> str:
    """A code with a digit, or none: what has no digit is probably a name."""
    question = say(
        "wizard_code.question",
        "Your code as the wizard, such as W1, not your name (enter: no code):",
    )
    while typed := ask(f"{question} ").strip():
        try:
            code = _is_code(typed)
        except ValueError:
            no_code = say(
                "wizard_code.no_code",
                "{typed!r} is not a valid code: use 1 to 16 letters (a to z) and digits",
                typed=typed,
            )
            print(f"  {no_code}")
            continue
        if code:
            remembered = say(
                "wizard_code.remembered",
                "Remembered on this computer; another wizard gives theirs with --wizard.",
            )
            print(f"  {remembered}")
            return typed
        no_digit = say(
            "wizard_code.no_digit",
            "A code has a digit, such as W1; a name does not belong in a log.",
        )
        print(f"  {no_digit}")
    return ""
