"""`woz suggest`: what a model writes is offered, logged, and never said by itself."""

from __future__ import annotations

import asyncio
import hashlib
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest

from tests.config.reading import HELLO, panel, read_experiment
from tests.fakes.chat_server import FAULTS, ChatServer, chat_server
from tests.host.rig import ServedSession, served_session
from tests.session.rig import experiment, with_section
from woz_tui.client import connect
from woz_tui.features.proposals.chat import ChatAnswer, ChatClient, ChatError, sentences_of
from woz_tui.features.proposals.command import KeyFileError, read_key
from woz_tui.features.proposals.kinds import SuggestAsked, SuggestOffered, SuggestState
from woz_tui.features.proposals.model_program import FAILURES, ModelProgram
from woz_tui.features.proposals.model_state import WHY
from woz_tui.features.proposals.section import (
    PROPOSALS,
    ModelSettings,
    Proposals,
    SuggestKeysOfFile,
)
from woz_tui.protocol import messages as m

pytestmark = pytest.mark.real_clock


@asynccontextmanager
async def asking(
    tmp_path: Path, limit: float = 2.5, after: float = 0.0
) -> AsyncIterator[tuple[ServedSession, ChatServer]]:
    """A session beside which `woz suggest` asks a model that is warm."""
    async with starting(tmp_path, limit, after=after) as (host, server):
        await host.until(lambda: "ready" in states(host))
        server.asked.clear()
        server.keys.clear()
        yield host, server


@asynccontextmanager
async def starting(
    tmp_path: Path, limit: float = 2.5, fault: str = "", after: float = 0.0
) -> AsyncIterator[tuple[ServedSession, ChatServer]]:
    """A session beside which `woz suggest` begins; `fault`: of the server then."""
    async with chat_server() as server:
        server.fault = fault
        model = ModelSettings(url=server.url, name="small", prompt="Suggest.")
        made = with_section(
            experiment(tmp_path),
            PROPOSALS,
            Proposals(SuggestKeysOfFile(model=model, after=after)),
        )
        async with (
            served_session(tmp_path, made=made) as host,
            connect(host.path, name="suggest", sees="wizard") as client,
        ):

            def make(url: str, key: str) -> ChatClient:
                return ChatClient(url, key, limit)

            run = ModelProgram(client, "secret", lambda text: None, make).run()
            program = asyncio.create_task(run)
            try:
                yield host, server
            finally:
                program.cancel()
                await asyncio.gather(program, return_exceptions=True)


def states(host: ServedSession) -> list[str]:
    return [line.how for line in host.of(SuggestState)]


def asked(host: ServedSession) -> list[SuggestAsked]:
    """What the model was asked after it was warm."""
    return [line for line in host.of(SuggestAsked) if not line.warm_up]


def say(host: ServedSession, text: str, segment: int = 1, *, own: bool = False) -> None:
    host.session.hub.publish(m.SpeechText(driver="ear", segment=segment, text=text, own=own))


async def test_what_the_model_writes_is_offered_and_in_the_log(tmp_path: Path) -> None:
    async with asking(tmp_path) as (host, server):
        say(host, "What is this?")
        await host.until(lambda: host.of(SuggestOffered))
        (offered,), (request,) = host.of(SuggestOffered), asked(host)
        assert [item.text for item in offered.items] == [
            "It is a whale.",
            "It is thirty metres long.",
        ]
        assert (offered.source, offered.who, offered.cue) == ("model", "suggest", "ear/1")
        assert request.asked == server.asked[0]
        assert (request.model, request.fingerprint, request.error) == ("small-q4", "fp1", "")
        assert request.answer == server.text
        assert request.prompt_sha256 == hashlib.sha256(b"Suggest.").hexdigest()
        assert [line["content"] for line in server.asked[0]["messages"]] == [
            "Suggest.",
            "What is this?",
        ]
        assert server.keys == ["Bearer secret"]
        assert "secret" not in str(host.lines), "no key in the log"
        assert host.driver().calls == []


async def test_an_answer_that_waits_for_its_time_is_in_the_log_whatever_becomes_of_it(
    tmp_path: Path,
) -> None:
    async with asking(tmp_path, after=100.0) as (host, server):
        say(host, "What is this?")
        await host.until(lambda: asked(host))
        say(host, "Really?", 2)
        await host.until(lambda: len(asked(host)) == 2)
        assert [(line.cue, line.answer) for line in asked(host)] == [
            ("ear/1", server.text),
            ("ear/2", server.text),
        ]
        assert host.of(SuggestOffered) == []


async def test_the_robots_own_voice_asks_nothing(tmp_path: Path) -> None:
    async with asking(tmp_path) as (host, server):
        say(host, "It is a whale.", own=True)
        say(host, "Really?", 2)
        await host.until(lambda: host.of(SuggestOffered))
        assert len(server.asked) == 1


async def test_braces_and_escape_codes_of_a_model_are_only_text(tmp_path: Path) -> None:
    async with asking(tmp_path) as (host, server):
        server.text = "You are \x1b[31min {condition}\u202e.\n" + "x" * 300
        say(host, "Which group?")
        await host.until(lambda: host.of(SuggestOffered))
        (item,) = host.of(SuggestOffered)[0].items
        assert item.text == "You are [31min {condition} ."


#: What the wizard reads of each.
_REASONS = {
    **{"429": "refuses", "500": "refuses", "hang": "slow", "slow": "slow", "cut": "cut"},
    **{"megabyte": "odd", "wrong json": "odd", "list": "odd", "empty": ""},
}


@pytest.mark.parametrize("fault", FAULTS)
async def test_a_server_that_fails_delays_nothing_and_is_told_once(
    tmp_path: Path, fault: str
) -> None:
    async with asking(tmp_path, limit=0.2) as (host, server):
        server.fault = fault
        for segment in range(FAILURES):
            say(host, "Hm?", segment)
            await host.until(lambda: len(asked(host)) > segment)  # noqa: B023
        if fault == "no done":  # it ends all the same
            await host.until(lambda: host.of(SuggestOffered))
            return
        assert host.of(SuggestOffered) == []
        assert all(line.error for line in asked(host))
        await host.until(lambda: host.of(m.Notice))
        say(host, "And now?", 9)
        wizard = await host.connect()
        await wizard.hello("wizard")
        assert (await wizard.ask("action", action="Hello", source="key"))["ok"]
        assert len(server.asked) == FAILURES, "it rests"
        why = WHY[_REASONS[fault]]
        assert [line.text for line in host.of(m.Notice)] == [
            f"The model does not answer ({why}): no sentences are proposed for a while"
        ]


async def test_new_words_take_the_place_of_what_was_asked(tmp_path: Path) -> None:
    async with asking(tmp_path) as (host, server):
        server.fault = "hang"
        say(host, "One?")
        while not server.asked:  # noqa: ASYNC110
            await asyncio.sleep(0)
        server.fault = ""
        say(host, "Two?", 2)
        await host.until(lambda: host.of(SuggestOffered))
        assert [line.error for line in asked(host)] == ["cancelled", ""]
        assert host.of(SuggestOffered)[0].cue == "ear/2"


async def test_nobody_answers_at_the_address() -> None:
    with pytest.raises(ChatError, match="the model's server"):
        await ChatClient("http://127.0.0.1:9/v1").ask({}, ChatAnswer())


def test_lines_of_an_answer() -> None:
    assert sentences_of('1. "Yes."\n- No.\n\nYes.\n', 200, 2) == ("Yes.", "No.")


def test_a_key_that_others_can_read_is_not_used(tmp_path: Path) -> None:
    file = tmp_path / "key"
    file.write_text("secret\n")
    file.chmod(0o644)
    with pytest.raises(KeyFileError, match="chmod 600"):
        read_key(file)
    file.chmod(0o600)
    assert read_key(file) == "secret"


def test_woz_check_warns_of_an_address_elsewhere(tmp_path: Path) -> None:
    def warnings(url: str) -> list[str]:
        head = f"title: T\nrobot: simulated\nsuggest: {{model: {{url: '{url}'}}}}\n"
        found = read_experiment(tmp_path, panel(HELLO, head=head)).warnings
        return [one.message for one in found if "visitors say" in one.message]

    assert warnings("http://127.0.0.1:8080/v1") == []
    assert "is sent to models.example" in warnings("https://models.example/v1")[0]
