"""Where a model is served."""

from __future__ import annotations

from urllib.parse import urlsplit

#: The variable of the environment with a server's key.
KEY = "WOZ_SUGGEST_KEY"


def host_of(url: str) -> str:
    """The computer that an address names."""
    return urlsplit(url).hostname or ""


def is_local(url: str) -> bool:
    """Whether nothing leaves this computer."""
    return host_of(url) in ("127.0.0.1", "localhost", "::1")
