"""Synthesised utterances on disk, so that a key is heard at once. What is used least goes first."""

from __future__ import annotations

import contextlib
import hashlib
import os
import tempfile
from collections.abc import Sequence
from pathlib import Path


def users_folder() -> Path:
    """`woz-tui/speech` in the user's cache directory (XDG_CACHE_HOME, or ~/.cache)."""
    base = os.environ.get("XDG_CACHE_HOME", "")
    root = Path(base) if base.startswith("/") else Path.home() / ".cache"
    return root / "woz-tui" / "speech"


class SpeechCache:
    """A folder of WAV files named by what made them. Programs may share one."""

    def __init__(self, folder: Path, megabytes: int) -> None:
        self._folder = folder
        self._limit = megabytes * 1_000_000

    def path(self, recipe: Sequence[str]) -> Path:
        """Where the sound made by `recipe` (command, voice, speed, pitch, text) belongs."""
        digest = hashlib.sha256("\0".join(recipe).encode()).hexdigest()
        return self._folder / f"{digest[:40]}.wav"

    def get(self, path: Path) -> bytes | None:
        """A file's content, and it counts as used now; None if it is not there."""
        try:
            content = path.read_bytes()
        except OSError:
            return None
        with contextlib.suppress(OSError):
            os.utime(path)
        return content

    def put(self, path: Path, content: bytes) -> None:
        """Store a file whole or not at all, then make room. Raises OSError."""
        self._folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        handle, name = tempfile.mkstemp(dir=self._folder, suffix=".part")
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(content)
            Path(name).replace(path)
        except BaseException:
            with contextlib.suppress(OSError):
                Path(name).unlink()
            raise
        self._make_room(keep=path)

    def _make_room(self, keep: Path) -> None:
        files = []
        for file in self._folder.glob("*.wav"):
            with contextlib.suppress(OSError):
                found = file.stat()
                files.append((found.st_mtime, found.st_size, file))
        total = sum(size for _, size, _ in files)
        for _, size, file in sorted(files):
            if total <= self._limit:
                return
            if file != keep:
                with contextlib.suppress(OSError):
                    file.unlink()
                total -= size
