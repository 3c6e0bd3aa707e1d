"""Hall's spaces around a person.

E. T. Hall, The Hidden Dimension (1966), chapter X; his inches and feet in metres, rounded as usual.
On a border a distance belongs to the space beyond.
"""

from __future__ import annotations

import math

#: Where intimate, personal and social space end, in metres (18 inches, 4 and 12 feet); beyond is
#: public.
ZONES = ((0.45, "intimate"), (1.2, "personal"), (3.6, "social"))
PUBLIC = "public"


def zone(metres: float) -> str:
    """The space at a distance; infinitely far is public too. Nothing (empty) for NaN."""
    if math.isnan(metres):
        return ""
    return next((name for limit, name in ZONES if metres < limit), PUBLIC)
