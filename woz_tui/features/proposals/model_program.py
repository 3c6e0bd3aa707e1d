"""`woz suggest` at work: each time the visitor has said something, it asks the model.

First it warms the model up: a server may read it from the disk with the first request, and has not
seen the prompt before. What the visitor says meanwhile is answered afterwards.
"""

from __future__ import annotations

import asyncio
import contextlib
import hashlib
import time
from collections import deque
from collections.abc import Callable

from msgspec.structs import replace

from woz_tui.client import WozClient, WozError, WozRefusedError
from woz_tui.features.phases.kinds import PhaseChanged
from woz_tui.features.proposals.chat import ChatAnswer, ChatClient, ChatError, sentences_of
from woz_tui.features.proposals.clean_text import LONGEST, cleaned
from woz_tui.features.proposals.kinds import (
    AskModelState,
    AskModelTold,
    AskPropose,
    ModelStateWord,
    SuggestModel,
    SuggestSettings,
    SuggestTrial,
)
from woz_tui.features.proposals.model_state import is_too_slow
from woz_tui.features.proposals.rights import HANDS
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol.envelope import Json
from woz_tui.system.tasks import end_tasks

#: Turns of the dialogue that the model reads, and sentences of it that are offered.
TURNS, OFFERED = 8, 2
#: After so many failures it is not asked for so long, in seconds.
FAILURES, PAUSE_S = 3, 30.0
#: What warms it up: nobody's words, and hardly any work.
_WARM_UP: Json = [{"role": "user", "content": "Hello."}]
#: Seconds that this may take, and until it is tried once more.
WARM_S, AGAIN_S = 90.0, 3.0


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
        self._warming: asyncio.Task[None] | None = None
        #: Whether it is warm; what was said before that and nobody has answered since.
        self._ready, self._waiting = False, ""
        self._failures = 0
        #: What was told of it last.
        self._state: tuple[str, str] = ("", "")

    async def run(self) -> None:
        """Until the session ends. Raises `WozError`."""
        try:
            async for message in self._client.messages(held=True):
                match message:
                    case SuggestModel():
                        await self._choose(message)
                    case SuggestSettings(after_us=after, sources=sources):
                        self._after = after / 1e6
                        if "model" not in sources:
                            await self._choose(None)
                    case SuggestTrial(offered=offered):
                        self._quiet = not offered
                    case m.Message() if message.seq > self._client.welcome.seq:
                        self._follow(message)
        finally:
            await end_tasks(self._asking, self._warming)

    async def _choose(self, model: SuggestModel | None) -> None:
        """The file names this model, or none any more."""
        if model is not None and self._model is not None and _same(model, self._model):
            return
        self._cancel()
        await end_tasks(self._warming)
        self._model, self._state = model, ("", "")
        if model is not None:
            self._say(f"woz suggest asks {model.name or 'the model'} at {model.url}")
            self._begin_warm_up(model)

    def _begin_warm_up(self, model: SuggestModel, failed: str | None = None) -> None:
        self._ready = False
        self._warming = asyncio.create_task(self._warm_up(model, failed), name="warming up")

    async def _warm_up(self, model: SuggestModel, failed: str | None) -> None:
        """Until the model has answered, however often that needs. `failed`: why it rests before."""
        try:
            if failed is None:
                await self._tell("loading")
            else:
                await self._tell("failing", failed)
                await asyncio.sleep(PAUSE_S)
            told = await self._answered(model)
            if is_too_slow(told.first_us):  # it was loaded with this one
                told = await self._answered(model)
            self._failures, self._ready = 0, True
            await self._tell("ready", model=told.model, first_us=told.first_us)
            self._say(f"woz suggest: the first word came after {told.first_us / 1e6:.2f} s")
        except WozRefusedError as refused:
            self._say(f"woz suggest: {refused}")
            return
        if cue := self._waiting:
            self._ask_anew(cue)

    async def _answered(self, model: SuggestModel) -> AskModelTold:
        """The first warm-up that comes to an end, as it was told; others are told once for each
        reason.
        """
        request = _request(model, _WARM_UP) | {"max_tokens": 8}
        while True:
            answer, why, error = ChatAnswer(), "", ""
            try:
                await self._make(model.url, self._key).ask(request, answer, WARM_S)
            except ChatError as failed:
                why, error = failed.why, str(failed)
            told = self._told(model, "", request, answer, error, warm_up=True)
            state: ModelStateWord = "loading" if why == "loading" else "failing"
            if not why or self._state != (state, why):
                await self._client.request(told)
            if not why:
                return replace(told, first_us=max(answer.first_us, 0) or answer.took_us)
            if await self._tell(state, why):
                self._say(f"woz suggest: {error}; it is asked again until it answers")
            await asyncio.sleep(AGAIN_S)

    async def _tell(
        self, state: ModelStateWord, why: str = "", *, model: str = "", first_us: int = -1
    ) -> bool:
        """Tell how it stands with the model; whether that is new."""
        if (state, why) == self._state:
            return False
        self._state = state, why
        told = AskModelState(how=state, why=why, model=model, first_us=first_us)
        await self._client.request(told)
        return True

    def _follow(self, message: m.Message) -> None:
        match message:
            case m.SpeechText(text=text) if text and not message.own:
                self._turns.append({"role": "user", "content": text})
                self._ask_anew(f"{message.driver}/{message.segment}")
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
        self._waiting = ""
        if self._asking is not None:
            self._asking.cancel()

    def _ask_anew(self, cue: str) -> None:
        self._cancel()
        if self._model is None or self._quiet:
            return
        if self._ready:
            self._asking = asyncio.create_task(self._ask(self._model, cue), name="the model")
        else:
            self._waiting = cue

    async def _ask(self, model: SuggestModel, cue: str) -> None:
        began = time.monotonic()
        request = _request(model, [*self._turns])
        answer, why, error = ChatAnswer(), "", ""
        try:
            await self._make(model.url, self._key).ask(request, answer)
        except ChatError as failed:
            why, error = failed.why, str(failed)
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
        if why == "loading":
            self._waiting = cue
            self._begin_warm_up(model)
        elif gives_up:
            self._begin_warm_up(model, why)
        told = self._told(model, cue, request, answer, error, given_up=gives_up)
        try:
            await self._client.request(told)
            if texts:
                await asyncio.sleep(max(0.0, self._after - (time.monotonic() - began)))
                await self._client.request(AskPropose(texts=texts, source="model", cue=cue))
                if self._state[0] == "dropped":
                    await self._tell("ready", model=answer.model, first_us=answer.first_us)
            elif self._ready:
                await self._tell("dropped", why)
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
        warm_up: bool = False,
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
            warm_up=warm_up,
        )


def _request(model: SuggestModel, turns: Json) -> dict[str, Json]:
    """What is sent, after these turns of the dialogue."""
    assert isinstance(turns, list)
    return {
        **({"model": model.name} if model.name else {}),
        "messages": [{"role": "system", "content": model.prompt}, *turns],
        "stream": True,
        **{k: v if k == "temperature" else int(v) for k, v in model.sampling.items()},
    }


def _same(model: SuggestModel, other: SuggestModel) -> bool:
    """Whether both are asked in the same way."""
    return all(
        getattr(model, name) == getattr(other, name)
        for name in ("url", "name", "sampling", "prompt")
    )


def held_model(client: WozClient) -> SuggestModel | None:
    """The model that the session's file names."""
    for line in client.welcome.state:
        message = codec.decode_message(line)
        if isinstance(message, SuggestModel):
            return message
    return None
