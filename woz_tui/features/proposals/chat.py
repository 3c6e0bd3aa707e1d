"""Asks a server of chat completions, with a limit on everything: time, bytes, characters."""

from __future__ import annotations

import asyncio
import json
import time
from collections.abc import AsyncIterator, Sequence
from dataclasses import dataclass
from typing import Any

import aiohttp

#: Seconds for a whole answer, and bytes of it.
LIMIT_S, LIMIT_BYTES = 2.5, 64 << 10


class ChatError(Exception):
    """Why no answer came, in a sentence."""


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
        limit: Seconds for an answer.
    """

    def __init__(self, url: str, key: str = "", limit: float = LIMIT_S) -> None:
        self._url = f"{url.rstrip('/')}/chat/completions"
        self._headers = {"Authorization": f"Bearer {key}"} if key else {}
        self._limit = limit

    async def ask(self, request: dict[str, Any], answer: ChatAnswer) -> None:
        """Fill `answer` in, as far as it came. Raises `ChatError`."""
        began = time.monotonic_ns()
        try:
            async with asyncio.timeout(self._limit):
                async for piece in self._pieces(request):
                    self._take(piece, answer, began)
        except TimeoutError:
            raise ChatError(f"the model took longer than {self._limit:g} s") from None
        except (aiohttp.ClientError, OSError) as error:
            raise ChatError(f"the model's server: {type(error).__name__}") from error
        except (ValueError, TypeError, AttributeError, KeyError, IndexError) as error:
            raise ChatError("the model's server sent what is no answer") from error
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
            if response.status != 200:
                raise ChatError(f"the model's server refuses: {response.status}")
            streams = response.content_type == "text/event-stream"
            read, buffer = 0, b""
            async for chunk in response.content.iter_any():
                read += len(chunk)
                if read > LIMIT_BYTES:
                    raise ChatError(f"the answer has more than {LIMIT_BYTES >> 10} KiB")
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
