"""Asks a server of chat completions, with a limit on everything: time, bytes, characters."""

from __future__ import annotations

import asyncio
import json
import time
from collections.abc import AsyncIterator, Sequence
from dataclasses import dataclass
from typing import Any

import aiohttp

from woz_tui.features.proposals.model_state import LIMIT_S

#: Bytes of an answer at the most.
LIMIT_BYTES = 64 << 10


class ChatError(Exception):
    """Why no answer came, in a sentence. `why`: the same in a word of `model_state.WHY`; empty: the
    model did answer, with nothing that can be used.
    """

    def __init__(self, text: str, why: str = "") -> None:
        super().__init__(text)
        self.why = why


@dataclass
class ChatAnswer:
    """What a server wrote. `first_us`: until the first piece; -1: none came."""

    text: str = ""
    model: str = ""
    fingerprint: str = ""
    first_us: int = -1
    took_us: int = 0


class ChatClient:
    """One address.

    Args:
        url: Before `/chat/completions`.
        key: Sent as a bearer's; empty: none.
        limit: Seconds for an answer, where `ask` is not told others.
    """

    def __init__(self, url: str, key: str = "", limit: float = LIMIT_S) -> None:
        self._url = f"{url.rstrip('/')}/chat/completions"
        self._headers = {"Authorization": f"Bearer {key}"} if key else {}
        self._limit = limit

    async def ask(
        self, request: dict[str, Any], answer: ChatAnswer, limit: float | None = None
    ) -> None:
        """Fill `answer` in, as far as it came. Raises `ChatError`."""
        limit = self._limit if limit is None else limit
        began = time.monotonic_ns()
        try:
            async with asyncio.timeout(limit):
                async for piece in self._pieces(request):
                    self._take(piece, answer, began)
        except TimeoutError:
            raise ChatError(f"the model took longer than {limit:g} s", "slow") from None
        except (aiohttp.ClientError, OSError) as error:
            why = "unreachable" if isinstance(error, aiohttp.ClientConnectorError) else "cut"
            raise ChatError(f"the model's server: {type(error).__name__}", why) from error
        except (ValueError, TypeError, AttributeError, KeyError, IndexError) as error:
            raise ChatError("the model's server sent what is no answer", "odd") from error
        finally:
            answer.took_us = (time.monotonic_ns() - began) // 1000
        if not answer.text.strip():
            raise ChatError("the model wrote nothing")

    def _take(self, piece: dict[str, Any], answer: ChatAnswer, began: int) -> None:
        answer.model = str(piece.get("model") or answer.model)[:200]
        answer.fingerprint = str(piece.get("system_fingerprint") or answer.fingerprint)[:200]
        for choice in piece.get("choices", ())[:1]:
            part = choice.get("delta") or choice.get("message") or {}
            if text := part.get("content"):
                if answer.first_us < 0:
                    answer.first_us = (time.monotonic_ns() - began) // 1000
                answer.text += str(text)

    async def _pieces(self, request: dict[str, Any]) -> AsyncIterator[dict[str, Any]]:
        # No proxy of the environment: what a visitor said goes where the file says, nowhere else.
        timeout = aiohttp.ClientTimeout(total=None)
        async with (
            aiohttp.ClientSession(headers=self._headers, trust_env=False, timeout=timeout) as web,
            web.post(self._url, json=request, allow_redirects=False) as response,
        ):
            if response.status == 503:  # so servers answer that have not read their model yet
                raise ChatError("the model's server is not ready yet: 503", "loading")
            if response.status != 200:
                raise ChatError(f"the model's server refuses: {response.status}", "refuses")
            streams = response.content_type == "text/event-stream"
            read, buffer = 0, b""
            async for chunk in response.content.iter_any():
                read += len(chunk)
                if read > LIMIT_BYTES:
                    raise ChatError(f"the answer has more than {LIMIT_BYTES >> 10} KiB", "odd")
                buffer += chunk
                while streams and b"\n" in buffer:
                    line, _, buffer = buffer.partition(b"\n")
                    data = line.strip().removeprefix(b"data:").strip()
                    if not line.startswith(b"data:"):
                        continue
                    if data == b"[DONE]":
                        return
                    yield _object(data)
            if not streams:
                yield _object(buffer)


def _object(data: bytes) -> dict[str, Any]:
    found = json.loads(data)
    if not isinstance(found, dict):
        raise ValueError("no object")
    return found


def sentences_of(text: str, longest: int, most: int) -> Sequence[str]:
    """The lines of an answer that can be offered, without numbers and quotation marks."""
    lines = (
        line.strip().lstrip("-*•0123456789.) ").strip("\"'“”„« »") for line in text.splitlines()
    )
    fitting = (line for line in lines if line and len(line) <= longest)
    return tuple(dict.fromkeys(fitting))[:most]
