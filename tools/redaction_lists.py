"""The lists of docs/how-to/export.md: what redaction keeps."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from tools import replaced
from woz_tui.config.engagement import RUNS
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
            "Everywhere: " + ", ".join(_code(fields)) + ".",
            "",
            "Within objects: " + ", ".join(inside) + ".",
            "",
            "In these kinds only: "
            + "; ".join(
                f"{', '.join(_code(fields))} in {kind}"
                for kind, fields in sorted(redaction.KEPT_IN.items())
            )
            + ".",
            *(_places(kind, places) for kind, places in sorted(redaction.KEPT_AT.items())),
        ]
    )


#: What a text must be to stay at its place.
_SUCH = {
    redaction.is_word: "if it is a lone word or a colour",
    redaction.is_run: f"if it is {' or '.join(RUNS)}",
    redaction.is_label: "whatever the experiment file calls it",
}


def _places(kind: str, places: Mapping[str, Callable[[str], bool]]) -> str:
    such = [
        ", ".join(_code(place for place, test in places.items() if test is wanted)) + f" ({words})"
        for wanted, words in _SUCH.items()
        if wanted in places.values()
    ]
    return f"\nWithin {kind}: {'; '.join(such)}."


def _code(names: Iterable[str]) -> Iterable[str]:
    return [f"`{name}`" for name in sorted(names)]


def refreshed(page: str) -> str:
    """The page with the lists as they are now."""
    return replaced(page, "kept", kept())
