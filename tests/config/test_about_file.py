"""`about.yaml`: what no log knows, read with places and remedies."""

from __future__ import annotations

import re
from datetime import date
from pathlib import Path

import pytest

from woz_tui.config.about_file import NOTHING, About, AuthorEntry, last_day, missing_in, read_about
from woz_tui.config.annotated_decoder import names_of
from woz_tui.config.file_position import ExperimentError

GUIDE = Path(__file__).parents[2] / "docs" / "how-to" / "bundle.md"


def written(folder: Path, text: str) -> Path:
    path = folder / "about.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def test_the_guides_example_has_every_key(tmp_path: Path) -> None:
    [example] = re.findall(r"```yaml\n(title:.*?)```", GUIDE.read_text(encoding="utf-8"), re.DOTALL)
    found = read_about(written(tmp_path, example))
    assert found.authors == (
        AuthorEntry("Ada Example", "0000-0002-1825-0097", "University of Examples"),
    )
    assert found.retention.logs == "10 y"
    assert missing_in(found) == []
    assert {name for name in names_of(About) if f"\n{name}:" not in f"\n{example}"} == set()


def test_everything_that_is_wrong_has_its_place_and_remedy(tmp_path: Path) -> None:
    path = written(
        tmp_path,
        "titel: x\nauthors: [{orcid: 12}]\nretention: {media: soon}\nshare: [names]\n"
        "suspicion: person\n",
    )
    with pytest.raises(ExperimentError) as raised:
        read_about(path)
    assert [str(problem).removeprefix(f"{path}:") for problem in raised.value.problems] == [
        "1:1: titel: unknown; did you mean 'title'?",
        "2:11: authors[0].name: is missing (given name and family name, in this order)",
        "2:12: authors[0].orcid: expected an ORCID such as 0000-0002-1825-0097, not '12'",
        "3:13: retention.media: expected a number of days, weeks or years: 30 d, 6 w, 10 y, not"
        " 'soon'",
        "4:9: share[0]: 'names' is not known; it can be: media, transcripts",
        "5:1: suspicion: expected a questionnaire and its item, such as end.person, not 'person'",
    ]


def test_what_is_not_said_is_listed_with_what_it_is_for() -> None:
    missing = dict(missing_in(NOTHING))
    assert missing["licence"] == "licence of the data, by its SPDX name"
    assert not missing.keys() & {"retention", "share"}
    assert "title" not in dict(missing_in(About(title="Warm")))


def test_how_long_something_is_kept() -> None:
    day = date(2026, 3, 1)
    assert last_day(day, "30 d") == date(2026, 3, 31)
    assert last_day(day, "2w") == date(2026, 3, 15)
    assert last_day(day, "10 y") == date(2036, 2, 29)
    with pytest.raises(ValueError, match="no time"):
        last_day(day, "soon")
