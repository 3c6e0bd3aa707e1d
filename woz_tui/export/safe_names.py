"""Names as other programs can hold them."""

from __future__ import annotations

import re


def letters(text: str, otherwise: str) -> str:
    """The ASCII letters and digits of `text`; `otherwise` if there are none."""
    return re.sub("[^A-Za-z0-9]", "", text) or otherwise
