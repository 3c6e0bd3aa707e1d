"""Which language models were asked in a session, and how quickly they answered."""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from statistics import median

from woz_tui.analysis.event_rows import moments
from woz_tui.analysis.report_table import LogText, ReportTable
from woz_tui.analysis.text_format import NONE, in_seconds, listed
from woz_tui.features.proposals.addresses import host_of, is_local
from woz_tui.features.proposals.kinds import SuggestAsked, SuggestModel
from woz_tui.timeline.timeline import Timeline


@dataclass(frozen=True, slots=True)
class ModelFigures:
    """A model, as it was asked and as it answered, and how long that took. `answered`: the names
    and versions with which the server answered.
    """

    url: str
    name: str
    sampling: Mapping[str, float]
    prompt: str
    answered: tuple[str, ...]
    requests: int
    errors: Counter[str]
    first_us: tuple[int, ...]
    took_us: tuple[int, ...]


def models_of(timeline: Timeline) -> Iterator[ModelFigures]:
    """Each model with its requests: those between its line and the next one's."""
    lines = [line for kind in (SuggestModel, SuggestAsked) for _, line in moments(timeline, kind)]
    lines.sort(key=lambda line: line.seq)
    begins = [i for i, line in enumerate(lines) if isinstance(line, SuggestModel)]
    for begin, end in pairwise([*begins, len(lines)]):
        model = lines[begin]
        asked = [
            line
            for line in lines[begin + 1 : end]
            if isinstance(line, SuggestAsked) and not line.warm_up
        ]
        assert isinstance(model, SuggestModel)
        answered = (
            " ".join(filter(None, (line.model, line.fingerprint and f"({line.fingerprint})")))
            for line in asked
        )
        errors = Counter(line.error for line in asked if line.error)
        yield ModelFigures(
            url=model.url,
            name=model.name,
            sampling=model.sampling,
            prompt=model.prompt,
            answered=tuple(dict.fromkeys(filter(None, answered))),
            requests=len(asked),
            errors=errors,
            first_us=tuple(line.first_us for line in asked if line.first_us >= 0),
            took_us=tuple(line.took_us for line in asked if not line.error),
        )


def model_table(models: Sequence[ModelFigures]) -> ReportTable:
    rows = [
        (
            LogText(", ".join(each.answered) or each.name or NONE),
            *(str(each.requests), str(each.requests - sum(each.errors.values()))),
            *(str(each.errors["cancelled"]), str(_failed(each))),
            *(in_s(of(times)) for times in (each.first_us, each.took_us) for of in _OF_TIMES),
        )
        for each in models
        if each.requests
    ]
    heads = ("Model", "Requests", "Answered", "Superseded", "Failed")
    times = ("First word", "95 % within", "Whole", "95 % within")
    return ReportTable("Language model", (*heads, *times), rows, words=1)


def _failed(model: ModelFigures) -> int:
    return sum(model.errors.values()) - model.errors["cancelled"]


def about_models(models: Sequence[ModelFigures]) -> Iterator[str]:
    """Which model, with which words and settings, and where it ran: each that was asked, once."""
    told: dict[tuple[str, ...], list[ModelFigures]] = {}
    for each in models:
        if each.requests:
            settings = ", ".join(f"{name} {value:g}" for name, value in each.sampling.items())
            told.setdefault((each.url, each.name, settings, each.prompt), []).append(each)
    for (url, name, settings, prompt), found in told.items():
        answered = [*dict.fromkeys(name for each in found for name in each.answered)]
        asked = f"asked for as “{name}”" if name else "the server's own"
        as_ = f", answered as “{listed(answered)}”" if answered else ""
        where = f"at {host_of(url)}"
        if is_local(url):
            where = "on the computer of the robot process"
        requests = sum(each.requests for each in found)
        failed = sum(map(_failed, found))
        digest = hashlib.sha256(prompt.encode()).hexdigest()[:16]
        times = sorted(us for each in found for us in each.took_us)
        took = f" (median {in_seconds(median(times))} s)" if times else ""
        yield (
            f"Sentences were proposed by a language model ({asked}{as_}; {settings}), served"
            f" {where}, which was asked {requests} times{took} and failed {failed} times. It read"
            f" the last turns of the dialogue behind this prompt (SHA-256 {digest}...):"
            f" “{prompt}” It knew no condition, and the same settings need not give the"
            " same text again; each answer is in the log."
        )


def in_s(us: float | None) -> str:
    return NONE if us is None else f"{in_seconds(round(us))} s"


def percentile_95(values: Sequence[int]) -> float | None:
    return sorted(values)[min(len(values) - 1, int(0.95 * len(values)))] if values else None


def median_of(values: Sequence[int]) -> float | None:
    return median(values) if values else None


_OF_TIMES = (median_of, percentile_95)
