"""Who may see a page: codes that let browsers in, cookies by which they are known again.

A code is of low worth: with it one watches, or answers questionnaires. No page plays the robot. All
end with the process.
"""

from __future__ import annotations

import secrets
from collections import deque
from collections.abc import Callable, Collection
from dataclasses import dataclass, field
from enum import Enum
from hmac import compare_digest

from woz_tui.system.clock import Clock, RealClock

#: Bytes of a code in an address (96 bits), and of a cookie.
_CODE_BYTES, _COOKIE_BYTES = 12, 24
#: Digits of the code that a class types.
_DIGITS = 6
#: Wrong codes of one address in a minute, and of all addresses until the class gets a new code.
WRONG_A_MINUTE, WRONG_IN_ALL = 5, 20
_MINUTE_US = 60_000_000
#: Addresses whose wrong codes are remembered, and browsers that are known at the same time.
_MOST_ADDRESSES, MOST_BROWSERS = 1000, 500


class PageRole(Enum):
    """What a browser may see; its value is the path of its page."""

    WATCH = "watch"
    ANSWER = "answer"


@dataclass(slots=True, eq=False)
class Browser:
    """A browser that was let in."""

    role: PageRole
    cookie: str = field(default_factory=lambda: secrets.token_urlsafe(_COOKIE_BYTES))


class TooOftenError(Exception):
    """This address has given too many wrong codes."""


class Visitors:
    """The codes, and the browsers that they have let in.

    Args:
        new_code: Is told the class's code when too many wrong ones have made another one.
        clock: For how often a code was wrong.
        roles: In which somebody can come in.
    """

    def __init__(
        self,
        new_code: Callable[[str], None],
        clock: Clock | None = None,
        roles: Collection[PageRole] = tuple(PageRole),
    ) -> None:
        #: The code in the address of each role.
        self.codes = {role: _code() for role in PageRole if role in roles}
        self.class_code = _class_code()
        self._new_code = new_code
        self._clock = clock or RealClock()
        self._browsers: dict[str, Browser] = {}
        self._wrong: dict[str, deque[int]] = {}
        #: Wrong codes since the class has the present one.
        self.wrong_in_all = 0

    def browser(self, cookie: str) -> Browser | None:
        """The browser with this cookie."""
        return self._browsers.get(cookie)

    def by_address(self, code: str) -> Browser | None:
        """Whom the code of an address lets in; None: nobody."""
        given = code.encode()
        found = [role for role, code in self.codes.items() if compare_digest(code.encode(), given)]
        return self._admit(found[0]) if found else None

    def by_class_code(self, typed: str, address: str) -> Browser | None:
        """Whom a typed code lets in, to watch; None: nobody. Raises `TooOftenError`."""
        now = self._clock.now_us()
        wrong = self._wrong.get(address, deque(maxlen=WRONG_A_MINUTE))
        if len(wrong) == WRONG_A_MINUTE and now - wrong[0] < _MINUTE_US:
            raise TooOftenError
        right = compare_digest(self.class_code.encode(), "".join(typed.split()).encode())
        if right and PageRole.WATCH in self.codes:
            return self._admit(PageRole.WATCH)
        wrong.append(now)
        self._wrong[address] = wrong
        if len(self._wrong) > _MOST_ADDRESSES:
            del self._wrong[next(iter(self._wrong))]
        self.wrong_in_all += 1
        if self.wrong_in_all >= WRONG_IN_ALL:
            self.wrong_in_all = 0
            self.class_code = _class_code()
            self._new_code(self.class_code)
        return None

    def renew(self, roles: Collection[PageRole]) -> None:
        """Other codes for these roles; whom the old ones have let in is not known any more."""
        for role in [each for each in self.codes if each in roles]:
            self.codes[role] = _code()
        if PageRole.WATCH in roles:
            self.class_code, self.wrong_in_all = _class_code(), 0
        known = self._browsers.items()
        self._browsers = {cookie: each for cookie, each in known if each.role not in roles}

    def _admit(self, role: PageRole) -> Browser:
        """One more; the one that came first is forgotten where they are too many."""
        if len(self._browsers) >= MOST_BROWSERS:
            del self._browsers[next(iter(self._browsers))]
        browser = Browser(role)
        self._browsers[browser.cookie] = browser
        return browser


def _code() -> str:
    return secrets.token_hex(_CODE_BYTES)


def _class_code() -> str:
    return f"{secrets.randbelow(10**_DIGITS):0{_DIGITS}}"
