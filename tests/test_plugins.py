"""Drivers are found by entry point, and what is wrong with one is said by name."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from woz_tui.drivers import plugins
from woz_tui.drivers.plugins import GROUP, PluginError, installed

Package = Callable[[str, str, str], None]

BUNDLED = {"simulated", "dynamixel", "rangefinder", "microphone", "speech"}

WHOLE = """
from dataclasses import dataclass
from woz_tui.drivers.contract import Driver

@dataclass(frozen=True)
class Nothing: ...

class Toy(Driver):
    Settings = Nothing
    summary = "a toy"
    async def perform(self, job): ...
    async def stop(self, scope): ...
"""


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Package]:
    """Installs a package with one module `<name>_module` and one entry point."""
    made: list[str] = []

    def install(name: str, point: str, source: str) -> None:
        module = f"{name}_module"
        made.append(module)
        (tmp_path / f"{module}.py").write_text(source)
        metadata = tmp_path / f"{name}-1.0.dist-info"
        metadata.mkdir()
        (metadata / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
        (metadata / "entry_points.txt").write_text(f"[{GROUP}]\n{point}\n")

    monkeypatch.syspath_prepend(str(tmp_path))
    yield install
    for module in made:
        sys.modules.pop(module, None)


def test_the_bundled_drivers_are_registered_and_load() -> None:
    catalogue = installed()
    assert set(catalogue) >= BUNDLED
    for name in BUNDLED:
        assert catalogue[name].summary


def test_a_strangers_driver_is_found_like_ours(package: Package) -> None:
    package("toys", "toy = toys_module:Toy", WHOLE)
    catalogue = installed()
    assert catalogue["toy"].summary == "a toy"
    assert catalogue["toy"] is catalogue["toy"]
    assert "jigsaw" not in catalogue
    assert list(catalogue) == sorted(catalogue)


def test_a_drivers_module_is_imported_only_when_it_is_asked_for(package: Package) -> None:
    package("toys", "toy = toys_module:Toy", WHOLE)
    catalogue = installed()
    assert "toy" in catalogue
    assert "toys_module" not in sys.modules
    assert catalogue["toy"].summary == "a toy"
    assert "toys_module" in sys.modules


def test_an_import_that_does_not_end_is_named(
    package: Package, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(plugins, "IMPORT_S", 0.05)
    package("toys", "toy = toys_module:Toy", "import time\ntime.sleep(1000)\n")
    with pytest.raises(PluginError, match=r"'toy' of toys .* its import takes longer than 0\.05 s"):
        installed()["toy"]


@pytest.mark.parametrize(
    ("point", "source", "complaint"),
    [
        ("toy = toys_module:Toy", "import no_such_library", "No module named 'no_such_library'"),
        (
            "toy = toys_module:Toy",
            "from woz_tui.core.driver import Driver",
            "import from woz_tui.drivers and woz_tui.protocol",
        ),
        ("toy = toys_module:Toy", "raise OSError('no bus')", "cannot be loaded: OSError: no bus"),
        ("toy = toys_module:Toyy", WHOLE, "cannot be loaded: AttributeError"),
        ("toy = toys_module", WHOLE, "is no class but <module 'toys_module'"),
        ("toy = toys_module:Toy", "class Toy: ...", "write class Toy(Driver)"),
        (
            "toy = toys_module:Toy",
            WHOLE.replace("    async def stop(self, scope): ...", "").replace(
                "    summary", "    other"
            ),
            "lacks stop, summary",
        ),
        (
            "toy = toys_module:Toy",
            WHOLE.replace("Settings = Nothing", "Settings = dict"),
            "has Settings that are no dataclass",
        ),
        (
            "toy = toys_module:Toy",
            f"{WHOLE}    @classmethod\n    def verbs(cls, settings): return ()\n",
            "what its class method verbs says is a field of the Offer",
        ),
    ],
)
def test_what_is_wrong_with_a_driver_is_said_by_package(
    package: Package, point: str, source: str, complaint: str
) -> None:
    package("toys", point, source)
    catalogue = installed()
    assert "toy" in catalogue
    with pytest.raises(PluginError) as caught:
        catalogue["toy"]
    assert str(caught.value).startswith("the driver 'toy' of toys")
    assert complaint in str(caught.value)


def test_two_packages_cannot_offer_the_same_name(package: Package) -> None:
    package("toys", "toy = toys_module:Toy", WHOLE)
    package("games", "toy = games_module:Toy", WHOLE)
    with pytest.raises(PluginError, match="two packages offer a driver called 'toy'") as caught:
        installed()
    assert "toys" in str(caught.value)
    assert "games" in str(caught.value)
