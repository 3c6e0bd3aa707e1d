"""The lists of docs/reference/redaction.md: what redaction keeps."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from tools import replaced
from woz_tui.export import redaction
from woz_tui.export.feature_export import kept_fields


def kept() -> str:
    """What redaction leaves of the texts."""
    fields = sorted({"experiment", *redaction.KEPT, *redaction.VOCABULARY})
    inside = [
        f"`{field}.{name}`"
        for field, names in sorted(redaction.KEPT_INSIDE.items())
        for name in sorted(names)
    ]
    return "\n".join(
        [
            "Everywhere: " + ", ".join(_code(fields)) + ".",
            "",
            "Within objects: " + ", ".join(inside) + ".",
            "",
            "In these kinds only: "
            + "; ".join(
                f"{', '.join(_code(fields))} in {kind}"
                for kind, fields in sorted({**redaction.KEPT_IN, **kept_fields()}.items())
            )
            + ".",
            *(_places(kind, places) for kind, places in sorted(redaction.kept_at().items())),
        ]
    )


def _places(kind: str, places: Mapping[str, re.Pattern[str]]) -> str:
    such = [
        f"{', '.join(_code(place for place, its in places.items() if its == wanted))} ({words})"
        for wanted, words in {pattern: _such(pattern) for pattern in places.values()}.items()
    ]
    return f"\nIn {kind}: {'; '.join(such)}."


def _such(pattern: re.Pattern[str]) -> str:
    """What a text must be to stay at its place."""
    if pattern is redaction.WORD:
        return "if it is a lone word or a colour"
    if pattern is redaction.LABEL:
        return "whatever the experiment file says"
    return f"if it is {' or '.join(pattern.pattern.split('|'))}"


def _code(names: Iterable[str]) -> Iterable[str]:
    return [f"`{name}`" for name in sorted(names)]


def refreshed(page: str) -> str:
    """The page with the lists as they are now."""
    return replaced(page, "kept", kept())
