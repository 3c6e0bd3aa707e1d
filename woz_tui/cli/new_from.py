"""`woz new FILE --from NAME`: an example that comes with woz-tui, with the files that it names."""

from __future__ import annotations

import re
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

from woz_tui.config.bundled_files import bundled_file, examples
from woz_tui.config.problems import hint

_TITLE = re.compile(r"^title: *(.+?) *(?:#.*)?$", re.MULTILINE)
#: What may be a path in a file: at least one folder and a name.
_PATH = re.compile(r"[\w.-]+(?:/[\w.-]+)+")


def print_examples() -> int:
    """Print names and titles."""
    known = examples()
    wide = max(map(len, known), default=0)
    for name, path in known.items():
        found = _TITLE.search(path.read_text(encoding="utf-8"))
        print(f"{name:<{wide}}  {found[1] if found is not None else 'a file of WoZ4U'}")
    return 0


def copy_example(name: str, file: Path) -> int:
    """Copy it to `file`, and what it needs beside it. Nothing is overwritten."""
    known = examples()
    if name not in known:
        near = hint(name, known) or f"; there are {', '.join(known)}"
        print(f"woz: there is no example {name!r}{near}", file=sys.stderr)
        return 1
    source = known[name]
    copies = {
        file if path == source else file.parent / path.relative_to(source.parent): path
        for path in _needed(source)
    }
    for target, path in copies.items():
        if target.exists() and (target == file or target.read_bytes() != path.read_bytes()):
            print(f"woz: {target} is there already; choose another folder", file=sys.stderr)
            return 1
    for target, path in copies.items():
        target.parent.mkdir(parents=True, exist_ok=True)
        if not target.exists():
            shutil.copyfile(path, target)
    print("\n".join(f"{target}: written" for target in copies))
    print(f"Next:\n  woz check {file}\n  woz run {file}")
    return 0


def _needed(source: Path) -> list[Path]:
    """The file and all that it names, in turn, as far as it comes with woz-tui; one with a folder
    of its own has all of it.
    """
    if source.parent != bundled_file(""):
        return [source, *(path for path in _files(source.parent) if path != source)]
    found, waiting = [source], [source]
    while waiting:
        file = waiting.pop()
        for path in _named(file, source.parent):
            if path not in found:
                found.append(path)
                if path.suffix == ".yaml":
                    waiting.append(path)
    return found


def _named(file: Path, folder: Path) -> Iterator[Path]:
    """Files whose paths stand in `file`, comments included, and those of folders that do."""
    text = file.read_text(encoding="utf-8")
    for place in dict.fromkeys(_PATH.findall(text)):
        for base in (folder, file.parent):
            path = (base / place).resolve()
            if not path.is_relative_to(folder.resolve()):
                continue
            if path.is_dir():
                yield from _files(path)
            elif path.is_file():
                yield path


def _files(folder: Path) -> Iterator[Path]:
    return (path for path in sorted(folder.rglob("*")) if path.is_file())
