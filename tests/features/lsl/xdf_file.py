"""Writes recordings (XDF 1.0, https://github.com/sccn/xdf/wiki/Specifications) of any content."""

from __future__ import annotations

import struct
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from xml.sax.saxutils import escape


@dataclass(frozen=True, slots=True)
class WrittenStream:
    """A stream with its samples: stamp in seconds and value, a text or a number."""

    name: str
    type: str
    samples: Iterable[tuple[float, str | float]]
    rate: float = 0.0
    host: str = "lab"
    woz: Mapping[str, str] = field(default_factory=dict)
    offsets: tuple[float, ...] = ()


def write_xdf(path: Path, *streams: WrittenStream) -> Path:
    """A recording of these streams."""
    pieces = [b"XDF:", _chunk(1, b"<?xml version='1.0'?><info><version>1.0</version></info>")]
    for number, stream in enumerate(streams, 1):
        samples = [*stream.samples]
        texts = any(isinstance(value, str) for _, value in samples)
        form = "string" if texts else "double64"
        woz = "".join(f"<{name}>{escape(text)}</{name}>" for name, text in stream.woz.items())
        desc = f"<desc><woz>{woz}</woz></desc>" if woz else "<desc/>"
        info = (
            f"<info><name>{stream.name}</name><type>{stream.type}</type><channel_count>1"
            f"</channel_count><nominal_srate>{stream.rate}</nominal_srate><channel_format>{form}"
            f"</channel_format><hostname>{stream.host}</hostname>{desc}</info>"
        )
        pieces.append(_chunk(2, struct.pack("<I", number) + info.encode()))
        data = b"".join(b"\x08" + struct.pack("<d", at) + _value(value) for at, value in samples)
        many = struct.pack("<BI", 4, len(samples))
        pieces.append(_chunk(3, struct.pack("<I", number) + many + data))
        told = "".join(
            f"<offset><time>{at}</time><value>{value!r}</value></offset>"
            for at, value in enumerate(stream.offsets)
        )
        pieces += [
            _chunk(4, struct.pack("<Idd", number, at, value))
            for at, value in enumerate(stream.offsets)
        ]
        footer = f"<info><clock_offsets>{told}</clock_offsets></info>"
        pieces.append(_chunk(6, struct.pack("<I", number) + footer.encode()))
    path.write_bytes(b"".join(pieces))
    return path


def _value(value: str | float) -> bytes:
    if isinstance(value, str):
        return struct.pack("<BI", 4, len(value.encode())) + value.encode()
    return struct.pack("<d", value)


def _chunk(tag: int, content: bytes) -> bytes:
    return struct.pack("<BIH", 4, len(content) + 2, tag) + content
