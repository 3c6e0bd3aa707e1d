"""What a program only proposes: it happens when the wizard takes it, and else does not."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from tests.host.rig import Peer, ServedSession, served_session
from tests.session.rig import WAIT_S, experiment
from woz_tui.client import WozClient, WozConnectionError, WozRefusedError, connect
from woz_tui.client.tools import ToolCaller
from woz_tui.config.experiment import Experiment
from woz_tui.features.proposals.clean_text import texts_of, without_variables
from woz_tui.features.proposals.history import ProposalHistory, SuggestionEpisode
from woz_tui.features.proposals.kinds import (
    SuggestGone,
    SuggestOffered,
    SuggestShown,
    SuggestTaken,
)
from woz_tui.features.proposals.rights import ONLY_PROPOSES, ProgramRights
from woz_tui.features.proposals.section import PROPOSALS, Proposals, SuggestKeysOfFile
from woz_tui.features.study.design import Design
from woz_tui.features.study.section import DESIGN
from woz_tui.protocol import messages as m
from woz_tui.protocol.requests import AskLock, AskRelease, AskVerb

pytestmark = pytest.mark.real_clock


def with_proposals(
    folder: Path, rights: ProgramRights = ONLY_PROPOSES, within: float = 10.0
) -> Experiment:
    section = Proposals(SuggestKeysOfFile(within=within), {"mcp": rights})
    made = experiment(folder)
    return replace(made, sections={**made.sections, PROPOSALS: section})


class Scene:
    """A session with a wizard and an assistant who only proposes."""

    def __init__(self, host: ServedSession, wizard: Peer, client: WozClient) -> None:
        self.host, self.wizard, self.client = host, wizard, client
        self.tools = ToolCaller(client)

    def asks(self, text: str) -> asyncio.Task[Any]:
        return asyncio.create_task(self.tools.call("say", {"text": text}))

    async def offered(self) -> dict[str, Any]:
        return await self.wizard.kind("suggest.offered")

    async def take(self, offered: dict[str, Any], **more: Any) -> dict[str, Any]:
        """Press the key as often as it takes: one that has only just come is not taken."""
        item = offered["items"][0]["id"]
        async with asyncio.timeout(WAIT_S):
            while True:
                reply = await self.wizard.ask("take", set=offered["set"], item=item, **more)
                if reply["ok"] or "only just come" not in reply.get("reason", ""):
                    return reply

    @property
    def said(self) -> list[object]:
        return [args["text"] for verb, args in self.host.driver().calls if verb == "say"]

    def ends(self) -> list[str]:
        """How sets ended, in words of the log."""
        ends: dict[type[m.Message], str] = {SuggestTaken: "how", SuggestGone: "how"}
        return [getattr(line, ends[type(line)]) for line in self.host.of(*ends)]


@asynccontextmanager
async def scene(tmp_path: Path, **more: Any) -> AsyncIterator[Scene]:
    async with served_session(tmp_path, made=with_proposals(tmp_path, **more)) as host:
        wizard = await host.connect()
        await wizard.hello("wizard")
        async with connect(host.path, name="mcp", sees="wizard") as client:
            yield Scene(host, wizard, client)
        await host.until(lambda: not host.session.state.history(ProposalHistory).sets)
        offered = [line.set for line in host.of(SuggestOffered)]
        taken = [line.set for line in host.of(SuggestTaken)]
        gone = [line.set for line in host.of(SuggestGone)]
        assert sorted(offered) == sorted(taken + gone), "each set ends exactly once"


async def test_what_the_wizard_approves_is_said_and_the_log_knows_whence(tmp_path: Path) -> None:
    async with scene(tmp_path) as it:
        asked = it.asks("It is a whale")
        offered = await it.offered()
        assert (offered["who"], offered["approval"]) == ("mcp", True)
        assert offered["items"][0]["text"] == "It is a whale"
        assert it.said == []
        reply = await it.take(offered, key="f6")
        assert reply["ok"], reply
        assert (await asked)["done"]
        assert it.said == ["It is a whale"]
        (taken,), (command,) = it.host.of(SuggestTaken), it.host.of(m.Command)
        assert (taken.how, taken.run) == ("key", command.command)
        assert command.source == "program"


async def test_the_assistant_reads_what_was_said_in_place_of_its_sentence(tmp_path: Path) -> None:
    async with scene(tmp_path) as it:
        asked = it.asks("It is a wale")
        assert (await it.take(await it.offered(), text="It is a whale"))["ok"]
        assert (await asked)["sent"]["text"] == "It is a whale"
        assert it.said == ["It is a whale"]
        assert it.host.of(SuggestTaken)[0].text == "It is a whale"


async def test_what_the_wizard_reads_is_what_is_said(tmp_path: Path) -> None:
    """Braces of a program are no variables: nobody has seen what they would stand for."""
    async with scene(tmp_path) as it:
        asked = it.asks("You are in {condition}")
        offered = await it.offered()
        assert offered["items"][0]["text"] == "You are in {condition}"
        assert (await it.take(offered))["ok"]
        await asked
        assert it.said == ["You are in {condition}"]


async def test_the_wizard_gets_all_that_matters_of_it(tmp_path: Path) -> None:
    async with scene(tmp_path) as it:
        said = it.client.say("Watch out", driver="robot", when_busy="replace")
        asked = asyncio.create_task(said)
        (item,) = (await it.offered())["items"]
        assert (item["on"], item["when_busy"]) == ("robot", "replace")
        await it.wizard.ask("dismiss", set="s00001")
        await asyncio.gather(asked, return_exceptions=True)


async def test_when_it_stood_on_a_screen_is_in_the_log(tmp_path: Path) -> None:
    async with scene(tmp_path) as it:
        asked = it.asks("Hello")
        name = (await it.offered())["set"]
        for items in (["1"], ["1", "2"]):
            assert (await it.wizard.ask("shown", set=name, items=items))["ok"]
        await it.take({"set": name, "items": [{"id": "1"}]})
        await asked
        assert (await it.wizard.ask("shown", set=name, items=["1"]))["ok"], "it has just gone"
        assert [(line.set, line.items) for line in it.host.of(SuggestShown)] == [(name, ["1"])]
        watcher = await it.host.connect()
        await watcher.hello("watcher")
        assert not (await watcher.ask("shown", set=name, items=["1"]))["ok"]


def test_braces_of_a_list_are_no_variables_either() -> None:
    """Variables are filled in at any depth of an argument."""
    assert without_variables({"a": ["{x}", 1, {"b": "{y}"}]}) == {"a": ["{{x}}", 1, {"b": "{{y}}"}]}
    assert [*texts_of({"a": ["x", 1, {"b": "y"}]})] == ["a", "x", "b", "y"]


async def test_it_is_declined_in_words(tmp_path: Path) -> None:
    async with scene(tmp_path) as it:
        asked = it.asks("Go away")
        offered = await it.offered()
        assert (await it.wizard.ask("dismiss", set=offered["set"]))["ok"]
        with pytest.raises(WozRefusedError, match="not said: the wizard declined it"):
            await asked
        late = await it.take(offered)
        assert "has gone" in late["reason"]
        assert (it.said, it.ends()) == ([], ["dismissed"])


async def test_silence_is_no(tmp_path: Path) -> None:
    async with scene(tmp_path, within=0.2) as it:
        with pytest.raises(WozRefusedError, match=r"not said: nobody approved it within 0.2 s"):
            await it.asks("Hello?")
        assert (it.said, it.ends()) == ([], ["expired"])


async def test_the_stop_voids_it(tmp_path: Path) -> None:
    async with scene(tmp_path) as it:
        asked = it.asks("On we go")
        offered = await it.offered()
        await it.wizard.say(kind="stop", ref=5)
        with pytest.raises(WozRefusedError, match="not said: the stop was pressed"):
            await asked
        await it.wizard.ask("release")
        assert "has gone" in (await it.take(offered))["reason"]
        assert (it.said, it.ends()) == ([], ["stop"])


async def test_a_call_that_is_cancelled_is_withdrawn(tmp_path: Path) -> None:
    async with scene(tmp_path) as it:
        asked = it.asks("Never mind")
        await it.offered()
        asked.cancel()
        gone = await it.wizard.kind("suggest.gone")
        assert gone["how"] == "withdrawn"
        assert it.said == []


async def test_a_session_that_ends_says_so(tmp_path: Path) -> None:
    async with served_session(tmp_path, made=with_proposals(tmp_path)) as host:
        wizard = await host.connect()
        await wizard.hello("wizard")
        async with connect(host.path, name="mcp", sees="wizard") as client:
            asked = asyncio.create_task(client.say("Still there?"))
            await wizard.kind("suggest.offered")
            await host.session.close("test", rest=False)
            with pytest.raises((WozRefusedError, WozConnectionError), match="session"):
                await asked
        assert [line.how for line in host.of(SuggestGone)] == ["end"]


async def test_an_assistant_that_leaves_takes_its_proposal_with_it(tmp_path: Path) -> None:
    async with scene(tmp_path) as it:
        asked = it.asks("Bye")
        await it.offered()
        await it.client.close()
        with pytest.raises(WozConnectionError):
            await asked
        assert (await it.wizard.kind("suggest.gone"))["how"] == "withdrawn"


async def test_a_limit_that_came_meanwhile_holds(tmp_path: Path) -> None:
    """It is looked at again when the wizard approves it; both are told."""
    async with scene(tmp_path) as it:
        asked = asyncio.create_task(it.client.press("Hello"))
        offered = await it.offered()
        assert offered["items"][0]["action"] == "Hello"
        assert (await it.wizard.ask("lock", panel="Speech", locked=True))["ok"]
        reply = await it.take(offered)
        assert "'Speech' is locked" in reply["reason"]
        with pytest.raises(WozRefusedError, match="'Speech' is locked"):
            await asked
        assert (it.said, it.ends()) == ([], ["refused"])


async def test_one_waits_at_a_time(tmp_path: Path) -> None:
    async with scene(tmp_path) as it:
        first = it.asks("One")
        offered = await it.offered()
        with pytest.raises(WozRefusedError, match="still waits for the wizard"):
            await it.client.say("Two")
        assert (await it.take(offered))["ok"]
        await first
        assert it.said == ["One"]


@pytest.mark.parametrize("text", ["a\nb", "turned \u202e round", "x" * 201])
async def test_what_cannot_be_read_cannot_be_approved(tmp_path: Path, text: str) -> None:
    async with scene(tmp_path) as it:
        with pytest.raises(WozRefusedError, match="to be approved has one line"):
            await it.client.say(text)


async def test_it_has_no_other_way(tmp_path: Path) -> None:
    async with scene(tmp_path) as it:
        for request in (AskLock(panel="Base", locked=False), AskRelease()):
            with pytest.raises(WozRefusedError, match="only proposes"):
                await it.client.request(request)
        with pytest.raises(WozRefusedError, match="later moment"):
            await it.client.request(AskVerb(verb="say", args={"text": "x"}, at=99_000_000))


async def test_what_the_file_lets_it_play_is_played(tmp_path: Path) -> None:
    async with scene(tmp_path, rights=ProgramRights(("play",))) as it:
        await it.client.perform("play", {"move": "nod"})
        asked = it.asks("Nod")
        await it.wizard.ask("dismiss", set=(await it.offered())["set"])
        with pytest.raises(WozRefusedError, match="declined"):
            await asked


async def test_other_programs_play_as_before(tmp_path: Path) -> None:
    async with scene(tmp_path) as it, connect(it.host.path, name="greeter") as other:
        await other.say("Good morning")
        assert it.said == ["Good morning"]


async def test_who_sees_more_than_the_wizard_cannot_propose_to_one_who_is_blind(
    tmp_path: Path,
) -> None:
    made = with_proposals(tmp_path)
    design = Design(blind={"warm": "A", "cold": "B"})
    made = replace(made, sections={**made.sections, DESIGN: design})
    async with (
        served_session(tmp_path, made=made) as host,
        connect(host.path, name="mcp") as client,
    ):
        with pytest.raises(WozRefusedError, match="cannot approve it"):
            await client.say("You are in the warm condition")


async def test_a_console_that_comes_later_sees_what_waits(tmp_path: Path) -> None:
    async with scene(tmp_path) as it:
        asked = it.asks("Hello")
        offered = await it.offered()
        late = await it.host.connect()
        welcome = await late.hello("watcher")
        assert [line["set"] for line in welcome["state"] if line["kind"] == "suggest.offered"] == [
            offered["set"]
        ]
        refused = await late.ask("take", set=offered["set"], item="1")
        assert "only watches" in refused["reason"]
        assert (await it.take(offered))["ok"]
        await asked


async def test_the_timeline_has_each_set_as_an_episode(tmp_path: Path) -> None:
    found: list[SuggestionEpisode] = []
    async with scene(tmp_path) as it:
        it.host.session.follow(SuggestionEpisode, found.append)
        asked = it.asks("Hello")
        await it.take(await it.offered())
        await asked
    assert [each.outcome for each in found] == ["open", "key"]
