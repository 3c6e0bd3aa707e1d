"""The script over the socket, by whom it is asked for."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.host.rig import served_session
from tests.host.test_held_driving import Wizard, played
from tests.host.test_several_wizards import experiment_with_parts, wizard
from tests.session.rig import with_script
from woz_tui.features.scripts.kinds import AskScript, ScriptMoved
from woz_tui.protocol import messages as m


async def test_a_client_is_welcomed_with_it_and_plays_it(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        peer = await host.connect()
        assert (await peer.hello())["script"] == ["Hello", "Welcome"]
        (plan,) = host.of(m.SessionPlan)
        assert plan.script == ["Hello", "Welcome"]
        run = (await peer.ask("script"))["run"]
        assert (await peer.ask("cancel", run=run))["ok"]


async def test_a_line_of_the_script_is_played_by_whose_it_is(tmp_path: Path) -> None:
    made = with_script(experiment_with_parts(tmp_path), "Go", "Hello")
    async with served_session(tmp_path, made=made) as host:
        voice, body = await wizard(host, "voice"), await wizard(host, "body")
        assert "body (con2)" in (await voice.ask("script"))["reason"]
        assert not any(isinstance(line, ScriptMoved) for line in host.lines), "it has not halted"
        assert (await body.ask("script"))["run"]
        assert (await voice.ask("script"))["ok"]


@pytest.mark.safety
def test_a_line_that_drives_is_held_by_no_key_and_says_so(tmp_path: Path) -> None:
    async def scenario(wizard: Wizard) -> None:
        wizard.session.adopt(with_script(wizard.session.experiment, "Go"), ["script"])
        wizard.ask(AskScript(key="space"))

    wizard = played(tmp_path, scenario)
    [refused] = wizard.of(m.Refused)
    assert refused.code == "unwatched"
    assert "driving: pressed" in refused.remedy
    assert wizard.drives() == 0
