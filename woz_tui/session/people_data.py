"""What becomes of people's data, as far as a file says it: what an ethics application has to tell.

Nothing is guessed. What boards ask and no file can say is named as missing.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from woz_tui.config.experiment import Experiment
from woz_tui.config.feature_section import sections
from woz_tui.drivers.contract import DECIDES, KEPT, LEAVES, Driver
from woz_tui.protocol.action_messages import SPEAKING_VERBS


def people_lines(
    experiment: Experiment, catalogue: Mapping[str, type[Driver]]
) -> Iterator[tuple[str, str]]:
    """What is asked, and a sentence."""
    told: dict[str, list[str]] = {LEAVES: [], KEPT: [], DECIDES: []}
    facts = (
        *_of_drivers(experiment, catalogue),
        *_of_engagement(experiment),
        *(fact for section in sections() for fact in section.people_data(experiment)),
    )
    for about, sentence in facts:
        told[about].append(sentence)
    if experiment.session.access:
        who = ", ".join(f"{name} ({role})" for name, role in experiment.session.access.items())
        told[LEAVES].append(f"to who may join from another machine: {who}")
    kept = "codes of participants, what is said to them, keys, notes and readings, in the log"
    by_hand = "a wizard, of what keys and the script say and of what is typed"
    for about, sentence in (
        *((LEAVES, each) for each in told[LEAVES] or ["nothing of which this file tells"]),
        *((KEPT, each) for each in (kept, *told[KEPT])),
        *((DECIDES, each) for each in (by_hand, *told[DECIDES])),
    ):
        yield about, sentence
    yield from _missing(experiment)


def _of_drivers(
    experiment: Experiment, catalogue: Mapping[str, type[Driver]]
) -> Iterator[tuple[str, str]]:
    for spec in experiment.drivers:
        address = getattr(spec.settings, "address", "")
        if spec.at is not None:
            yield LEAVES, f"between this computer and {spec.at.name}, which has {spec.name}"
        elif isinstance(address, str) and address and not (spec.simulated or address[0] == "/"):
            yield LEAVES, f"between this computer and {address}: what {spec.name} says and senses"
        if spec.type in catalogue and not spec.simulated:
            for about, sentence in _said_by(catalogue[spec.type], spec.settings):
                yield about, f"{spec.name}: {sentence}"


def _said_by(driver: type[Driver], settings: Any) -> list[tuple[str, str]]:
    """What a driver says, whose code may be a stranger's; what it fails to say may be anything."""
    try:
        facts = [*driver.people_data(settings)]
        for about, _ in facts:
            if about not in (LEAVES, KEPT, DECIDES):
                raise ValueError(f"{about!r} is none of LEAVES, KEPT and DECIDES")
    except Exception as error:  # noqa: BLE001 - a plug-in's code
        why = f"{type(error).__name__}: {error}"
        return [(LEAVES, f"its driver fails to say what becomes of people's data ({why})")]
    return facts


def _of_engagement(experiment: Experiment) -> Iterator[tuple[str, str]]:
    engagement = experiment.engagement
    if engagement is None:
        return
    settings = engagement.settings
    file = settings.visitors or "visitors.json beside the logs"
    yield KEPT, f"names or codes of visitors, age group, form of address, days of meeting: {file}"
    handshake = settings.handshake
    if handshake.by == "robot":
        yield DECIDES, "nobody: the robot itself asks people for their names"
    if handshake.by != "nobody" and handshake.face_consent:
        yield KEPT, f"a face is learnt only after a yes to: {handshake.face_consent}"
    states = []
    for state in dict.fromkeys((*engagement.effects, *engagement.plays)):
        plays = map(experiment.action, engagement.plays.get(state, ()))
        played = filter(None, (engagement.effects.get(state), *plays))
        if any(call.verb in SPEAKING_VERBS for action in played for call in action.calls):
            states.append(state)
    if states:
        yield DECIDES, f"nobody: what is said as a state begins: {', '.join(states)}"


def _missing(experiment: Experiment) -> Iterator[tuple[str, str]]:
    """What a board asks beside, and where it belongs."""
    preflight = experiment.study.preflight
    asked = (
        f"before it a person checks: {'; '.join(preflight)}" if preflight else "no preflight asks"
    )
    yield "consent", f"not in this file; {asked}"
    yield "how long", "not in this file: `retention` in about.yaml; nothing expires by itself"
    yield (
        "withdrawal",
        "until when is not in this file; `woz participants LOGS --code CODE --withdraw` takes out"
        " what is kept, not what has left",
    )
    by = {
        variants.by: (*variants.texts,)
        for action in experiment.actions
        for call in action.calls
        for variants in call.choices.values()
        if variants.by
    }
    chosen = "".join(f"; texts are chosen by {name}: {', '.join(of)}" for name, of in by.items())
    yield (
        "minors",
        f"whether they take part, and who consents for them, is not in this file{chosen}",
    )
