"""Which tests bear a mark such as `@pytest.mark.toolkit("R2", "L4")`.

They are read, not run, so this takes no time.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from tools import ROOT


@dataclass(frozen=True, slots=True, order=True)
class Shown:
    """A test and the statement that it shows."""

    statement: str
    file: str
    test: str


def found(mark: str, root: Path = ROOT) -> list[Shown]:
    """All tests below `root` with the mark, sorted."""
    return sorted({shown for file in _files(root) for shown in _in(file, mark, root)})


def by_statement(shown: list[Shown]) -> dict[str, dict[str, list[str]]]:
    """Tests by statement and by file."""
    tests: dict[str, dict[str, list[str]]] = {}
    for one in shown:
        tests.setdefault(one.statement, {}).setdefault(one.file, []).append(one.test)
    return tests


def cell(files: dict[str, list[str]]) -> str:
    """A statement's tests in one cell of a table of a page in `docs`."""
    if not files:
        return "**none**"
    return "<br>".join(f"[{Path(f).stem}](../../{f}): {_words(each)}" for f, each in files.items())


def _words(tests: list[str]) -> str:
    """Names of tests as sentences."""
    return "; ".join(test.removeprefix("test_").replace("_", " ") for test in tests)


def _files(root: Path) -> Iterator[Path]:
    for folder in ("tests", "drivers"):
        yield from sorted((root / folder).rglob("test_*.py"))


def _in(file: Path, mark: str, root: Path) -> Iterator[Shown]:
    """Marks on functions and classes, on their parameters, and those of the whole file."""
    text = file.read_text(encoding="utf-8")
    if f"mark.{mark}" not in text:
        return
    tree = ast.parse(text)
    whole = {
        name
        for node in tree.body
        if isinstance(node, ast.Assign)
        and any(isinstance(to, ast.Name) and to.id == "pytestmark" for to in node.targets)
        for name in _marks(node.value, mark)
    }
    yield from _tests(tree.body, whole, str(file.relative_to(root)), mark)


def _tests(body: list[ast.stmt], marks: set[str], file: str, mark: str) -> Iterator[Shown]:
    for node in body:
        if not isinstance(node, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            continue
        own = {name for decorator in node.decorator_list for name in _marks(decorator, mark)}
        if isinstance(node, ast.ClassDef):
            yield from _tests(node.body, marks | own, file, mark)
        elif node.name.startswith("test"):
            yield from (Shown(name, file, node.name) for name in marks | own)


def _marks(node: ast.AST, mark: str) -> Iterator[str]:
    for each in ast.walk(node):
        if (
            isinstance(each, ast.Call)
            and isinstance(each.func, ast.Attribute)
            and each.func.attr == mark
        ):
            for argument in each.args:
                if isinstance(argument, ast.Constant):
                    yield str(argument.value)
