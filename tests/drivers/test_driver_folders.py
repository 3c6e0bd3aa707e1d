"""Each driver of ours stands in a folder with the same skeleton, and its page is of today."""

from __future__ import annotations

import importlib
import re
from pathlib import Path

import pytest

from tools.driver_settings import DRIVERS, pages
from woz_tui.drivers.contract import Driver
from woz_tui.drivers.plugins import installed

ROOT = Path(__file__).parents[2]
#: Folders of what several drivers use.
SHARED = {"lines", "panels", "pictures", "programs", "sound"}


@pytest.mark.parametrize("name", sorted(pages()))
def test_every_driver_has_the_same_skeleton(name: str) -> None:
    driver = installed()[name]
    package = f"woz_drivers.{name.replace('-', '_')}"
    assert driver.__module__ == f"{package}.driver"
    assert driver.Settings.__module__ == f"{package}.settings"
    if driver.examine.__func__ is not Driver.examine.__func__:  # type: ignore[attr-defined]
        importlib.import_module(f"{package}.doctor")


def test_no_module_of_one_driver_stands_outside_its_folder() -> None:
    # The simulated Pepper can be started by its former name.
    assert {path.name for path in DRIVERS.glob("*.py")} == {"__init__.py", "naoqi.py"}
    sources = {path: path.read_text(encoding="utf-8") for path in DRIVERS.rglob("*.py")}
    for module in (path for folder in SHARED for path in (DRIVERS / folder).glob("[!_]*.py")):
        package, name = f"woz_drivers.{module.parent.name}", module.stem
        wanted = re.compile(rf"from {package}\.{name} import|from {package} import .*\b{name}\b")
        users = {path.parent.name for path, text in sources.items() if wanted.search(text)}
        assert len(users) > 1 or users & SHARED, f"{name}: {users}"


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
