"""Whether the model that an experiment names answers, as what, and how soon."""

from __future__ import annotations

import asyncio
import os
from collections.abc import Iterator

from woz_tui.config.experiment import Experiment
from woz_tui.drivers.contract import Finding
from woz_tui.features.proposals.addresses import KEY
from woz_tui.features.proposals.chat import ChatAnswer, ChatClient, ChatError
from woz_tui.features.proposals.model_state import LIMIT_S
from woz_tui.features.proposals.section import PROPOSALS
from woz_tui.machine.feature_checks import FeatureChecks

#: What is asked: nobody's words, and hardly any work.
_ASKED = [{"role": "user", "content": "Say yes."}]
#: Seconds that a server may take here: a model is often loaded with the first request.
_WAITS_S = 30.0


def _examine(experiment: Experiment) -> Iterator[Finding]:
    section = PROPOSALS.of(experiment)
    model = section.suggest.model if section is not None else None
    if model is None:
        return
    request = {"messages": _ASKED, "max_tokens": 8, "temperature": 0, "stream": True}
    if model.name:
        request["model"] = model.name
    client = ChatClient(model.url, os.environ.get(KEY, ""), _WAITS_S)
    answer, loading = ChatAnswer(), ""
    try:
        asyncio.run(client.ask(request, answer))
        if answer.took_us > LIMIT_S * 1e6:
            loading = f"; the first time, when it may have been loading, in {_seconds(answer)}"
            answer = ChatAnswer()
            asyncio.run(client.ask(request, answer))
    except ChatError as error:
        remedy = f"start the server, or mend suggest: {{model: {{url: ...}}}}; a key is in ${KEY}"
        yield Finding("warning", model.url, str(error), remedy)
        return
    version = f", version {answer.fingerprint}" if answer.fingerprint else ""
    took = f"{_seconds(answer)} (first word after {answer.first_us / 1e6:.2f} s){loading}"
    text = f"answers as {answer.model or 'no name'}{version}, in {took}"
    if answer.took_us > LIMIT_S * 1e6:
        remedy = f"`woz suggest` drops what takes longer than {LIMIT_S:g} s: another computer, or"
        yield Finding("warning", model.url, text, f"{remedy} a smaller model")
        return
    yield Finding("ok", model.url, text)
    if model.name and answer.model and model.name != answer.model:
        told = f"{model.name} was asked for; the log has both names"
        yield Finding("info", model.url, told)


def _seconds(answer: ChatAnswer) -> str:
    return f"{answer.took_us / 1e6:.2f} s"


CHECKS = FeatureChecks(of_file=_examine)
