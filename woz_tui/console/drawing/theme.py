"""Colours and signs for a terminal. Colours have meanings, and never are the only sign of one.

The hues follow the colour-blind-safe set of Okabe and Ito (2008): blue runs, bluish green is well,
orange warns, vermilion fails; a glyph or a word says the same.

Grounds and rules are nearly grey, so that a terminal of 256 colours finds a grey for them: with a
little more colour the nearest of its 6 x 6 x 6 cube is black, teal or lavender.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.style import Style
from textual.app import App
from textual.color import Color
from textual.theme import BUILTIN_THEMES, Theme

from woz_tui.console.drawing.glyphs import Glyphs, glyphs_for
from woz_tui.system.user_folders import config_folder


def _cursor(foreground: str, ground: str) -> dict[str, str]:
    """The chosen line of a list, with and without the keyboard: a ground on which every look can be
    read, because its pieces keep theirs.
    """
    return {
        f"block-cursor-{blurred}{name}": value
        for blurred in ("", "blurred-")
        for name, value in (
            ("foreground", foreground),
            ("background", ground),
            ("text-style", "bold"),
        )
    }


_DARK = {
    **_cursor("#ffffff", "#3a3d42"),
    "woz-muted": "#9ba4b1",
    "woz-faint": "#444a52",
    "woz-strong": "#ffffff",
    "woz-title": "#9fc3e6",
    "woz-key": "#eef2f6",
    "woz-key-ground": "#303338",
    "woz-run": "#6cb8ff",
    "woz-fill": "#ffffff",
    "woz-fill-ground": "#1d4f7c",
    "woz-wait": "#c7a8ff",
    "woz-good": "#45c490",
    "woz-warn": "#eab54d",
    "woz-bad": "#ff7d6b",
    "woz-alarm": "#ffffff",
    "woz-alarm-ground": "#b3261e",
    "woz-alarm-soft-ground": "#7c1d17",
    "woz-flash": "#121417",
    "woz-flash-ground": "#ffd166",
    "woz-face-1": "#6e5208",
    "woz-face-2": "#a07a14",
    "woz-face-3": "#d1a54a",
    "woz-face-4": "#ffd166",
    "woz-face-ground": "#0a0b0d",
}
_LIGHT = {
    **_cursor("#000000", "#c4d9f1"),
    "woz-muted": "#535d68",
    "woz-faint": "#c4cad2",
    "woz-strong": "#000000",
    "woz-title": "#1f5a8c",
    "woz-key": "#161c22",
    "woz-key-ground": "#dbe1e8",
    "woz-run": "#005ea8",
    "woz-fill": "#06233c",
    "woz-fill-ground": "#b5d9fb",
    "woz-wait": "#6a3fa0",
    "woz-good": "#006f4a",
    "woz-warn": "#8a5600",
    "woz-bad": "#b3261e",
    "woz-alarm": "#ffffff",
    "woz-alarm-ground": "#b3261e",
    "woz-alarm-soft-ground": "#8c1d18",
    "woz-flash": "#000000",
    "woz-flash-ground": "#ffc93c",
    "woz-face-1": "#6e5208",
    "woz-face-2": "#a07a14",
    "woz-face-3": "#d1a54a",
    "woz-face-4": "#ffd166",
    "woz-face-ground": "#22252a",
}
#: The terminal's own sixteen colours, so that its palette decides.
_SIXTEEN = {
    # Without colours only attributes tell the chosen line; Textual leaves out `reverse` here.
    "block-cursor-text-style": "bold underline",
    "block-cursor-blurred-text-style": "bold underline",
    "woz-muted": "ansi_default",
    "woz-faint": "ansi_bright_black",
    "woz-strong": "ansi_default",
    "woz-title": "ansi_cyan",
    "woz-key": "ansi_default",
    "woz-key-ground": "ansi_default",
    "woz-run": "ansi_cyan",
    "woz-fill": "ansi_white",
    "woz-fill-ground": "ansi_blue",
    "woz-wait": "ansi_magenta",
    "woz-good": "ansi_green",
    "woz-warn": "ansi_yellow",
    "woz-bad": "ansi_red",
    "woz-alarm": "ansi_white",
    "woz-alarm-ground": "ansi_red",
    "woz-alarm-soft-ground": "ansi_red",
    "woz-flash": "ansi_black",
    "woz-flash-ground": "ansi_yellow",
    "woz-face-1": "ansi_bright_black",
    "woz-face-2": "ansi_yellow",
    "woz-face-3": "ansi_yellow",
    "woz-face-4": "ansi_bright_yellow",
    "woz-face-ground": "ansi_default",
}

DARK = Theme(
    name="woz-dark",
    primary="#6cb8ff",
    secondary="#9fc3e6",
    warning="#eab54d",
    error="#ff7d6b",
    success="#45c490",
    accent="#6cb8ff",
    foreground="#d9dfe7",
    background="#121417",
    surface="#1a1c20",
    panel="#22252a",
    dark=True,
    variables=_DARK,
)
LIGHT = Theme(
    name="woz-light",
    primary="#005ea8",
    secondary="#1f5a8c",
    warning="#8a5600",
    error="#b3261e",
    success="#006f4a",
    accent="#005ea8",
    foreground="#1d2329",
    background="#fcfcfb",
    surface="#f2f3f5",
    panel="#e9ebee",
    dark=False,
    variables=_LIGHT,
)
SIXTEEN = Theme(
    name="woz-16",
    primary="ansi_cyan",
    secondary="ansi_cyan",
    warning="ansi_yellow",
    error="ansi_red",
    success="ansi_green",
    accent="ansi_cyan",
    foreground="ansi_default",
    background="ansi_default",
    surface="ansi_default",
    panel="ansi_default",
    boost="ansi_default",
    dark=True,
    ansi=True,
    variables=BUILTIN_THEMES["ansi-dark"].variables | _SIXTEEN,
)
THEMES = (DARK, LIGHT, SIXTEEN)
#: What can be chosen: each is a theme's name without `woz-`.
CHOICES = ("dark", "light", "16")

#: Every look there is: its colour, its background ("" for what it is drawn on) and its attributes.
#: A colour is a variable of the theme, and never a look's only meaning.
LOOKS: Mapping[str, tuple[str, str, str]] = {
    "plain": ("foreground", "", ""),
    "muted": ("woz-muted", "", ""),
    "faint": ("woz-faint", "", ""),
    "strong": ("woz-strong", "", "bold"),
    "title": ("woz-title", "", "bold"),
    "key": ("woz-key", "woz-key-ground", "bold"),
    "run": ("woz-run", "", ""),
    "fill": ("woz-fill", "woz-fill-ground", ""),
    "wait": ("woz-wait", "", ""),
    "good": ("woz-good", "", ""),
    "warn": ("woz-warn", "", ""),
    "bad": ("woz-bad", "", "bold"),
    "alarm": ("woz-alarm", "woz-alarm-ground", "bold"),
    "alarm-soft": ("woz-alarm", "woz-alarm-soft-ground", ""),
    "stale": ("woz-muted", "", "italic"),
    "flash": ("woz-flash", "woz-flash-ground", "bold"),
    "face-1": ("woz-face-1", "woz-face-ground", ""),
    "face-2": ("woz-face-2", "woz-face-ground", ""),
    "face-3": ("woz-face-3", "woz-face-ground", ""),
    "face-4": ("woz-face-4", "woz-face-ground", ""),
}
#: Where only the terminal's own sixteen colours are left, its attributes tell these looks apart.
_SIXTEEN_ATTRIBUTES = {"muted": "dim", "stale": "dim"}
#: Without any colours it is these, too.
_COLOURLESS_ATTRIBUTES = {
    "fill": "reverse",
    "flash": "reverse",
    "alarm": "bold reverse",
    "alarm-soft": "reverse",
    "faint": "dim",
    "warn": "bold",
    "face-1": "dim",
    "face-4": "bold",
}


def look_style(look: str, app: App[Any]) -> Style:
    """The colours and attributes of a look in the app's theme.

    Raises:
        KeyError: There is no such look.
    """
    colour, ground, attributes = LOOKS[look]
    if app.theme == SIXTEEN.name:
        attributes = _SIXTEEN_ATTRIBUTES.get(look, attributes)
    if app.no_color:
        attributes = _COLOURLESS_ATTRIBUTES.get(look, attributes)
    variables = app.theme_variables
    return Style.parse(attributes) + Style.from_color(
        Color.parse(variables[colour]).rich_color,
        Color.parse(variables[ground]).rich_color if ground else None,
    )


@dataclass(frozen=True, slots=True)
class Appearance:
    """Signs, and the name of the theme to begin with."""

    glyphs: Glyphs
    theme: str = "woz-dark"


def colour_count(environ: Mapping[str, str]) -> int:
    """How many colours a terminal has, as far as its environment says: Textual goes by the same."""
    if environ.get("COLORTERM", "").strip().lower() in ("truecolor", "24bit"):
        return 1 << 24
    kind = environ.get("TERM", "").strip().lower().rpartition("-")[2]
    return 256 if kind in ("256color", "kitty") else 16


def choose_appearance(
    environ: Mapping[str, str],
    encoding: str,
    *,
    theme: str = "",
    light: Callable[[], bool | None] | None = None,
) -> Appearance:
    """What suits a terminal, by what it says itself.

    NO_COLOR and terminals of 16 colours get the terminal's own colours, so that nothing but its
    palette is used. Otherwise it is the theme that was chosen last (`save_theme`), or what
    `COLORFGBG` tells of the terminal's ground, or what `light` finds out about it. `theme`, and
    then `WOZ_THEME` (dark, light, 16), overrule all that.
    """
    glyphs = glyphs_for(environ, encoding)
    wanted = theme or environ.get("WOZ_THEME", "")
    if wanted in CHOICES:
        return Appearance(glyphs, f"woz-{wanted}")
    few = environ.get("TERM", "") == "linux" or colour_count(environ) <= 16
    if "NO_COLOR" in environ or few:
        return Appearance(glyphs, "woz-16")
    if chosen := saved_theme(environ):
        return Appearance(glyphs, f"woz-{chosen}")
    ground = environ.get("COLORFGBG", "").rpartition(";")[2]
    is_light = light is not None and light() if not ground else ground in ("7", "15")
    return Appearance(glyphs, "woz-light" if is_light else "woz-dark")


# -- what was chosen last --------------------------------------------------------------------------


def _memory(environ: Mapping[str, str]) -> Path:
    return config_folder(environ) / "woz" / "theme"


def saved_theme(environ: Mapping[str, str]) -> str:
    """The theme that was chosen last: one of `CHOICES`, or nothing."""
    with contextlib.suppress(OSError, ValueError, RuntimeError):
        word = _memory(environ).read_text(encoding="utf-8").strip()
        return word if word in CHOICES else ""
    return ""


def save_theme(theme: str, environ: Mapping[str, str]) -> None:
    """Begin with this theme from now on; with an empty one, with what suits the terminal. A folder
    that takes no file is no reason not to play.
    """
    with contextlib.suppress(OSError, RuntimeError):
        file = _memory(environ)
        if not theme:
            file.unlink(missing_ok=True)
            return
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(f"{theme}\n", encoding="utf-8")
