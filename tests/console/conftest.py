"""What hundreds of consoles have in common."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from textual._styles_cache import StylesCache
from textual.css.model import RuleSet
from textual.css.stylesheet import Stylesheet


@pytest.fixture(autouse=True, scope="session")
def style_sheets_are_parsed_once() -> Iterator[None]:
    """Textual parses the same style sheets anew for each app, which is much of a short test."""
    parse, known = Stylesheet._parse_rules, dict[tuple[Any, ...], list[RuleSet]]()

    def parsed(sheet: Stylesheet, *args: Any, **options: Any) -> list[RuleSet]:
        key = (args, *options.items(), *sheet._variables.items())
        if key not in known:
            known[key] = parse(sheet, *args, **options)
        return known[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Stylesheet, "_parse_rules", parsed)
        yield


@pytest.fixture(autouse=True)
def nothing_is_kept_of_widgets() -> Iterator[None]:
    """Textual keeps the lines of a thousand widgets of earlier apps, to be looked through for
    garbage again and again.
    """
    yield
    StylesCache.get_inner_outer.cache_clear()
