"""Settings for all tests."""

from __future__ import annotations

import gc
import os
import re
from collections.abc import Generator, Iterator

import pytest
from hypothesis import HealthCheck, settings

from tests.example_counts import EXAMPLES
from woz_tui.feature import features
from woz_tui.system.user_folders import SEEN, WIZARD
from woz_tui.testing import contract_checks

# Machines are shared and slow: how long an example took says nothing about the code.
settings.register_profile(
    "shared", deadline=None, suppress_health_check=[HealthCheck.too_slow], print_blob=True
)
# The same examples in every run, so that a change is judged by what it changed.
settings.register_profile(
    "repeatable", settings.get_profile("shared"), derandomize=True, max_examples=30
)
# `make fuzz`: other examples each time, and many more.
settings.register_profile("fuzz", settings.get_profile("shared"), max_examples=EXAMPLES)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "repeatable"))


# Looking for garbage took a sixth of the time. While tests are collected there is none.
gc.set_threshold(20_000, 20, 20)
gc.disable()


@pytest.hookimpl(trylast=True)
def pytest_collection_finish() -> None:
    """Thousands of collected tests live to the end: nobody looks for garbage among them, which
    would make every thread of a test wait.
    """
    gc.freeze()
    gc.enable()


#: What Python says where a module lacks that a feature, or its tests, would have.
_NO_FEATURE = re.compile(r"No module named '(?:woz_tui|tests)\.features\.(\w+)")


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(
    collector: pytest.Collector,
) -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    """Tests that need a feature which was taken out of the list are left out, and named: those of
    it, of features that use it, and those that go through all of a session or report.
    """
    report = yield
    lacks = _NO_FEATURE.search(str(report.longrepr)) if report.failed else None
    if lacks is not None and lacks[1] not in features():
        report.outcome = "skipped"
        report.longrepr = (str(collector.path), 0, f"Skipped: there is no feature {lacks[1]}")
    return report


@pytest.fixture(autouse=True, scope="session")
def patient_contract() -> Iterator[None]:
    """Drivers are examined beside tests that keep the cores busy: what takes longer than this
    waits for something that does not come.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("WOZ_CONTRACT_PATIENCE", "8")  # also for whoever examines in another process
        for limit in ("PROMPT_S", "LAG_S"):
            patch.setattr(contract_checks, limit, 8 * getattr(contract_checks, limit))
        for limit in ("NOTICE_S", "EXAMINE_S", "CLOSE_S"):
            patch.setattr(contract_checks, limit, 4 * getattr(contract_checks, limit))
        yield


@pytest.fixture(autouse=True, scope="session")
def state_of_its_own(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """A log that moves on to the second place does not land among its user's; nor does what the
    console remembers.
    """
    with pytest.MonkeyPatch.context() as patch:
        state = tmp_path_factory.mktemp("state")
        (state / SEEN).parent.mkdir(parents=True)
        (state / SEEN).touch()  # nobody's first start
        (state / WIZARD).touch()  # and nobody is asked who plays
        patch.setenv("XDG_STATE_HOME", str(state))
        patch.setenv("WOZ_SILENT", "1")  # demos
        if (everything := os.environ.get("LC_ALL")) is not None:
            patch.setenv("LC_CTYPE", everything)
            patch.delenv("LC_ALL")
        patch.setenv("LC_MESSAGES", "C")  # in English
        patch.setenv("XDG_CONFIG_HOME", str(tmp_path_factory.mktemp("config")))
        patch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        yield
