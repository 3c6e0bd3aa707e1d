"""What keeps the rooms apart, checked from outside."""

from __future__ import annotations

import ast
import importlib
import re
import subprocess
import sys
from collections.abc import Iterable, Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

from woz_tui.features import FEATURES

ROOT = Path(__file__).parents[1]
SOURCES = sorted(
    path
    for folder in ("woz_tui", "drivers", "tests", "benchmarks", ".ci", "tools")
    for path in (ROOT / folder).rglob("*.py")
)
ROOMS = [
    "woz_tui.system",
    "woz_tui.protocol",
    "woz_tui.drivers",
    "woz_tui.features",
    "woz_tui.machine",
    "woz_tui.network",
    "woz_tui.config",
    "woz_tui.bridge",
    "woz_tui.gate",
    "woz_tui.bus",
    "woz_tui.sensing",
    "woz_tui.motion",
    "woz_tui.testing",
    "woz_tui.log",
    "woz_tui.timeline",
    "woz_tui.analysis",
    "woz_tui.export",
    "woz_tui.withdrawal",
    "woz_tui.session",
    "woz_tui.remote",
    "woz_tui.replay",
    "woz_tui.host",
    "woz_tui.console",
    "woz_tui.cli",
    "woz_tui.client",
    "woz_drivers",
    "qimessaging",
    "naoqi_simulator",
    "robot_simulators",
]
#: Top folders whose modules are asked for circles.
PACKAGES = ("woz_tui", "drivers")
VAGUE = re.compile(r"(^|_)(utils?|helpers?|misc|common|stuff)(_|$)")

#: Loading the left side must not load the right side.
UNLOADED = [
    (
        "woz_tui.host.robot_process",
        {
            *("textual", "rich", "numpy", "serial", "dynamixel_sdk", "aiohttp", "woz_drivers"),
            *("woz_tui.replay", "woz_tui.features.training.trainer", "woz_tui.analysis"),
            *("woz_tui.config.woz4u", "woz_tui.network.driver_process"),
            *("woz_tui.session.preflight", "pickle", "pylsl", "woz_tui.features.lsl.library"),
        },
    ),
    ("woz_tui.cli", {"textual", "rich", "numpy", "serial", "msgspec", "woz_drivers"}),
    (
        "woz_tui.console.app",
        {
            *("numpy", "serial", "dynamixel_sdk", "woz_drivers", "woz_tui.host", "woz_tui.bus"),
            *("woz_tui.config.experiment", "woz_tui.session.action_runner"),
            *("woz_tui.drivers.contract", "yaml", "xml"),
        },
    ),
    ("woz_tui.drivers.plugins", {"textual", "numpy", "serial", "woz_drivers"}),
    ("woz_tui.client.blocking", {"textual", "numpy", "yaml", "woz_drivers", "woz_tui.drivers"}),
]


#: What loads all that a start needs up to its first paint, or its first line; and how many modules
#: come with it at the most, beyond those of a bare Textual app. Each costs a wizard who waits.
STARTS = {
    "console": ("woz_tui.cli.run as run; run.console_start.load_modules()", 196),
    "robot process": ("woz_tui.host.robot_process", 297),
}


#: Modules of a feature that a start loads at the most: its descriptor and its pieces for there.
MODULES_OF_A_FEATURE = 6


def modules_after(code: str) -> set[str]:
    """All that is loaded behind this code, in a Python of its own."""
    done = subprocess.run(
        [sys.executable, "-c", f"{code}\nimport sys; print(*sys.modules)"],
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    )
    return set(done.stdout.split())


@pytest.mark.parametrize("name", STARTS)
def test_a_start_loads_few_modules(name: str) -> None:
    start, most = STARTS[name]
    bare = modules_after("import textual.app, textual.widgets._static")
    assert len(bare) > 300
    own = sorted(modules_after(f"import {start}") - bare)
    of_features = [each for each in own if each.startswith("woz_tui.features")]
    assert len(own) - len(of_features) <= most, own
    assert len(of_features) <= 1 + MODULES_OF_A_FEATURE * len(FEATURES), of_features


@pytest.mark.parametrize(("module", "unwanted"), UNLOADED, ids=[name for name, _ in UNLOADED])
def test_loading_a_room_loads_only_what_it_needs(module: str, unwanted: set[str]) -> None:
    code = f"import sys, {module}\nprint(*sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode == 0, done.stderr
    assert not unwanted & set(done.stdout.split())


def test_the_import_rules_are_kept() -> None:
    done = subprocess.run(
        [str(Path(sys.executable).with_name("lint-imports")), "--no-cache"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=100,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("room", ROOMS)
def test_every_room_says_what_it_is_for(room: str) -> None:
    assert (importlib.import_module(room).__doc__ or "").strip()


def test_every_room_is_known_here() -> None:
    found = {f"woz_tui.{path.parent.name}" for path in (ROOT / "woz_tui").glob("*/__init__.py")} | {
        path.parent.name for path in (ROOT / "drivers").glob("*/__init__.py")
    }
    assert found == set(ROOMS)


def test_no_name_that_could_stand_for_anything() -> None:
    vague = [
        str(path.relative_to(ROOT))
        for path in SOURCES
        if any(VAGUE.search(part) for part in (*path.relative_to(ROOT).parent.parts, path.stem))
    ]
    assert vague == []


def test_our_own_classes_are_never_mocked() -> None:
    mocking = [
        str(path.relative_to(ROOT))
        for path in SOURCES
        if "mock" in (text := path.read_text())
        and any(name.startswith(("unittest.mock", "mock")) for name in _imported(ast.parse(text)))
    ]
    assert mocking == []


def test_make_fuzz_tries_more_of_every_property() -> None:
    """A number that a test writes itself goes before the profile's; `many` knows both."""
    fixed = [
        str(path.relative_to(ROOT))
        for path in SOURCES
        if path.name.startswith("test_") and re.search(r"max_examples=\d", path.read_text())
    ]
    assert fixed == []


def test_no_modules_import_each_other_in_a_circle() -> None:
    """Also not for types alone: who reads one of them would have to read all."""
    files = {_module(path): path for path in SOURCES if path.parts[len(ROOT.parts)] in PACKAGES}
    graph = {name: set(_imports(name, path, files)) - {name} for name, path in files.items()}
    assert len(graph) > 500
    TopologicalSorter(graph).prepare()  # a CycleError names who imports each other
    # It would be seen: a module that the bus imports is given an import of the bus.
    assert "woz_tui.bus.lane" in graph["woz_tui.bus.bus"]
    graph["woz_tui.bus.lane"].add("woz_tui.bus.bus")
    with pytest.raises(CycleError):
        TopologicalSorter(graph).prepare()


#: `from SOURCE import NAMES`, over several lines too, or `import NAMES`.
IMPORT = re.compile(
    r"^ *(?:from ([\w.]+) import (\([^)]*\)|[^(\n]*)|import ([\w., ]+))", re.MULTILINE
)


def _module(path: Path) -> str:
    top = path.parent
    while (top / "__init__.py").exists():
        top = top.parent
    return ".".join(path.relative_to(top).with_suffix("").parts).removesuffix(".__init__")


def _imports(name: str, path: Path, known: Iterable[str]) -> Iterator[str]:
    """Modules of ours that a file imports anywhere in it."""
    for source, names, whole in IMPORT.findall(path.read_text()):
        assert not source.startswith("."), f"{name} imports relatively"
        yield from (each for each in re.findall(r"[\w.]+", whole) if each in known)
        for each in re.findall(r"\w+", re.sub(r" as \w+|#.*", "", names)):
            inner = f"{source}.{each}"
            yield inner if inner in known else source


def _imported(tree: ast.Module) -> list[str]:
    names: list[str] = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            names += [f"{node.module}.{alias.name}" for alias in node.names]
    return names
