"""Sentences that were typed become buttons."""

from __future__ import annotations

import contextlib
from collections.abc import AsyncIterator
from functools import partial
from pathlib import Path
from typing import Any

from tests.config.catalogue import CATALOGUE
from tests.host.rig import ServedSession, served_session
from woz_tui.config.loading import load
from woz_tui.protocol.messages import Notice


def typing(text: str) -> dict[str, Any]:
    """What the console asks for behind `/`."""
    return {"verb": "say", "args": {"text": text}, "source": "key", "key": "/"}


TYPED = typing("Wait, {participant}")


def typed_actions(line: dict[str, Any]) -> list[dict[str, Any]]:
    """The panel's actions."""
    return [
        action
        for panel in line["panels"]
        if panel["title"] == "Typed"
        for action in panel["actions"]
    ]


async def test_a_typed_sentence_is_a_button_for_everybody_until_the_end(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        wizard = await host.connect()
        assert typed_actions(await wizard.hello("wizard")) == []
        await wizard.say(kind="verb", ref=7, **TYPED)
        (button,) = typed_actions(await wizard.kind("panels"))
        assert button["label"] == "Wait, {participant}"
        assert len(button["key"]) == 1
        for _ in range(2):
            assert (await wizard.ask("action", action=button["name"]))["ok"]
        late = await host.connect()
        assert typed_actions(await late.hello("watcher")) == [button]


async def test_what_a_program_says_is_no_button(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        program = await host.connect()
        await program.hello("program")
        await program.ask("verb", verb="say", args={"text": "Hi"}, source="program")
        late = await host.connect()
        assert typed_actions(await late.hello("watcher")) == []


TALK = """title: Talk
robot: simulated  # no robot
panels:
  - title: Speech
    actions:
      - {key: h, label: Hello, say: "Hello"}
"""


def files(folder: Path) -> list[str]:
    """The experiment files that lie there."""
    return [path.name for path in folder.glob("*.yaml")]


@contextlib.asynccontextmanager
async def talking(folder: Path, text: str = TALK) -> AsyncIterator[tuple[ServedSession, Path]]:
    """A session of a file that lies there."""
    path = folder / "talk.yaml"
    path.write_text(text)
    read = partial(load, path, CATALOGUE)
    async with served_session(
        folder, load=read, made=read(), catalogue=CATALOGUE, read=read
    ) as host:
        yield host, path


async def test_a_copy_is_shown_then_written_and_offered_once(tmp_path: Path) -> None:
    async with talking(tmp_path) as (host, path):
        wizard = await host.connect()
        await wizard.hello("wizard")
        nothing = await wizard.ask("keep-typed")
        assert (nothing["ok"], nothing["data"]["sentences"]) == (True, 0)
        for text in ("One moment", "Was: #1?", "One moment"):
            assert (await wizard.ask("verb", **typing(text)))["ok"]
        shown = (await wizard.ask("keep-typed", dry_run=True))["data"]
        assert shown["sentences"] == 2
        assert not shown["written"]
        assert shown["diff"][0] == "--- talk.yaml"
        assert all(line.startswith("+") for line in shown["diff"][3:])
        assert files(tmp_path) == [path.name]
        kept = (await wizard.ask("keep-typed"))["data"]
        assert (kept["written"], kept["file"]) == (True, str(tmp_path / "talk-typed.yaml"))
        assert 'say: "Was: #1?"' in (tmp_path / "talk-typed.yaml").read_text()
        assert path.read_text() == TALK
        again = (await wizard.ask("keep-typed"))["data"]
        assert (again["sentences"], again["file"]) == (0, kept["file"])
        notice = await host.published(lambda line: isinstance(line, Notice))
        assert isinstance(notice, Notice)
        assert "talk-typed.yaml" in notice.text


async def test_a_file_that_is_wrong_by_now_gets_no_copy(tmp_path: Path) -> None:
    async with talking(tmp_path) as (host, path):
        wizard = await host.connect()
        await wizard.hello("wizard")
        await wizard.ask("verb", **typing("One moment"))
        path.write_text(f"{TALK}scripts: [Hello]\n")
        reply = await wizard.ask("keep-typed")
        assert not reply["ok"]
        assert "scripts" in reply["data"][0]
        path.unlink()
        gone = await wizard.ask("keep-typed", dry_run=True)
        assert "cannot be read" in gone["reason"]
        assert files(tmp_path) == []


async def test_a_copy_is_the_next_sessions_file_with_one_panel(tmp_path: Path) -> None:
    async with talking(tmp_path) as (host, _):
        wizard = await host.connect()
        await wizard.hello("wizard")
        await wizard.ask("verb", **typing("One moment"))
        copy = Path((await wizard.ask("keep-typed"))["data"]["file"])
    second = tmp_path / "second"
    second.mkdir()
    read = partial(load, copy, CATALOGUE)
    async with served_session(
        second, load=read, made=read(), catalogue=CATALOGUE, read=read
    ) as host:
        wizard = await host.connect()
        assert [each["label"] for each in typed_actions(await wizard.hello("wizard"))] == [
            "One moment"
        ]
        await wizard.say(kind="verb", ref=7, **typing("One moment"))
        await wizard.say(kind="verb", ref=8, **typing("And now"))
        panels = await wizard.kind("panels")
        assert [each["label"] for each in typed_actions(panels)] == ["One moment", "And now"]
        assert [panel["title"] for panel in panels["panels"]] == ["Speech", "Typed"]
        assert (await wizard.ask("reload", dry_run=True))["data"] == []


async def test_who_only_watches_writes_no_file(tmp_path: Path) -> None:
    async with talking(tmp_path) as (host, _):
        watcher = await host.connect()
        await watcher.hello("watcher")
        assert not (await watcher.ask("keep-typed"))["ok"]


async def test_a_blind_wizard_reads_her_own_words_and_none_of_the_file(tmp_path: Path) -> None:
    blind = "conditions: [krill, plain]\ndesign: {order: fixed, blind: {krill: A, plain: B}}\n"
    async with talking(tmp_path, TALK + blind) as (host, path):
        wizard = await host.connect()
        await wizard.hello("wizard")
        await wizard.ask("verb", **typing("One moment"))
        shown = await wizard.ask("keep-typed", dry_run=True)
        assert "One moment" in str(shown["data"])
        assert "krill" not in str(shown)
        path.write_text(TALK + blind + "krills: [krill]\n")
        refused = await wizard.ask("keep-typed")
        assert not refused["ok"]
        assert "krill" not in str(refused)
