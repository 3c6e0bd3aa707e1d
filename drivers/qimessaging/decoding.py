"""Values from bytes, by signature.

Whatever the bytes are, the outcome is a value or a `ProtocolError`: the number of values, their
depth and every length are limited before memory is taken.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

from qimessaging.errors import ProtocolError
from qimessaging.signature import DEEPEST_VALUE, LENGTH, NUMBERS, SignatureType, parse

#: How many values one message may hold, lists' elements included: reading them takes a part of a
#: second, in which nothing else runs.
MOST_VALUES: Final = 250_000
#: How many values a message of so many bytes may hold: some have no bytes, and a few bytes could
#: announce any number of those. A number in a list of numbers counts less, for it is read at once.
_VALUES_A_BYTE: Final = 8
_VALUES_AT_LEAST: Final = 256
_NUMBERS_A_VALUE: Final = 8


class ValueDecoder:
    """Reads values, one after the other, from one message's payload."""

    def __init__(
        self, data: bytes, make_object: Callable[[ValueDecoder], Any] | None = None
    ) -> None:
        """Begin at the first byte.

        Args:
            data: The payload.
            make_object: Reads an object (`o`) and returns what stands for it here.
        """
        self._data = data
        self._at = 0
        self._left = min(MOST_VALUES, _VALUES_AT_LEAST + _VALUES_A_BYTE * len(data))
        self._depth = 0
        self._make_object = make_object

    @property
    def rest(self) -> int:
        """How many bytes have not been read."""
        return len(self._data) - self._at

    def value(self, signature: SignatureType | str) -> Any:
        """Read one value of that type. Raises `ProtocolError`."""
        kind = parse(signature) if isinstance(signature, str) else signature
        self._spend(1)
        number = NUMBERS.get(kind.kind)
        if number is not None:
            return number.unpack(self._read_bytes(number.size))[0]
        if kind.kind == "s":
            return self._string()
        return self._nested(kind)

    def _nested(self, kind: SignatureType) -> Any:
        read = _READERS.get(kind.kind)
        if read is None:
            raise ProtocolError(f"values of type {kind.kind!r} cannot be sent")
        if self._depth >= DEEPEST_VALUE:
            raise ProtocolError(f"a value nests more deeply than {DEEPEST_VALUE}")
        self._depth += 1
        found = read(self, kind)
        self._depth -= 1
        return found

    def _read_bytes(self, length: int) -> bytes:
        end = self._at + length
        if end > len(self._data):
            raise ProtocolError(f"{length} bytes are announced, {self.rest} are there")
        taken = self._data[self._at : end]
        self._at = end
        return taken

    def _count(self) -> int:
        return int(LENGTH.unpack(self._read_bytes(4))[0])

    def _spend(self, count: int) -> None:
        self._left -= count
        if self._left < 0:
            raise ProtocolError("more values than a message of that length may hold")

    def _bool(self, _kind: SignatureType) -> bool:
        return self._read_bytes(1) != b"\0"

    def _string(self) -> str | bytes:
        raw = self._read_bytes(self._count())
        try:
            return raw.decode()
        except UnicodeDecodeError:
            # NAOqi also passes binary data as strings (an object's identity is one); they are
            # handed over whole instead of being mended.
            return raw

    def _raw(self, _kind: SignatureType) -> bytes:
        return self._read_bytes(self._count())

    def _nothing(self, _kind: SignatureType) -> None:
        return None

    def _list(self, kind: SignatureType) -> list[Any]:
        count = self._count()
        element = kind.inner[0]
        number = NUMBERS.get(element.kind)
        if number is not None:  # sound and coordinates come as long lists of numbers
            self._spend(count // _NUMBERS_A_VALUE)
            packed = self._read_bytes(count * number.size)
            return [found[0] for found in number.iter_unpack(packed)]
        if count > self._left:
            raise ProtocolError(f"a list of {count} values is announced")
        return [self.value(element) for _ in range(count)]

    def _map(self, kind: SignatureType) -> dict[Any, Any]:
        count = self._count()
        if count > self._left:
            raise ProtocolError(f"a map of {count} values is announced")
        key, value = kind.inner
        found: dict[Any, Any] = {}
        for _ in range(count):
            name = self.value(key)
            try:
                found[name] = self.value(value)
            except TypeError as error:
                raise ProtocolError(f"a map's key cannot be a {type(name).__name__}") from error
        return found

    def _tuple(self, kind: SignatureType) -> tuple[Any, ...]:
        return tuple([self.value(member) for member in kind.inner])

    def _dynamic(self, _kind: SignatureType) -> Any:
        signature = self._string()
        if isinstance(signature, bytes):
            raise ProtocolError("a signature is not text")
        self._spend(len(signature))  # to read it takes time, too
        return self.value(signature) if signature else None

    def _optional(self, kind: SignatureType) -> Any:
        return self.value(kind.inner[0]) if self._bool(kind) else None

    def _object(self, _kind: SignatureType) -> Any:
        if self._make_object is None:
            raise ProtocolError("an object is no use here")
        return self._make_object(self)


_READERS: Final[dict[str, Callable[[ValueDecoder, SignatureType], Any]]] = {
    "b": ValueDecoder._bool,
    "r": ValueDecoder._raw,
    "v": ValueDecoder._nothing,
    "_": ValueDecoder._nothing,
    "[": ValueDecoder._list,
    "{": ValueDecoder._map,
    "(": ValueDecoder._tuple,
    "m": ValueDecoder._dynamic,
    "+": ValueDecoder._optional,
    "o": ValueDecoder._object,
}


def decode(signature: SignatureType | str, data: bytes) -> Any:
    """Read one value that fills the data wholly. Raises `ProtocolError`."""
    decoder = ValueDecoder(data)
    found = decoder.value(signature)
    if decoder.rest:
        raise ProtocolError(f"{decoder.rest} bytes too many")
    return found
