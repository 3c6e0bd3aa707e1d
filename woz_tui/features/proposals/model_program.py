"""`woz suggest` at work: each time the visitor has said something, it asks the model."""

from __future__ import annotations

import asyncio
import contextlib
import hashlib
import time
from collections import deque
from collections.abc import Callable

from woz_tui.client import WozClient, WozError, WozRefusedError
from woz_tui.features.phases.kinds import PhaseChanged
from woz_tui.features.proposals.chat import ChatAnswer, ChatClient, ChatError, sentences_of
from woz_tui.features.proposals.clean_text import LONGEST, cleaned
from woz_tui.features.proposals.kinds import (
    AskModelTold,
    AskPropose,
    SuggestModel,
    SuggestSettings,
    SuggestTrial,
)
from woz_tui.features.proposals.rights import HANDS
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol.envelope import Json
from woz_tui.system.tasks import end_tasks

#: Turns of the dialogue that the model reads, and sentences of it that are offered.
TURNS, OFFERED = 8, 2
#: After so many failures it is not asked for so long, in seconds.
FAILURES, PAUSE_S = 3, 30.0


class ModelProgram:
    """Asks one model, one request at a time.

    Args:
        client: The session, as its wizard sees it.
        key: Of the model's server.
        say: Called with a sentence for whoever started it.
        make: Makes the client of an address.
    """

    def __init__(
        self,
        client: WozClient,
        key: str,
        say: Callable[[str], None],
        make: Callable[[str, str], ChatClient] = ChatClient,
    ) -> None:
        self._client, self._key, self._say, self._make = client, key, say, make
        self._model: SuggestModel | None = None
        self._after = 0.0
        #: Whether nothing is proposed in this trial.
        self._quiet = False
        self._turns: deque[dict[str, Json]] = deque(maxlen=TURNS)
        self._asking: asyncio.Task[None] | None = None
        self._failures = 0
        self._rests_until = 0.0

    async def run(self) -> None:
        """Until the session ends. Raises `WozError`."""
        try:
            async for message in self._client.messages(held=True):
                match message:
                    case SuggestModel():
                        self._model = message
                        self._say(
                            f"woz suggest asks {message.name or 'the model'} at {message.url}"
                        )
                    case SuggestSettings(after_us=after):
                        self._after = after / 1e6
                    case SuggestTrial(offered=offered):
                        self._quiet = not offered
                    case m.Message() if message.seq > self._client.welcome.seq:
                        self._follow(message)
        finally:
            await end_tasks(self._asking)

    def _follow(self, message: m.Message) -> None:
        match message:
            case m.SpeechText(text=text) if text and not message.own:
                self._turns.append({"role": "user", "content": text})
                self._ask_anew(message)
            case m.Command(verb="say", args={"text": str(text)}) if "..." not in text:
                self._turns.append({"role": "assistant", "content": text})
            case m.TrialEnded():
                self._quiet = False
                self._cancel()
            case m.StopPressed() | PhaseChanged() | m.TrialStarted():
                self._cancel()
            case m.ActionRequested(source=source) if source in HANDS:
                self._cancel()

    def _cancel(self) -> None:
        if self._asking is not None:
            self._asking.cancel()

    def _ask_anew(self, message: m.SpeechText) -> None:
        self._cancel()
        if self._model is None or self._quiet or time.monotonic() < self._rests_until:
            return
        cue = f"{message.driver}/{message.segment}"
        self._asking = asyncio.create_task(self._ask(self._model, cue), name="the model")

    async def _ask(self, model: SuggestModel, cue: str) -> None:
        began = time.monotonic()
        request: dict[str, Json] = {
            **({"model": model.name} if model.name else {}),
            "messages": [{"role": "system", "content": model.prompt}, *self._turns],
            "stream": True,
            **{k: v if k == "temperature" else int(v) for k, v in model.sampling.items()},
        }
        answer, error = ChatAnswer(), ""
        try:
            await self._make(model.url, self._key).ask(request, answer)
        except ChatError as failed:
            error = str(failed)
        except asyncio.CancelledError:  # what was sent is in the log all the same
            with contextlib.suppress(WozError):
                self._client.send_soon(self._told(model, cue, request, answer, "cancelled"))
            raise
        texts = [] if error else [cleaned(t) for t in sentences_of(answer.text, LONGEST, OFFERED)]
        texts = [text for text in texts if text]
        if not error and not texts:
            error = "the model wrote no sentence that could be offered"
        self._failures = self._failures + 1 if error else 0
        gives_up = self._failures >= FAILURES
        if gives_up:
            self._failures, self._rests_until = 0, time.monotonic() + PAUSE_S
        if texts:
            await asyncio.sleep(max(0.0, self._after - (time.monotonic() - began)))
        told = self._told(model, cue, request, answer, error, given_up=gives_up)
        try:
            await self._client.request(told)
            if texts:
                await self._client.request(AskPropose(texts=texts, source="model", cue=cue))
        except WozRefusedError as refused:
            self._say(f"woz suggest: {refused}")

    def _told(
        self,
        model: SuggestModel,
        cue: str,
        request: dict[str, Json],
        answer: ChatAnswer,
        error: str,
        *,
        given_up: bool = False,
    ) -> AskModelTold:
        return AskModelTold(
            cue=cue,
            asked=request,
            model=answer.model,
            fingerprint=answer.fingerprint,
            answer=answer.text,
            prompt_sha256=hashlib.sha256(model.prompt.encode()).hexdigest(),
            first_us=answer.first_us,
            took_us=answer.took_us,
            error=error,
            given_up=given_up,
        )


def held_model(client: WozClient) -> SuggestModel | None:
    """The model that the session's file names."""
    for line in client.welcome.state:
        message = codec.decode_message(line)
        if isinstance(message, SuggestModel):
            return message
    return None
