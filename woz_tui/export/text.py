"""Times and names as other programs can hold them."""

from __future__ import annotations

import re


def seconds(us: int) -> str:
    """Microseconds as seconds with all six places, never in another notation."""
    sign, us = ("-", -us) if us < 0 else ("", us)
    return f"{sign}{us // 1_000_000}.{us % 1_000_000:06d}"


def letters(text: str, otherwise: str) -> str:
    """The ASCII letters and digits of `text`; `otherwise` if there are none."""
    return re.sub("[^A-Za-z0-9]", "", text) or otherwise
