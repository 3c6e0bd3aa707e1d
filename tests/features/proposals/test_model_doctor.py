"""`woz doctor FILE` asks the model that the file names."""

from __future__ import annotations

import asyncio
from pathlib import Path

import pytest

from tests.config.reading import HELLO, panel, read_experiment
from tests.fakes.chat_server import chat_server
from woz_tui.drivers.contract import Finding
from woz_tui.features.proposals import doctor

pytestmark = pytest.mark.real_clock


def findings(folder: Path, url: str) -> list[Finding]:
    head = f"title: T\nrobot: simulated\nsuggest: {{model: {{url: '{url}', name: small}}}}\n"
    return list(doctor.CHECKS.of_file(read_experiment(folder, panel(HELLO, head=head))))


async def test_it_says_as_what_the_server_answers(tmp_path: Path) -> None:
    async with chat_server() as server:
        found = await asyncio.to_thread(findings, tmp_path, server.url)
        assert [each.level for each in found] == ["ok", "info"]
        assert found[0].text.startswith("answers as small-q4, version fp1, in 0.")
        assert " s (first word after 0." in found[0].text
        assert "small was asked for" in found[1].text
        assert [each["content"] for each in server.asked[0]["messages"]] == ["Say yes."]
        server.fault = "500"
        (wrong,) = await asyncio.to_thread(findings, tmp_path, server.url)
        assert (wrong.level, wrong.text) == ("warning", "the model's server refuses: 500")
        assert "WOZ_SUGGEST_KEY" in wrong.remedy


async def test_one_that_is_too_slow_twice_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(doctor, "LIMIT_S", 0.0)
    async with chat_server() as server:
        (slow,) = await asyncio.to_thread(findings, tmp_path, server.url)
        assert len(server.asked) == 2
    assert slow.level == "warning"
    assert "the first time, when it may have been loading, in 0." in slow.text
    assert "a smaller model" in slow.remedy


def test_a_file_without_a_model_asks_nobody(tmp_path: Path) -> None:
    assert list(doctor.CHECKS.of_file(read_experiment(tmp_path, panel(HELLO)))) == []
