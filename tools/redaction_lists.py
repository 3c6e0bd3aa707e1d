"""The lists of docs/how-to/export.md: what redaction keeps."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from tools import replaced
from woz_tui.export import redaction


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
            "Everywhere: " + ", ".join(f"`{field}`" for field in fields) + ".",
            "",
            "Within objects: " + ", ".join(inside) + ".",
            "",
            "`was` in " + ", ".join(sorted(redaction.KEPT_IN)) + ".",
            "",
            *(_words(kind, fields) for kind, fields in sorted(redaction.WORDS_INSIDE.items())),
        ]
    )


def _words(kind: str, fields: Mapping[str, Collection[str]]) -> str:
    names = [f"`{field}.{name}`" for field, inside in fields.items() for name in sorted(inside)]
    return f"A lone word or a colour, in {kind}: " + ", ".join(names) + "."


def refreshed(page: str) -> str:
    """The page with the lists as they are now."""
    return replaced(page, "kept", kept())
