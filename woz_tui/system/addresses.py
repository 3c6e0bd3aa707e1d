"""Secrets of addresses such as `http://user:password@host/picture.png?token=secret`, in whatever
text they stand.
"""

from __future__ import annotations

import re

#: What stands where something was taken out.
HIDDEN = "***"

#: What follows a scheme up to the next blank, and the end of a further scheme in it. Nothing is
#: looked for twice in the same place, so that a text of any length is looked through quickly.
_AFTER_SCHEME = re.compile(r"(?<=[A-Za-z0-9]):(/{1,3})(\S+)")
_SCHEME_END = re.compile(r"(?<=[A-Za-z0-9]):/{1,3}")
#: Ends the part of an address in which a password can stand.
_PATH = re.compile(r"[/?#]")
_PORT = re.compile(r"\d{1,5}(?=[/?#])")


#: What follows a question mark, or a hash sign, up to the next blank.
_QUERY = re.compile(r"[?#]\S+")
#: A secret in it: by the last word of its name (`access_token`, `X-Amz-Signature`, `apiKey`; the
#: short ones stand alone, since `monkey` is none), and up to the next name, without what closes a
#: sentence.
_SECRET = re.compile(
    r"""(?P<name>[?&;#](?:
            [\w.-]{0,60}(?:token|password|passwd|passphrase|secret|signature|credential|apikey)
            | (?:[\w.-]{0,60}[_.-])?(?:key|pass|pwd|auth|sig)
        )=)[^\s&#]*[^\s&#"'<>(){}\[\].,;!?]""",
    re.IGNORECASE | re.VERBOSE,
)


def may_tell_secrets(line: bytes) -> bool:
    """Whether there may be one in a line of JSON: a quick look."""
    return (b"@" in line and b":/" in line) or (b"=" in line and (b"?" in line or b"#" in line))


def without_passwords(text: str) -> str:
    """`text` without the passwords in its addresses, before the host and in their queries; applied
    twice it gives the same as once.
    """
    if "@" in text and ":/" in text:
        text = _AFTER_SCHEME.sub(lambda found: f":{found[1]}{_shown(found[2])}", text)
    if "=" in text and ("?" in text or "#" in text):
        text = _QUERY.sub(lambda found: _SECRET.sub(rf"\g<name>{HIDDEN}", found[0]), text)
    return text


def _shown(address: str) -> str:
    """An address without its scheme. A password may hold an @ or a / of its own."""
    at, begin = address.rfind("@"), 0
    while (colon := address.find(":", begin, max(at, 0))) >= 0:
        end = _PATH.search(address, begin, colon) or _PORT.match(address, colon + 1)
        if end is None:
            return f"{address[:colon]}:{HIDDEN}{address[at:]}"
        further = _SCHEME_END.search(address, end.end())  # such as behind a proxy's address
        if further is None:
            break
        begin = further.end()
    return address
