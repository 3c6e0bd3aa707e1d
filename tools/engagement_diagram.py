"""The states of a conversation, drawn and as a table, from the table that the program runs on."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from html import escape

from tools import replaced
from woz_tui.console.drawing.theme import DARK
from woz_tui.sensing.state_machine import EDGES, ENGAGED, Edge, State

WIDTH, HEIGHT = 1380, 600
#: Where the states stand: the middles of their boxes.
PLACES: Mapping[State, tuple[int, int]] = {
    State.STOP: (115, 90),
    State.WAIT: (115, 300),
    State.DETECTED: (445, 300),
    State.UNKNOWN: (445, 90),
    State.HANDSHAKE: (755, 90),
    State.KNOWN: (755, 300),
    State.ROBOT_SPEAKS: (755, 510),
    State.USER_SPEAKS: (1030, 110),
    State.THINKS: (1165, 300),
    State.REPLIES: (1030, 490),
}
HALF_WIDE, HALF_HIGH = 90, 24
#: How far beside each other two opposite arrows lie: those that run across, and those up and down.
ASIDE = (11.0, 34.0)
#: Where on its arrow a label stands (share of the way), and how far it is moved right and down.
LABELS: Mapping[tuple[State, State], tuple[float, float, float]] = {
    (State.KNOWN, State.USER_SPEAKS): (0.62, 6, 0),
    (State.HANDSHAKE, State.KNOWN): (0.22, 0, 0),
    (State.THINKS, State.KNOWN): (0.45, 0, 0),
    (State.USER_SPEAKS, State.KNOWN): (0.38, -2, 6),
    (State.REPLIES, State.KNOWN): (0.34, 0, 6),
}

#: Where the arrows of a visitor who has left leave a state: right of its middle, and up or down.
#: They are drawn as one that is short, so that it crosses nothing.
LEAVES: Mapping[State, tuple[int, int]] = {
    State.HANDSHAKE: (60, -1),
    State.USER_SPEAKS: (60, -1),
    State.THINKS: (60, -1),
    State.REPLIES: (60, 1),
    State.ROBOT_SPEAKS: (60, 1),
}
SHORT = 34

ABSENT = "nobody is there; where `timeouts.absent` is set, for so long"
REPLACED = "identity has another name than that of whoever spoke"
UNENGAGED = "not engaged, for `timeouts.unengaged` at least"
#: The conditions in words, by the state left and the outcome, in the table's order.
CONDITIONS: Mapping[str, tuple[str, ...]] = {
    "Wait end": ("somebody ends it by hand",),
    "Wait human_presence": ("presence says 1",),
    "PersonDetected human_absence": (
        "presence says 0",
        "`timeouts.approach` has passed since they were detected",
    ),
    "PersonDetected recognized": ("engaged, and identity has a name",),
    "PersonDetected unrecognized": (
        "engaged without a name, for `timeouts.unrecognized` at least",
    ),
    "EngagedWithUnknown error": ("not engaged, for `timeouts.lost` at least",),
    "EngagedWithUnknown handshake": ("engaged, and there may be a handshake",),
    "EngagedWithUnknown recognized": ("engaged, and identity has a name after all",),
    "Handshake eng2know": ("the handshake found a name",),
    "Handshake eng2unknow": ("the handshake failed", "`handshake.seconds` have passed"),
    "Handshake human_absence": (ABSENT,),
    "EngagedWithKnown error": ("not engaged, for `timeouts.lost` at least",),
    "EngagedWithKnown listening": ("somebody begins to speak",),
    "EngagedWithKnown speaking": ("the robot begins to speak",),
    "UserSpeaks done": ("the speech has ended",),
    "UserSpeaks error": (
        *("nothing was understood", "`timeouts.listening` has passed"),
        *(REPLACED, UNENGAGED),
    ),
    "UserSpeaks human_absence": (ABSENT,),
    "RobotThinks done": ("the answer begins",),
    "RobotThinks error": ("`timeouts.thinking` has passed", REPLACED, UNENGAGED),
    "RobotThinks human_absence": (ABSENT,),
    "RobotReplies done": ("the answer is over, spoken or stopped",),
    "RobotReplies error": ("`timeouts.talking` has passed", REPLACED, UNENGAGED),
    "RobotReplies human_absence": (ABSENT,),
    "RobotSpeaks done": ("its sentence is over, spoken or stopped",),
    "RobotSpeaks error": ("`timeouts.talking` has passed",),
    "RobotSpeaks human_absence": (ABSENT,),
}


def origin(edge: Edge) -> str:
    """Where an edge comes from: the figure, the published program, or this project."""
    if edge.letter:
        return "paper"
    return "program" if edge.listing else "ours"


# -- the table ------------------------------------------------------------------------------------


def table() -> str:
    """All edges as a table in Markdown, in the order in which they are tried."""
    seen: dict[str, int] = {}
    lines = ["| from | to | outcome | when | source |", "|---|---|---|---|---|"]
    for edge in EDGES:
        key = f"{edge.source} {edge.outcome}"
        number = seen[key] = seen.get(key, -1) + 1
        source = f"paper, {edge.letter}" if edge.letter else origin(edge)
        lines.append(
            f"| {edge.source} | {edge.target} | `{edge.outcome}` | {CONDITIONS[key][number]} "
            f"| {source} |"
        )
    return "\n".join(lines)


def refreshed(page: str) -> str:
    """`page` with the table as it is today."""
    return replaced(page, "edges", table())


# -- the picture ----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Arrow:
    """All edges from one state to another: where it begins and ends."""

    edges: tuple[Edge, ...]
    begin: tuple[float, float]
    end: tuple[float, float]

    def at(self, share: float) -> tuple[float, float]:
        """A point on the way."""
        (x1, y1), (x2, y2) = self.begin, self.end
        return x1 + (x2 - x1) * share, y1 + (y2 - y1) * share


def arrows() -> Iterator[Arrow]:
    """One arrow for each pair of states; one for a visitor who has left, wherever it leads."""
    pairs: dict[tuple[State, State], list[Edge]] = {}
    for edge in EDGES:
        target = State.WAIT if edge.unnamed else edge.target
        pairs.setdefault((edge.source, target), []).append(edge)
    for (source, target), edges in pairs.items():
        begin, end = PLACES[source], PLACES[target]
        if all(edge.unnamed for edge in edges):
            beside, way = LEAVES[source]
            x, y = begin[0] + beside, begin[1] + way * (HALF_HIGH + 2)
            yield Arrow(tuple(edges), (x, y), (x, y + way * SHORT))
            continue
        across, down = end[0] - begin[0], end[1] - begin[1]
        length = math.hypot(across, down)
        aside = ASIDE[abs(down) > abs(across)] if (target, source) in pairs else 0.0
        right, below = down / length * aside, -across / length * aside
        first, last = (begin[0] + right, begin[1] + below), (end[0] + right, end[1] + below)
        yield Arrow(tuple(edges), edge_of(begin, first, last), edge_of(end, last, first))


def edge_of(
    box: tuple[float, float], start: tuple[float, float], towards: tuple[float, float]
) -> tuple[float, float]:
    """Where a line from `start`, inside the box around `box`, leaves it on its way to `towards`."""
    across, down = towards[0] - start[0], towards[1] - start[1]
    shares = [1.0]
    for away, move, half in (
        (start[0] - box[0], across, HALF_WIDE + 4),
        (start[1] - box[1], down, HALF_HIGH + 4),
    ):
        if move:
            shares.append((math.copysign(half, move) - away) / move)
    share = min(shares)
    return start[0] + across * share, start[1] + down * share


def drawn_arrow(arrow: Arrow) -> str:
    """Its line and its label: letters and outcomes, one under the other."""
    kinds = [origin(edge) for edge in arrow.edges]
    kind = next(kind for kind in ("paper", "program", "ours") if kind in kinds)
    (x1, y1), (x2, y2) = arrow.begin, arrow.end
    line = f'd="M{x1:.0f} {y1:.0f}L{x2:.0f} {y2:.0f}"'
    return f'<path class="{kind}" {line} marker-end="url(#{kind})"/>{label(arrow)}'


def label(arrow: Arrow) -> str:
    """The words beside an arrow, on its left."""
    first = arrow.edges[0]
    if first.unnamed:
        x, y = arrow.at(0.7)
        targets = dict.fromkeys(edge.target for edge in arrow.edges)
        return "".join(
            f'<text class="{origin(first)}" x="{x + 8:.0f}" y="{y + 4 + 15 * row:.0f}">'
            f"{'or' if row else 'to'} {target}</text>"
            for row, target in enumerate(targets)
        )
    share, right, below = LABELS.get((first.source, first.target), (0.5, 0.0, 0.0))
    x, y = arrow.at(share)
    across, down = arrow.end[0] - arrow.begin[0], arrow.end[1] - arrow.begin[1]
    length = math.hypot(across, down)
    aside = (down / length, -across / length)
    anchor = "middle" if abs(aside[0]) < 0.5 else ("start" if aside[0] > 0 else "end")
    x, y = x + 9 * aside[0] + right, y + 14 * aside[1] + below + 4
    lines: dict[str, str] = {}
    for edge in arrow.edges:
        words = f"{edge.letter}  {edge.outcome}" if edge.letter else edge.outcome
        lines.setdefault(words, origin(edge))
    up = (len(lines) - 1) * 15 * min(max(0.5 - aside[1], 0.0), 1.0)
    return "".join(
        f'<text class="{kind}" x="{x:.0f}" y="{y - up + 15 * row:.0f}" '
        f'text-anchor="{anchor}">{escape(words)}</text>'
        for row, (words, kind) in enumerate(lines.items())
    )


def drawn_state(state: State) -> str:
    """A box with its name; states in which somebody is with the robot are filled."""
    x, y = PLACES[state]
    kind = "stop" if state is State.STOP else "with" if state in ENGAGED else "without"
    return (
        f'<rect class="{kind}" x="{x - HALF_WIDE}" y="{y - HALF_HIGH}" width="{2 * HALF_WIDE}" '
        f'height="{2 * HALF_HIGH}" rx="12"/>'
        f'<text class="name" x="{x}" y="{y + 5}" text-anchor="middle">{state}</text>'
    )


def style() -> str:
    """Colours of the console's dark theme."""
    told, ground = DARK.variables, DARK.background
    muted, plain = told["woz-muted"], DARK.foreground
    return (
        "text{font:13px ui-sans-serif,Helvetica,DejaVu Sans,sans-serif;"
        f"paint-order:stroke;stroke:{ground};stroke-width:4px;stroke-linejoin:round;fill:{plain}}}"
        "text.name{font-weight:bold;stroke:none}"
        f"text.program,text.ours{{fill:{muted}}}text.ours{{font-style:italic}}"
        f"path{{fill:none;stroke:{plain};stroke-width:1.6}}"
        f"path.program{{stroke:{muted};stroke-dasharray:7 4}}"
        f"path.ours{{stroke:{muted};stroke-dasharray:2 4}}"
        f"marker path{{fill:{plain};stroke:none}}marker.dim path{{fill:{muted}}}"
        f"rect.with{{fill:{DARK.primary};fill-opacity:.28;stroke:{DARK.primary}}}"
        f"rect.without{{fill:none;stroke:{plain}}}"
        f"rect.stop{{fill:none;stroke:{muted};stroke-dasharray:7 4}}"
    )


def key() -> str:
    """What the lines mean."""
    rows = (
        ("paper", "in the paper's figure, with its letter"),
        ("program", "only in the published program"),
        ("ours", "added here; the short ones for a visitor who has left"),
    )
    return "".join(
        f'<path class="{kind}" d="M30 {HEIGHT - 78 + 24 * row}h46"/>'
        f'<text class="{kind}" x="86" y="{HEIGHT - 74 + 24 * row}">{words}</text>'
        for row, (kind, words) in enumerate(rows)
    )


def svg() -> str:
    """The whole picture."""
    markers = "".join(
        f'<marker id="{kind}" class="{dim}" viewBox="0 0 10 10" refX="9" refY="5" '
        'markerWidth="8" markerHeight="8" markerUnits="userSpaceOnUse" orient="auto">'
        '<path d="M0 0L10 5L0 10z"/></marker>'
        for kind, dim in (("paper", ""), ("program", "dim"), ("ours", "dim"))
    )
    parts = [drawn_arrow(arrow) for arrow in arrows()]
    lines = "".join(part.partition("<text")[0] for part in parts)
    words = "".join(part[part.index("<text") :] for part in parts)
    states = "".join(drawn_state(state) for state in PLACES)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" '
        f'width="{WIDTH}" height="{HEIGHT}"><title>The states of a conversation</title>'
        f"<style>{style()}</style><defs>{markers}</defs>"
        f'<rect width="{WIDTH}" height="{HEIGHT}" rx="8" fill="{DARK.background}"/>'
        f"{lines}{states}{words}{key()}</svg>\n"
    )
