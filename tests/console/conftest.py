"""What hundreds of consoles have in common."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from rich.console import RenderableType
from textual._compositor import ChopsUpdate, Compositor
from textual._context import active_app, visible_screen_stack
from textual._styles_cache import StylesCache
from textual.css.model import RuleSet
from textual.css.stylesheet import Stylesheet
from textual.screen import Screen


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
def nothing_is_drawn_unseen(monkeypatch: pytest.MonkeyPatch) -> None:
    """Textual draws every change for apps without a terminal, too, and throws it away, which is a
    third of the time: here only what a test looks at is drawn, or hands on (`_display`).
    """
    draw = Compositor.render_update

    def render_update(
        compositor: Compositor,
        full: bool = False,
        screen_stack: list[Screen[Any]] | None = None,
        simplify: bool = False,
    ) -> RenderableType | None:
        app = active_app.get()
        if full or not app.is_headless or "_display" in vars(app):
            return draw(compositor, full, screen_stack, simplify)
        visible_screen_stack.set(screen_stack or [])
        changed = bool(compositor._dirty_regions)
        compositor._dirty_regions.clear()
        return ChopsUpdate([], [], []) if changed else None

    monkeypatch.setattr(Compositor, "render_update", render_update)


@pytest.fixture(autouse=True)
def nothing_is_kept_of_widgets() -> Iterator[None]:
    """Textual keeps the lines of a thousand widgets of earlier apps, to be looked through for
    garbage again and again.
    """
    yield
    StylesCache.get_inner_outer.cache_clear()
