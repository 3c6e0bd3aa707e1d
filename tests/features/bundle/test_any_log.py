"""Bundles of any log: they are valid, and no name that somebody said is in any byte."""

from __future__ import annotations

import gzip
import tempfile
from collections.abc import Sequence
from pathlib import Path

import frictionless
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.example_counts import many
from tests.export.logs import Timed, courses, write
from tests.features.bundle.deposited import NAME, bundled, course_of

pytestmark = pytest.mark.safety

#: No word of any file is so long and made of these alone.
NAMES = st.text(st.sampled_from("qxzäßéøñłж"), min_size=6, max_size=9)


@settings(max_examples=many(8), deadline=None)
@given(courses())
def test_tables_of_any_log_are_valid(course: Sequence[Timed]) -> None:
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        write(folder / "recordings", course)
        bundled(folder / "recordings", folder / "osf", recode=True)
        report = frictionless.Package(str(folder / "osf" / "datapackage.json")).validate()
        assert report.flatten(["rowNumber", "fieldName", "type", "message"]) == []


@settings(max_examples=many(5), deadline=None)
@given(NAMES)
def test_a_name_that_was_said_is_in_no_byte(name: str) -> None:
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        log = write(folder / "recordings", course_of("P01"))
        said = log.read_bytes()
        assert said.count(NAME.encode()) > 8
        log.write_bytes(said.replace(NAME.encode(), name.encode()))
        bundled(folder / "recordings", folder / "osf", recode=True)
        for path in (folder / "osf").rglob("*"):
            assert name not in path.name
            if path.is_file():
                data = path.read_bytes()
                data = gzip.decompress(data) if path.suffix == ".gz" else data
                assert name.encode() not in data, path.name
