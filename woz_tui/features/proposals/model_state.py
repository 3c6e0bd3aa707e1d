"""How it stands with the model, as the wizard reads it."""

from __future__ import annotations

from collections.abc import Mapping

from woz_tui.protocol.sentence import Sentence

#: Seconds for a whole answer: what comes later is not offered.
LIMIT_S = 2.5
#: Why a model that is asked does not answer.
WHY: Mapping[str, Sentence] = {
    "slow": Sentence("proposals.model_slow", "it takes too long"),
    "unreachable": Sentence("proposals.model_unreachable", "nobody answers at its address"),
    "refuses": Sentence("proposals.model_refuses", "its server refuses"),
    "loading": Sentence("proposals.model_not_ready", "its server is not ready yet"),
    "cut": Sentence("proposals.model_cut", "its answers break off"),
    "odd": Sentence("proposals.model_odd", "what comes is no answer"),
    "": Sentence("proposals.model_unfit", "it writes no sentence that could be offered"),
}
#: What may help.
LOOK = Sentence(
    "proposals.look_at_server", "look at the program that serves it, and at `woz suggest`"
)


def is_too_slow(first_us: int) -> bool:
    """Whether even the first word came later than a whole answer may."""
    return first_us > LIMIT_S * 1e6
