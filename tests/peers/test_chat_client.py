"""The official client of chat completions examines the server that our tests talk to.

What it takes for an answer, an error or a broken line is what our client's tests may stand on. It
gets the requests that `woz suggest` sends.
"""

from __future__ import annotations

import asyncio
import json

import pytest

from tests.fakes.chat_server import chat_server
from tests.peers.places import place
from woz_tui.features.proposals.chat import ChatAnswer, ChatClient, ChatError

pytestmark = pytest.mark.peers

#: Runs where the client is installed: one request, streamed, and what came of it.
CLIENT = """
import json, sys
import openai

patience = float(sys.argv[3])
client = openai.OpenAI(base_url=sys.argv[1], api_key="secret", timeout=patience, max_retries=0)
came = {"text": ""}
try:
    stream = client.chat.completions.create(**json.loads(sys.argv[2]))
    for piece in stream:
        came["model"], came["fingerprint"] = piece.model, piece.system_fingerprint
        if piece.choices:
            came["text"] += piece.choices[0].delta.content or ""
except Exception as error:
    came["error"] = type(error).__name__
print(json.dumps(came))
"""
ASKED = {
    "model": "small",
    "messages": [{"role": "system", "content": "Suggest."}, {"role": "user", "content": "Hm?"}],
    "stream": True,
    "temperature": 0.0,
    "seed": 1,
    "max_tokens": 80,
}


@pytest.mark.parametrize(
    ("fault", "error"),
    [
        ("", ""),
        ("no done", ""),
        ("empty", ""),
        ("429", "RateLimitError"),
        ("500", "InternalServerError"),
        ("hang", "APITimeoutError"),
        ("slow", "APITimeoutError"),
        ("cut", "APIConnectionError"),
        ("wrong json", "JSONDecodeError"),
    ],
)
async def test_both_clients_make_the_same_of_it(fault: str, error: str) -> None:
    python = place("openai") / "bin" / "python"
    patience = 1.0 if fault in ("hang", "slow") else 30.0  # else nobody waits for anything
    async with chat_server() as server:
        server.fault = fault
        run = await asyncio.create_subprocess_exec(
            *(python, "-c", CLIENT, server.url, json.dumps(ASKED), str(patience)),
            stdout=asyncio.subprocess.PIPE,
        )
        output, _ = await asyncio.wait_for(run.communicate(), 60)
        came = json.loads(output)
        answer, why = ChatAnswer(), ""
        try:
            await ChatClient(server.url, "secret", limit=patience).ask({**ASKED}, answer)
        except ChatError as failed:
            why = str(failed)
    assert came.get("error", "") == error
    assert server.keys == ["Bearer secret"] * 2
    assert server.asked[0].items() >= ASKED.items()
    assert bool(why) == (bool(error) or fault == "empty"), why
    if not error and fault != "empty":
        assert (came["text"], came["model"], came["fingerprint"]) == (
            *(answer.text, answer.model, answer.fingerprint),
        )
