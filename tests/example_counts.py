"""How much of the same a test tries."""

from hypothesis import settings

#: Examples of a property in `make fuzz`.
EXAMPLES = 1000


def many(usually: int, fuzzing: int = EXAMPLES) -> int:
    """So many in `make test`, and so many in `make fuzz`, for tests marked `hypothesis`."""
    return fuzzing if settings.get_current_profile_name() == "fuzz" else usually
