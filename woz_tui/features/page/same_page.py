"""Whether a request comes from a page of this server: what headers say of it.

A cookie alone does not tell. Another port of the same computer is the same site, so its pages send
our cookie along (`SameSite=Strict` or not); robots serve pages of their own.
"""

from __future__ import annotations

import ipaddress
from collections.abc import Collection, Mapping
from urllib.parse import urlsplit

#: What a page of ours may do, and who may show it: nothing from elsewhere, and nobody.
#: `Referrer-Policy: no-referrer` would have browsers send `Origin: null` with our own forms.
SECURITY_HEADERS: Mapping[str, str] = {
    "Content-Security-Policy": "default-src 'self'; base-uri 'none'; form-action 'self';"
    " frame-ancestors 'none'",
    "X-Frame-Options": "DENY",
    "X-Content-Type-Options": "nosniff",
    "Cache-Control": "no-store",
    "Referrer-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
}


def is_own_host(host: str, here: str, names: Collection[str]) -> bool:
    """Whether the header `Host` names this server: the address at which the request arrived, or one
    of the given `names`. Any other name may have been pointed here by somebody else.

    Args:
        host: The header, with or without a port.
        here: The address on this computer to which the browser has connected.
        names: Names that were given to this server.
    """
    try:
        name = urlsplit(f"//{host}").hostname or ""
    except ValueError:
        return False
    if name in names:
        return True
    try:
        wanted, arrived = ipaddress.ip_address(name), ipaddress.ip_address(here)
    except ValueError:
        return False
    return wanted == arrived or getattr(arrived, "ipv4_mapped", None) == wanted


def is_own_form(headers: Mapping[str, str], own: str) -> bool:
    """Whether a form was sent by a page of the origin `own`."""
    return headers.get("Origin") == own


def is_own_stream(headers: Mapping[str, str], own: str) -> bool:
    """Whether a stream was opened by a page of the origin `own`. Browsers from before 2023 do not
    say so, but from which page they come.
    """
    if site := headers.get("Sec-Fetch-Site"):
        return site == "same-origin"
    scheme, netloc, *_ = urlsplit(headers.get("Referer", ""))
    return f"{scheme}://{netloc}" == own
