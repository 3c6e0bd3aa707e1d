"""Hall's spaces around a person, each with a near and a far phase.

E. T. Hall, The Hidden Dimension (1966), chapter X; his inches and feet in metres, rounded as usual.
On a border a distance belongs to the space beyond.
"""

from __future__ import annotations

import math

#: Where intimate, personal and social space end, in metres (18 inches, 4 and 12 feet); beyond is
#: public.
ZONES = ((0.45, "intimate"), (1.2, "personal"), (3.6, "social"))
PUBLIC = "public"
#: Where the near phase of each space ends, in metres (6 and 30 inches, 7 and 25 feet).
NEAR_PHASES = {"intimate": 0.15, "personal": 0.75, "social": 2.1, PUBLIC: 7.6}


def zone(metres: float) -> str:
    """The space at a distance; infinitely far is public too. Nothing (empty) for NaN."""
    if math.isnan(metres):
        return ""
    return next((name for limit, name in ZONES if metres < limit), PUBLIC)


def phase(metres: float) -> str:
    """`near` or `far` within the space. Nothing (empty) for NaN."""
    found = zone(metres)
    if not found:
        return ""
    return "near" if metres < NEAR_PHASES[found] else "far"
