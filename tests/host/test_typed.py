"""Sentences that were typed become buttons."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from tests.host.rig import served

TYPED = {"verb": "say", "args": {"text": "Wait, {participant}"}, "source": "key", "key": "/"}


def typed(line: dict[str, Any]) -> list[dict[str, Any]]:
    """The panel's actions."""
    return [
        action
        for panel in line["panels"]
        if panel["title"] == "Typed"
        for action in panel["actions"]
    ]


async def test_a_typed_sentence_is_a_button_for_everybody_until_the_end(tmp_path: Path) -> None:
    async with served(tmp_path) as host:
        wizard = await host.connect()
        assert typed(await wizard.hello("wizard")) == []
        await wizard.say(kind="verb", ref=7, **TYPED)
        (button,) = typed(await wizard.kind("panels"))
        assert button["label"] == "Wait, {participant}"
        assert len(button["key"]) == 1
        for _ in range(2):
            assert (await wizard.ask("action", action=button["name"]))["ok"]
        late = await host.connect()
        assert typed(await late.hello("watcher")) == [button]


async def test_what_a_program_says_is_no_button(tmp_path: Path) -> None:
    async with served(tmp_path) as host:
        program = await host.connect()
        await program.hello("program")
        await program.ask("verb", verb="say", args={"text": "Hi"}, source="program")
        late = await host.connect()
        assert typed(await late.hello("watcher")) == []
