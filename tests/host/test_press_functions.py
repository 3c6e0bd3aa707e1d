"""How many functions a press and a reading pass in the robot process."""

from __future__ import annotations

import asyncio

import pytest

from benchmarks.host_functions import MEASURED, PRESS, Measured, fewest


@pytest.mark.parametrize("measured", MEASURED, ids=[each.title for each in MEASURED])
def test_no_more_functions_than_allowed(measured: Measured) -> None:
    trace = asyncio.run(fewest(measured))
    assert trace.functions <= measured.most, trace.legs


def test_where_the_file_has_no_sections_a_press_passes_no_feature() -> None:
    legs = asyncio.run(fewest(PRESS)).legs
    assert [name for leg in legs.values() for name in leg if name.startswith("features/")] == []
