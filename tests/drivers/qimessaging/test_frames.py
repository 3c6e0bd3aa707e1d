"""Frames: put together from any pieces, within limits."""

from __future__ import annotations

import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st
from qimessaging import ProtocolError
from qimessaging.frames import HEADER_SIZE, MAGIC, MessageKind, QiMessage, QiMessageReader

WORD = st.integers(0, (1 << 32) - 1)
FRAMES = st.builds(
    QiMessage,
    st.integers(0, 255),
    WORD,
    WORD,
    WORD,
    WORD,
    st.binary(max_size=50),
    st.integers(0, 255),
)


@given(st.lists(FRAMES, max_size=6), st.data())
def test_frames_come_whole_however_they_are_cut(sent: list[QiMessage], data: st.DataObject) -> None:
    raw = b"".join(each.encoded() for each in sent)
    cuts = sorted(data.draw(st.lists(st.integers(0, len(raw)), max_size=8)))
    reader = QiMessageReader()
    got: list[QiMessage] = []
    for start, end in zip([0, *cuts], [*cuts, len(raw)], strict=True):
        got += reader.feed(raw[start:end])

    assert got == sent


@given(st.lists(st.binary(max_size=60), max_size=5))
def test_arbitrary_bytes_are_frames_or_a_protocol_error(pieces: list[bytes]) -> None:
    reader = QiMessageReader()
    try:
        for piece in pieces:
            reader.feed(piece)
    except ProtocolError as error:
        assert str(error)


def test_the_header_is_libqis() -> None:
    raw = QiMessage(MessageKind.CALL, 9, 2, 1, 100, b"xy", 1).encoded()

    assert raw == bytes.fromhex(
        "42dead42 09000000 02000000 0000 01 01 02000000 01000000 64000000 7879"
    )
    assert len(raw) == HEADER_SIZE + 2


@pytest.mark.parametrize(
    ("magic", "size", "version", "says"),
    [(MAGIC + 1, 0, 0, "no qi messaging"), (MAGIC, 101, 0, "101"), (MAGIC, 0, 1, "version 1")],
)
def test_a_wrong_header_is_told_at_once(magic: int, size: int, version: int, says: str) -> None:
    reader = QiMessageReader(longest=100)

    with pytest.raises(ProtocolError, match=says):
        reader.feed(struct.pack("<IIIHBBIII", magic, 1, size, version, 1, 0, 1, 1, 100))
