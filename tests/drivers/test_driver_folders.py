"""Each driver of ours stands in a folder with the same skeleton, and its page is of today."""

from __future__ import annotations

import importlib
from pathlib import Path

import pytest

from tools.driver_settings import DRIVERS, pages
from woz_tui.drivers.contract import Driver
from woz_tui.drivers.plugins import installed

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("name", sorted(pages()))
def test_every_driver_has_the_same_skeleton(name: str) -> None:
    driver = installed()[name]
    package = f"woz_drivers.{name.replace('-', '_')}"
    assert driver.__module__ == f"{package}.driver"
    assert driver.Settings.__module__ == f"{package}.settings"
    if driver.examine.__func__ is not Driver.examine.__func__:  # type: ignore[attr-defined]
        importlib.import_module(f"{package}.doctor")


def test_no_driver_stands_beside_its_folder() -> None:
    """A module beside the folders serves several drivers."""
    sources = {path: path.read_text(encoding="utf-8") for path in DRIVERS.rglob("*.py")}
    for module in DRIVERS.glob("[!_]*.py"):
        name = module.stem
        if name == "naoqi":
            continue  # the simulated Pepper by its former name
        wanted = (
            f"woz_drivers.{name} import",
            f"import {name}",
            f", {name}",
            f"woz_drivers.{name}\n",
        )
        users = {
            path.relative_to(DRIVERS).parts[0]
            for path, text in sources.items()
            if path != module and any(words in text for words in wanted)
        }
        assert len(users) > 1 or any(user.endswith(".py") for user in users), f"{name}: {users}"


@pytest.mark.parametrize("name", sorted(pages()))
def test_every_page_has_a_table_of_settings(name: str) -> None:
    text = pages()[name].read_text(encoding="utf-8")
    assert text.startswith("# ")
    assert f"Type `{name}`" in text
    assert "| setting | default | |" in text


@pytest.mark.parametrize("name", sorted(pages()))
def test_the_main_page_leads_to_every_driver(name: str) -> None:
    link = pages()[name].parent.relative_to(ROOT / "drivers")
    assert f"({link}/README.md)" in (ROOT / "drivers" / "README.md").read_text(encoding="utf-8")
