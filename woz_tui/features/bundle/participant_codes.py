"""Codes that stand for participants in what is published: drawn by chance, so that no list of the
lab and no order of days leads to them.
"""

from __future__ import annotations

import random
from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import Any

#: No vowels, so that no word comes out, and nothing that looks like a digit.
_LETTERS = "BCDFGHJKMNPQRSTVWXYZ"
_LENGTH = 5
#: A text that is a shorter code may be anything, such as a key; so only `participant` is one then.
SHORTEST = 3
#: Fields in which a session's own code may have a participant's inside.
_SESSIONS = ("session", "original_session")


def drawn_codes(old: Iterable[str], chance: random.Random | None = None) -> dict[str, str]:
    """A new code for each of the `old` ones, in the order of the new ones."""
    chance = chance or random.SystemRandom()
    wanted = sorted(set(old))
    new: dict[str, None] = {}
    while len(new) < len(wanted):
        code = "".join(chance.choices(_LETTERS, k=_LENGTH))
        if code not in wanted:
            new[code] = None
    return dict(zip(wanted, new, strict=True))


def codes_in(fields: Any) -> set[str]:
    """All participants' codes that a line tells as such."""
    found: set[str] = set()
    match fields:
        case dict():
            for name, value in fields.items():
                if name == "participant" and isinstance(value, str) and value:
                    found.add(value)
                else:
                    found |= codes_in(value)
        case list():
            for value in fields:
                found |= codes_in(value)
    return found


def words_in(fields: Any) -> Iterator[str]:
    """Names and whole texts of a line, other than the codes that it tells as such."""
    match fields:
        case dict():
            for name, value in fields.items():
                yield name
                if name not in ("participant", *_SESSIONS) or not isinstance(value, str):
                    yield from words_in(value)
        case list():
            for value in fields:
                yield from words_in(value)
        case str():
            yield fields


def recoded(fields: Any, codes: Mapping[str, str], words: Collection[str] = ()) -> Any:
    """The same line with the new codes, wherever a whole text is an old one; a session's own code
    may have it inside. Those that are `words`, too, are codes only where a line says it.
    """
    anywhere = {old: new for old, new in codes.items() if len(old) >= SHORTEST and old not in words}
    return _recoded(fields, codes, anywhere)


def _recoded(fields: Any, codes: Mapping[str, str], anywhere: Mapping[str, str]) -> Any:
    match fields:
        case dict():
            return {
                anywhere.get(name, name): _field(name, value, codes, anywhere)
                for name, value in fields.items()
            }
        case list():
            return [_recoded(value, codes, anywhere) for value in fields]
        case str():
            return anywhere.get(fields, fields)
    return fields


def _field(name: str, value: Any, codes: Mapping[str, str], anywhere: Mapping[str, str]) -> Any:
    if not isinstance(value, str):
        return _recoded(value, codes, anywhere)
    if name in _SESSIONS:
        return _session(value, codes)
    return (codes if name == "participant" else anywhere).get(value, value)


def _session(session: str, codes: Mapping[str, str]) -> str:
    for old in sorted(codes, key=len, reverse=True):
        session = session.replace(old, codes[old])
    return session
