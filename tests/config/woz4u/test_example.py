"""The example in `experiments/woz4u`: a whole file, as people have them."""

from __future__ import annotations

from pathlib import Path

import yaml

from tests.config.woz4u.reading import CATALOGUE, converted_text, essence, keys, settings, titles
from woz_tui.config.loading import load
from woz_tui.config.woz4u import woz4u_keys

FOLDER = Path(__file__).parents[3] / "experiments" / "woz4u"


def test_it_opens_without_a_warning() -> None:
    experiment = load(FOLDER / "config.yaml", CATALOGUE)
    assert experiment.warnings == ()
    assert len(titles(experiment)) == 9
    assert keys(experiment)["Floor plan"] == "ctrl+shift+2"
    assert settings(experiment).robots == ("simulated",)


def test_it_has_every_key_of_the_format() -> None:
    data = yaml.safe_load((FOLDER / "config.yaml").read_text(encoding="utf-8"))
    assert data.keys() == set(woz4u_keys.TOP_LEVEL)
    assert data["autonomous_life_config"].keys() == set(woz4u_keys.AUTONOMY)
    unsaid = {"tablet_items": {"tooltip"}, "audio_files": {"tooltip"}, "colors": {"tooltip"}}
    for section, fields in woz4u_keys.ITEMS.items():
        said = {name for item in data[section] for name in item}
        assert said == set(fields) - unsaid.get(section, set())


def test_the_page_has_a_row_for_every_key() -> None:
    page = (FOLDER.parents[1] / "docs" / "how-to" / "woz4u.md").read_text(encoding="utf-8")
    table = page.partition("## How each key is converted")[2].partition("## ")[0]
    rows = [line.split("|")[1] for line in table.splitlines() if line.startswith("| `")]
    fields = {"title", "tooltip", "key_comb", "is_default", "is_default_img"}
    for key in {*woz4u_keys.TOP_LEVEL, *woz4u_keys.AUTONOMY, *fields}:
        assert sum(f"`{key}`" in row for row in rows) == 1, key


def test_its_conversion_is_the_same(tmp_path: Path) -> None:
    for folder in ("pictures", "texts"):
        (tmp_path / folder).symlink_to(FOLDER / folder)
    visit = tmp_path / "visit.yaml"
    visit.write_text(converted_text(FOLDER / "config.yaml"), encoding="utf-8")
    experiment = load(visit, CATALOGUE)
    assert essence(experiment) == essence(load(FOLDER / "config.yaml", CATALOGUE))
    assert experiment.warnings == ()
