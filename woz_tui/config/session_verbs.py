"""Verbs that need no driver, as experiment files may use them: the session carries them out itself,
those of the section `engagement` its engagement model.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence

from woz_tui.config.engagement_words import (
    CONDITION,
    FILTERS,
    MODES,
    OUTCOMES,
    RUNS,
    SIGNS,
    STATES,
    STOPPED,
)
from woz_tui.drivers.contract import Argument, Verb
from woz_tui.drivers.fields import Range

#: A verb of the session itself: it reaches no hardware, so its end needs no evidence.
own_verb = functools.partial(Verb, evidence="")

#: A pause between steps, in seconds; it is no call.
WAIT = own_verb(
    "wait",
    "wait before the next step",
    (Argument("seconds", "seconds", "how long", required=True, range=Range(0.0, 3600.0, "s")),),
)


def _brief(name: str, summary: str, *arguments: Argument) -> Verb:
    return own_verb(name, summary, arguments, brief=True)


def _sign(*choices: str) -> Argument:
    return _choice("sign", "which sign", *choices)


def _choice(name: str, summary: str, *choices: str) -> Argument:
    return Argument(name, "choice", summary, required=True, choices=choices)


def _text(name: str, summary: str, *, required: bool = False) -> Argument:
    return Argument(name, "text", summary, required=required)


def session_verbs(conditions: Sequence[str] = (), panels: Sequence[str] = ()) -> tuple[Verb, ...]:
    """The verbs with the choices that one experiment allows."""
    panel = Argument("panel", "text", "a panel's title", required=True, choices=tuple(panels))
    return (
        own_verb(
            "mark", "put a marker into the log", (Argument("text", "text", "text of the marker"),)
        ),
        own_verb(
            "note",
            "write a note into the log",
            (Argument("text", "text", "the note", required=True),),
        ),
        own_verb(
            "set",
            "change the condition or the trial",
            (
                Argument("condition", "text", "the condition", choices=tuple(conditions)),
                Argument("trial", "whole", "the trial's number", range=Range(0, 100_000)),
            ),
        ),
        own_verb("lock", "lock a panel", (panel,)),
        own_verb("unlock", "unlock a panel", (panel,)),
    )


def engagement_verbs() -> tuple[Verb, ...]:
    """The verbs of experiments that have a section `engagement`.

    `sense` gives a sign the wizard's value (read by `sign_values.sign_value`) or gives it back to
    its sensor; `force` goes to a state, or takes the way out of the present one with this outcome.
    """
    return (
        _brief(
            "toggle", "set a sign by hand to the opposite of its present value", _sign(*CONDITION)
        ),
        _brief(
            "sense",
            "set a sign by hand, or return it to the sensor",
            _sign(*SIGNS, "all"),
            _text("value", "on, off, metres, a name, or sensor to return it", required=True),
        ),
        _brief(
            "force",
            "go to a state, or leave the present one by an outcome",
            _choice("to", "a state or an outcome", *STATES, STOPPED, *OUTCOMES),
        ),
        _brief(
            "engagement",
            "run, hold or switch off the model, or take one step",
            _choice("run", "what it does", *RUNS, "step"),
        ),
        _brief(
            "filter",
            "set the filter of a sign",
            _sign(*SIGNS, "all"),
            Argument("kind", "choice", "median is for distance only", choices=FILTERS),
            Argument("samples", "whole", "samples in the queue", range=Range(1, 1000)),
            Argument("threshold", "number", "share of them that is needed", range=Range(0, 1)),
        ),
        _brief(
            "social_distance",
            "set the social distance",
            Argument("metres", "number", "from the robot", True, range=Range(0.1, 10, "m")),
        ),
        _brief(
            "attend",
            "set what can distract the robot from an engaged visitor",
            _choice("mode", "distraction mode", *MODES),
        ),
        _brief(
            "handshake",
            "begin or end the introduction",
            _choice("what", "ok needs a name, given here or known before", "begin", "ok", "fail"),
            _text("code", "the visitor's code"),
        ),
        _brief(
            "visitor",
            "set who the visitor is; this also ends a handshake",
            _text("code", "the visitor's code", required=True),
            _text("age_group", "such as child or adult"),
            _text("address", "form of address, such as formal or informal"),
        ),
    )


#: By name, to recognise them where the section is missing.
ENGAGEMENT_VERBS = {verb.name: verb for verb in engagement_verbs()}
