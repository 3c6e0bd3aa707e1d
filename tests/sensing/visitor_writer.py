"""A process that adds visitors to a store, one after the other, and says each that is in the file.

python -m tests.sensing.visitor_writer FILE PREFIX COUNT
"""

from __future__ import annotations

import sys
from datetime import date
from pathlib import Path

from woz_tui.sensing.visitor_store import VisitorStore


def write(file: Path, prefix: str, count: int) -> None:
    """Add `count` visitors; waits for its turn as long as it takes."""
    store = VisitorStore(file, patience=60.0)
    for number in range(count):
        store.add(f"{prefix}{number}", on=date(2026, 3, 2))
        sys.stdout.write(f"{prefix}{number}\n")
        sys.stdout.flush()


if __name__ == "__main__":
    write(Path(sys.argv[1]), sys.argv[2], int(sys.argv[3]))
