"""Fetches addresses for the simulated robot and its tablet, so that a wrong one is noticed."""

from __future__ import annotations

import re
import urllib.parse
from dataclasses import dataclass

#: Real seconds for an address, and how much of it is read.
PATIENCE_S = 5.0
MOST_BYTES = 64 * 1024 * 1024
_PARTS = re.compile(r"""<(?:img|video|source|script)\b[^>]*?\bsrc\s*=\s*["']?([^"'\s>]+)""", re.I)


@dataclass(frozen=True, slots=True)
class Fetched:
    """How fetching an address ended: HTTP status (0: nobody answered), bytes, what went wrong."""

    url: str
    status: int
    type: str
    size: int
    error: str
    parts: tuple[str, ...] = ()


def fetch(url: str) -> tuple[Fetched, bytes]:
    """Fetch an address; how it ended, and its bytes. Never raises, blocks for `PATIENCE_S`."""
    if not url.startswith(("http://", "https://")):
        return Fetched(url, 0, "", 0, "not an address that begins with http:// or https://"), b""
    # A tenth of the simulator's start, and few robots fetch anything.
    import urllib.error  # noqa: PLC0415
    import urllib.request  # noqa: PLC0415

    # What a robot at a wizard's computer fetches never goes through a proxy.
    opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
    try:
        with opener.open(url, timeout=PATIENCE_S) as answer:
            kind, content = answer.headers.get_content_type(), answer.read(MOST_BYTES)
            parts = _parts(url, content) if kind == "text/html" else ()
            return Fetched(url, answer.status, kind, len(content), "", parts), content
    except urllib.error.HTTPError as error:
        return Fetched(url, error.code, "", 0, str(error)), b""
    except (OSError, ValueError, urllib.error.URLError) as error:
        return Fetched(url, 0, "", 0, str(error)), b""


def _parts(url: str, content: bytes) -> tuple[str, ...]:
    """Addresses of pictures and videos in a page."""
    found = _PARTS.findall(content.decode("utf-8", "replace"))
    return tuple(urllib.parse.urljoin(url, part) for part in found)
