"""What stands between this program and the wizard's terminal and answers in the terminal's place.

Inside tmux, screen and mosh a question to the terminal is answered by them, so that a line that is
lost behind them looks well. tmux and screen can be asked who is attached; mosh cannot.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from woz_tui.machine.program_output import output_of

LineName = Literal["", "tmux", "screen", "mosh"]
#: Programs above this one that are looked through for mosh's server, at most.
_GENERATIONS = 32
#: How long a multiplexer may take to answer, in seconds.
_ANSWER_S = 2.0


@dataclass(frozen=True, slots=True)
class HiddenLine:
    """The line to the wizard, as far as it can be seen from here.

    Attributes:
        name: What stands in it; empty: nothing that is known of.
        ask: The command that lists who is attached; empty: nobody can be asked.
    """

    name: LineName = ""
    ask: tuple[str, ...] = ()

    def clients(self) -> frozenset[str] | None:
        """Who is attached at this moment; None: nobody knows."""
        answer = output_of(self.ask, _ANSWER_S) if self.ask else None
        return None if answer is None else frozenset(answer.split("\n")) - {""}


def hidden_line(environ: Mapping[str, str]) -> HiddenLine:
    """The line of this process. A multiplexer on the wizard's own computer is known by TERM, which
    ssh passes on; it cannot be asked from here.
    """
    if pane := environ.get("TMUX_PANE", "") if environ.get("TMUX") else "":
        return HiddenLine("tmux", ("tmux", "list-clients", "-t", pane, "-F", "#{client_pid}"))
    term = environ.get("TERM", "")
    if environ.get("TMUX") or term.startswith("tmux"):
        return HiddenLine("tmux")
    if session := environ.get("STY"):
        # All that it says of a session is a word in a list, after which it ends as if it had
        # failed.
        script = 'screen -ls "$0" | grep -qE "\\((Multi, )?[Aa]ttached\\)" && echo attached || true'
        return HiddenLine("screen", ("sh", "-c", script, session))
    if term.startswith("screen"):
        return HiddenLine("screen")
    return HiddenLine("mosh") if "mosh-server" in _ancestors() else HiddenLine()


def _ancestors() -> set[str]:
    """Names of the programs that have started this one."""
    names, pid = set(), "self"
    for _ in range(_GENERATIONS):
        try:
            stat = Path("/proc", pid, "stat").read_text(encoding="utf-8", errors="replace")
        except OSError:
            break
        name, _, rest = stat.partition("(")[2].rpartition(")")
        names.add(name)
        pid = rest.split()[1]
    return names
