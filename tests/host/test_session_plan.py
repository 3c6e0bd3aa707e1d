from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import msgspec
import pytest

from tests.host.rig import served_session
from tests.session.rig import experiment
from woz_tui.features.profiles.section import PROFILES, Profile
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m


async def test_the_log_says_what_a_console_is_welcomed_with(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        peer = await host.connect()
        welcome = await peer.hello()
        (plan,) = (line for line in host.of(m.SessionPlan))
        told = msgspec.json.decode(codec.encode(plan))
        own = {"kind", "seq", "t", "ts", "settings", "simulated"}
        assert {name: value for name, value in told.items() if name not in own}.items() <= (
            welcome.items()
        )
        # What is true of one console alone is not in the log's plan.
        of_a_console = {"values": None, "driving": None}
        assert told["settings"] | of_a_console == welcome["settings"] | of_a_console
        assert plan.title == "Made by hand"


async def test_nobody_who_takes_part_is_in_it(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        (plan,) = (line for line in host.of(m.SessionPlan))
        assert plan.settings.values == {"place": "museum"}
        assert "P07" not in codec.encode(plan).decode()


async def test_no_home_folder_is_in_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", "/home/jane")
    made = replace(experiment(tmp_path), variables={"place": "/home/jane/museum.png"})
    async with served_session(tmp_path, made=made) as host:
        welcome = await (await host.connect()).hello()
        (plan,) = (line for line in host.of(m.SessionPlan))
        assert plan.settings.values == {"place": "~/museum.png"}
        assert "jane" not in codec.encode(plan).decode()
        assert welcome["settings"]["values"]["place"] == "/home/jane/museum.png"


async def test_it_is_said_again_when_panels_change(tmp_path: Path) -> None:
    child = Profile(frozenset({"Base"}), name="child")
    made = replace(experiment(tmp_path), sections={PROFILES: {"child": child}})
    async with served_session(tmp_path, made=made) as host:
        peer = await host.connect()
        await peer.hello()
        assert (await peer.ask("profile", profile="child"))["ok"]
        plans = host.of(m.SessionPlan)
        assert [plan.settings.profile for plan in plans] == ["", "child"]
        assert [line["profile"] for line in peer.seen if line["kind"] == "panels"] == ["child"]


async def test_a_newcomers_history_has_neither_files_nor_plan(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        peer = await host.connect()
        welcome = await peer.hello()
        told = {line["kind"] for line in [*welcome["state"], *welcome["recent"]]}
        assert "session.start" in told
        assert told.isdisjoint({"session.plan", "experiment.files"})
