"""How much of the same a test tries."""

from hypothesis import settings


def many(usually: int, fuzzing: int) -> int:
    """So many in `make test`, and so many in `make fuzz`, for tests marked `hypothesis`."""
    return fuzzing if settings.get_current_profile_name() == "fuzz" else usually
