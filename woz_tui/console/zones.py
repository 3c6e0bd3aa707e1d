"""Hall's spaces around a person, as the ruler of distances shows them."""

from __future__ import annotations

#: Where Hall's intimate, personal and social spaces end, in metres (E. T. Hall, The Hidden
#: Dimension, 1966); beyond is public.
ZONES = ((0.45, "intimate"), (1.2, "personal"), (3.6, "social"))
LIMITS = tuple(limit for limit, _ in ZONES)
#: The far end of the distance ruler, in metres.
FARTHEST = 4.8


def zone(metres: float) -> str:
    """Hall's name for a distance."""
    return next((name for limit, name in ZONES if metres < limit), "public")
