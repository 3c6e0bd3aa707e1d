"""`woz suggest` with a real, small model: SmolLM2-135M, which llama.cpp serves."""

from __future__ import annotations

import asyncio
import contextlib
import subprocess
import time
import urllib.error
import urllib.request
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.config.reading import HELLO, panel
from tests.fakes.ports import free_port
from tests.features.proposals.test_model_program import asked, say, states
from tests.host.rig import ServedSession, served_session
from tests.peers.places import place
from tests.session.rig import experiment, with_section
from woz_tui.client import connect
from woz_tui.config.experiment import Experiment
from woz_tui.config.loading import load
from woz_tui.drivers.plugins import installed
from woz_tui.features.proposals import doctor
from woz_tui.features.proposals.chat import ChatAnswer, ChatClient, ChatError
from woz_tui.features.proposals.kinds import SuggestAsked, SuggestOffered
from woz_tui.features.proposals.model_program import ModelProgram
from woz_tui.features.proposals.section import PROPOSALS
from woz_tui.gate.questions import RequestOrigin

#: Under which name the server has its model.
NAME = "smollm2-135m"
#: So long it may take to start or to answer on a busy machine, in seconds.
BUSY_S = 120.0
FILE = """title: Museum
robot: simulated
suggest:
  after: 0 s
  model:
    url: "%s"
    name: %s
    prompt: You are a museum guide. Answer the visitor in one short sentence.
    max_tokens: 48
"""


@dataclass(frozen=True)
class Server:
    """One that has read its model."""

    url: str
    log: Path

    def answers(self) -> int:
        """How many answers it has begun."""
        return self.log.read_text().count("POST /v1/chat/completions")

    def experiment(self, folder: Path) -> Experiment:
        path = folder / "museum.yaml"
        path.write_text(panel(HELLO, head=FILE % (self.url, NAME)), encoding="utf-8")
        return load(path, installed())


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    there, port = place("smollm2"), free_port()
    made = Server(f"http://127.0.0.1:{port}/v1", tmp_path_factory.mktemp("server") / "log")
    with made.log.open("wb") as log:
        process = subprocess.Popen(
            [
                *(there / "bin" / "python", "-u", "-m", "llama_cpp.server"),
                *("--model", there / "model.gguf", "--model_alias", NAME),
                *("--port", str(port), "--n_threads", "1", "--n_ctx", "1024"),
            ],
            stdout=log,
            stderr=log,
        )
    try:
        until = time.monotonic() + BUSY_S
        while not _serves(made.url):
            assert process.poll() is None, made.log.read_text()
            assert time.monotonic() < until, made.log.read_text()
            time.sleep(0.1)
        yield made
    finally:
        process.kill()
        process.wait()


def _serves(url: str) -> bool:
    with contextlib.suppress(urllib.error.URLError), urllib.request.urlopen(f"{url}/models"):
        return True
    return False


@asynccontextmanager
async def suggesting(folder: Path, server: Server) -> AsyncIterator[ServedSession]:
    """A session of a file beside which `woz suggest` asks the server."""
    section = PROPOSALS.of(server.experiment(folder))
    made = with_section(experiment(folder), PROPOSALS, section)  # a robot without visitors
    async with (
        served_session(folder, made=made) as host,
        connect(host.path, name="suggest", sees="wizard") as client,
    ):

        def make(url: str, key: str) -> ChatClient:
            return ChatClient(url, key, BUSY_S)

        program = asyncio.create_task(ModelProgram(client, "", lambda text: None, make).run())
        try:
            await host.until(lambda: "ready" in states(host))
            yield host
        finally:
            program.cancel()
            await asyncio.gather(program, return_exceptions=True)


async def test_what_it_writes_is_offered_and_new_words_end_it(
    tmp_path: Path, server: Server
) -> None:
    async with suggesting(tmp_path, server) as host:
        warm_up = host.of(SuggestAsked)[0]
        assert (warm_up.warm_up, warm_up.model, warm_up.error) == (True, NAME, "")

        say(host, "How large is a blue whale?")
        await host.until(lambda: host.of(SuggestOffered))
        (first,) = asked(host)
        assert (first.model, first.cue, first.error) == (NAME, "ear/1", "")
        assert host.of(SuggestOffered)[0].items[0].text in first.answer
        assert 0 < first.first_us < first.took_us, "it is read as it is written"

        await under_way(host, server, "And how old does it become?", 2)
        say(host, "Where does it live?", 3)
        await host.until(lambda: len(host.of(SuggestOffered)) == 2)
        await under_way(host, server, "What does it eat?", 4)
        host.session.play("Hello", RequestOrigin("key", "h", "con1"))
        await host.until(lambda: len(asked(host)) == 4)
        say(host, "Does it sing?", 5)
        await host.until(lambda: len(host.of(SuggestOffered)) == 3)
        assert [(line.cue, line.error) for line in asked(host)] == [
            *(("ear/1", ""), ("ear/2", "cancelled"), ("ear/3", "")),
            *(("ear/4", "cancelled"), ("ear/5", "")),
        ]
        assert [line.cue for line in host.of(SuggestOffered)] == ["ear/1", "ear/3", "ear/5"]


async def under_way(host: ServedSession, server: Server, text: str, segment: int) -> None:
    """Say something; return when the answer has begun."""
    before = server.answers()
    say(host, text, segment)
    async with asyncio.timeout(BUSY_S):
        while server.answers() == before:  # noqa: ASYNC110 - another process writes the file
            await asyncio.sleep(0.01)


async def test_the_time_limit_ends_an_answer_and_not_the_server(server: Server) -> None:
    request = {
        "messages": [{"role": "user", "content": "Tell a long story of a whale."}],
        "max_tokens": 400,
        "stream": True,
    }
    with pytest.raises(ChatError, match=r"the model took longer than 0\.5 s"):
        await ChatClient(server.url, limit=0.5).ask(request, ChatAnswer())
    answer = ChatAnswer()
    await ChatClient(server.url, limit=BUSY_S).ask({**request, "max_tokens": 8}, answer)
    assert answer.text


async def test_woz_doctor_says_as_what_it_answers_and_how_soon(
    tmp_path: Path, server: Server, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(doctor, "_WAITS_S", BUSY_S)
    made = server.experiment(tmp_path)
    found = await asyncio.to_thread(lambda: [*doctor.CHECKS.of_file(made)])
    assert found[0].text.startswith(f"answers as {NAME}, in ")
    assert "(first word after " in found[0].text
