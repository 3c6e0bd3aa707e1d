"""How often the ranker of proposals puts the wizard's next act among its first three.

    python benchmarks/suggestions.py [--quick]

The world is made up (`suggestion_world.py`): 24 actions, a script of 13 lines in four phases, 11
answers of which each is asked for in six ways, two of them only in sessions that nobody has learnt
from; 12 % of the words are lost, 8 % of the acts are random. 20 times 5 sessions are foretold from
10 others. A leak: 200 sessions, in which one of two conditions has other answers, are learnt
together or by condition, and it is guessed from the lists alone which condition a session has.
"""

from __future__ import annotations

import argparse
import os
import random
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from msgspec.structs import replace

from benchmarks import suggestion_world as world
from benchmarks.figures import machine, percentile, table
from woz_tui.features.proposals.earlier_acts import earlier_acts
from woz_tui.features.proposals.ranker import Act, Moment, Ranker, moments
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m

Pick = Callable[[Moment], Sequence[str]]


def ranker(learnt: Sequence[Sequence[Act]]) -> Ranker:
    """One that has learnt these sessions."""
    found = Ranker(world.about(), world.SCRIPTS)
    for acts in learnt:
        found.learn(acts)
    found.calibrate(learnt)
    return found


def script_alone(moment: Moment) -> Sequence[str]:
    """The script's next three lines: what a wizard sees today."""
    rest = [line for line in moment.script[moment.position :] if line not in moment.played]
    further = [line for lines in world.SCRIPTS.values() for line in lines]
    return [*rest, *(line for line in further if line not in moment.played and line not in rest)]


def by(found: Ranker) -> Pick:
    """The first of its list."""
    return lambda moment: [each.action for each in found.rank(moment)[:3]]


def hits(pick: Pick, held: Sequence[Sequence[Act]]) -> Iterator[tuple[bool, bool, bool]]:
    """Of each act whether something was heard before, whether it was first, and among three."""
    for acts in held:
        for act, moment in moments(acts, world.SCRIPTS):
            three = [*pick(moment)[:3]]
            yield moment.heard is not None, act.action == three[0], act.action in three


class Shares:
    """Top-1 and top-3 of all acts, and of those with and without words before them."""

    def __init__(self) -> None:
        self.counts: Counter[str] = Counter()

    def add(self, found: Iterator[tuple[bool, bool, bool]]) -> None:
        """Count."""
        for heard, first, three in found:
            for kind in ("all", "heard" if heard else "silent"):
                self.counts[kind] += 1
                self.counts[f"{kind} 1"] += first
                self.counts[f"{kind} 3"] += three

    def of(self, kind: str, most: int = 3) -> float:
        """In percent."""
        return 100 * self.counts[f"{kind} {most}"] / max(1, self.counts[kind])

    def row(self) -> list[str]:
        """Cells of a table."""
        return [f"{self.of(k, 1):.0f} / {self.of(k):.0f}" for k in ("all", "silent", "heard")]


def calibration(found: Ranker, held: Sequence[Sequence[Act]], bins: list[list[float]]) -> None:
    """What the first of each list was said to be worth, and whether it was right."""
    for acts in held:
        for act, moment in moments(acts, world.SCRIPTS):
            first = found.rank(moment)[0]
            bins[min(9, int(first.share * 10))] += [first.share, float(first.action == act.action)]


def leak(count: int, *, pooled: bool) -> float:
    """In how many sessions of a hundred the lists tell the condition."""

    def other(acts: Sequence[Act], condition: int) -> list[Act]:
        swap = {"Its size": "Its weight", "Its weight": "Its size"} if condition else {}
        return [Act(swap.get(a.action, a.action), a.phase, a.heard, a.new) for a in acts]

    learnt = [[other(world.session(f"leak {c} {n}"), c) for n in range(10)] for c in (0, 1)]
    apart = [ranker(each) for each in learnt]
    together = ranker([*learnt[0], *learnt[1]])
    right = 0
    chance = random.Random("guess")
    for number in range(count):
        condition = number % 2
        used = together if pooled else apart[condition]
        acts = world.session(f"seen {number}")  # the same behaviour in both: only the lists differ
        alike = [0, 0]
        for _, moment in moments(acts, world.SCRIPTS):
            shown = [each.action for each in used.rank(moment)[:3]]
            for guess in (0, 1):
                alike[guess] += shown == [each.action for each in apart[guess].rank(moment)[:3]]
        guess = chance.randrange(2) if pooled and alike[0] == alike[1] else int(alike[1] > alike[0])
        right += guess == condition
    return 100 * right / count


def cost(actions: int, rounds: int) -> list[float]:
    """Milliseconds of CPU for one list of many actions."""
    names = {
        f"Action {i}": [f"Action {i} about topic{i} and thing{i % 40}"] for i in range(actions)
    }
    found = Ranker(names, {"": [*names][:40]})
    chance = random.Random(1)
    for _ in range(100):
        found.learn([Act(chance.choice([*names]), "", None, i == 0) for i in range(150)])
    taken = []
    for i in range(rounds):
        heard = (i, 2 * i, 3)
        began = time.process_time()
        found.rank(Moment([f"Action {i % actions}"] * 2, "", heard, (), [*names][:40], 3))
        taken.append((time.process_time() - began) * 1000)
    return taken


def load(count: int) -> tuple[float, float]:
    """Seconds of CPU to read so many logs of 150 acts, and to read them again."""
    with tempfile.TemporaryDirectory() as named:
        folder = Path(named)
        os.environ["XDG_CACHE_HOME"] = str(folder / "cache")
        logs = folder / "recordings"
        logs.mkdir()
        for number in range(count):
            start = m.SessionStart(
                session=f"S{number:02}",
                participant="P01",
                condition="",
                wizard="",
                software={},
                experiment="made.yaml",
                experiment_sha256="",
                seed=number,
                clock={},
            )
            lines: list[m.Message] = [start]
            for act in range(150):
                run, word = f"a{act}", f"word{act % 40} said {number}"
                lines.append(m.SpeechText(driver="ear", segment=act, text=word))
                lines.append(m.ActionRequested(run=run, action=f"A{act % 24}", source="key"))
                lines += [m.Note(text="x" * 300)] * 8  # whatever else stands in a log
            text = b"".join(
                codec.encode(replace(line, seq=seq, t=seq)) for seq, line in enumerate(lines)
            )
            (
                logs / f"2026-01-{number % 28 + 1:02}T10-00-{number:02}_P01_S{number:02}.jsonl"
            ).write_bytes(text)
        taken = []
        for _ in range(2):
            began = time.process_time()
            found = earlier_acts([logs], "", "made.yaml")
            taken.append(time.process_time() - began)
            assert len(found.sessions) == count
        return taken[0], taken[1]


def main() -> int:
    """Measure and judge."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--quick", action="store_true")
    quick = parser.parse_args().quick
    seeds, guesses = (2, 4) if quick else (20, 200)
    rows = {
        name: Shares() for name in ("script alone", "0", "1", "5", "10", "10, wording known", "20")
    }
    bins: list[list[float]] = [[] for _ in range(10)]
    for seed in range(seeds):
        held = [world.session(f"held {seed} {n}", heldout=True) for n in range(5)]
        known = [world.session(f"held {seed} {n}", heldout=True, known=True) for n in range(5)]
        rows["script alone"].add(hits(script_alone, held))
        for count in (0, 1, 5, 10, 20):
            found = ranker([*world.sessions(seed, count)])
            rows[str(count)].add(hits(by(found), held))
            if count == 10:
                rows["10, wording known"].add(hits(by(found), known))
                calibration(found, held, bins)
    acts = rows["10"].counts["all"]
    error = sum(abs(sum(b[::2]) - sum(b[1::2])) for b in bins) / max(1, acts)
    together, apart = leak(guesses, pooled=True), leak(guesses, pooled=False)
    taken = cost(300, 20 if quick else 200)
    p99 = percentile(taken, 0.99)
    first, again = load(4 if quick else 50)
    print(machine())
    table(
        f"first / among three (%), {acts} acts of sessions that were not learnt",
        ["learnt", "all", "nothing heard", "heard"],
        [[name, *each.row()] for name, each in rows.items()],
    )
    ten, zero, script = rows["10"], rows["0"], rows["script alone"]
    goals = [
        ("10 sessions: above the script alone", ten.of("all") - script.of("all"), ">=", 6.0),
        ("10 sessions: nothing heard", ten.of("silent"), ">=", 85.0),
        ("10 sessions: heard, known wording", rows["10, wording known"].of("heard"), ">=", 65.0),
        ("10 sessions: heard, new wording", ten.of("heard"), ">=", 45.0),
        ("0 sessions: above the script alone", zero.of("all") - script.of("all"), ">=", -3.0),
        ("calibration error", error, "<=", 0.1),
        ("leak where learnt together: from 50", abs(together - 50), "<=", 8.0),
        ("50 logs, first (s of CPU)", first, "<=", 2.0),
        ("50 logs, again (s of CPU)", again, "<=", 0.1),
        ("p99 of 300 actions (ms)", p99, "<=", 10.0),
    ]
    met = [(value >= goal) if sign == ">=" else (value <= goal) for _, value, sign, goal in goals]
    table(
        f"goals (the lists tell the condition in {apart:.0f} % where learnt apart)",
        ["what", "measured", "goal", "met"],
        [
            [what, f"{value:.2f}", f"{sign} {goal:g}", "yes" if ok else "no"]
            for (what, value, sign, goal), ok in zip(goals, met, strict=True)
        ],
    )
    return 0 if quick or all(met) else 1


if __name__ == "__main__":
    raise SystemExit(main())
