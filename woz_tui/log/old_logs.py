"""Refuses logs of schemas that this version reads no more; none of them was ever released."""

from __future__ import annotations

import errno
from collections.abc import Mapping
from pathlib import Path
from typing import Any

#: The first schema that is read, and the commit of woz-tui that reads the ones before it.
OLDEST_SCHEMA = 3
READS_OLDER = "aef656da"


class OldLogError(OSError):
    """A log of a schema that this version reads no more. It is whole: nothing of it is damaged."""


def why_too_old(first: Mapping[str, Any]) -> str:
    """Why a log whose first line this is cannot be read; empty: it is not too old."""
    schema = first.get("schema")
    if first.get("kind") != "session.start" or type(schema) is not int or schema >= OLDEST_SCHEMA:
        return ""
    return (
        f"a log of schema {schema}, and this version reads {OLDEST_SCHEMA} and later:"
        f" woz-tui of the commit {READS_OLDER} reads it"
    )


def refuse_old(path: Path, first: Mapping[str, Any]) -> None:
    """Raise `OldLogError` for a log whose first line this is, if it is too old."""
    if why := why_too_old(first):
        raise OldLogError(errno.ENOTSUP, why, str(path))
