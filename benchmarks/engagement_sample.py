"""What one sample costs the engagement model, beside the least that a queue can cost.

    python benchmarks/engagement_sample.py [--samples 200000] [--quick]

Samples of all four signs, some of them missing, go into the model with each kind of filter, and a
step of the machine follows each round as in a session. In turns with them, so that they meet the
same machine, the same samples go into four bare queues whose ones are counted: the floor. Lines of
samples are measured too, from text to text.
"""

from __future__ import annotations

import argparse
import json
import random
import time
from collections import deque
from collections.abc import Callable

from benchmarks.figures import Spread, machine, table, verdict
from woz_tui.config.engagement import EngagementSettings
from woz_tui.config.engagement_words import FILTERS, SIGNS
from woz_tui.sensing.engagement_model import EngagementModel
from woz_tui.sensing.model_time import SECOND
from woz_tui.sensing.sample_rows import SampleRowReader

#: Goal at p50, in microseconds: four signs at 30 Hz take one part in a hundred of a core.
GOAL_US = SECOND / 100 / (len(SIGNS) * 30)
#: Rounds (of four samples) that are timed together.
BATCH = 50
PLACES = 8
#: Microseconds between two rounds.
PERIOD = SECOND // 3

Round = tuple[object, object, object, object]
Way = Callable[[list[Round], int], None]


def rounds(count: int, seed: int = 1) -> list[Round]:
    """Somebody who comes and goes, seen by sensors that err and fail."""
    chance = random.Random(seed)
    made: list[Round] = []
    there = False
    for number in range(count):
        if number % 40 == 0:
            there = not there
        seen = there != (chance.random() < 0.05)
        distance = (0.9 if seen else 3.0) + chance.gauss(0.0, 0.05)
        name = "Anna" if seen and chance.random() < 0.8 else "Unknown"
        one: list[object] = [int(seen), int(seen), distance, name]
        made.append(tuple(None if chance.random() < 0.02 else each for each in one))  # type: ignore[arg-type]
    return made


def through_model(kind: str) -> Way:
    """The whole model with one kind of filter."""
    model = EngagementModel(EngagementSettings(filter=kind, samples=PLACES))

    def way(batch: list[Round], begins: int) -> None:
        for number, values in enumerate(batch):
            model.advance((begins + number) * PERIOD)
            for sign, value in zip(SIGNS, values, strict=True):
                model.sample(sign, value)
            model.step()

    return way


def through_lines() -> Way:
    """Lines of samples, from text to text."""
    model = SampleRowReader(EngagementSettings(samples=PLACES))

    def way(batch: list[Round], begins: int) -> None:
        for number, (presence, gaze, distance, name) in enumerate(batch):
            line = json.dumps(
                {"t": (begins + number) / 3, "presence": presence, "gaze": gaze, "id": name,
                 "distance": distance}
            )  # fmt: skip
            json.dumps(model.add(json.loads(line)))

    return way


def bare() -> Way:
    """Four queues, and how many of each say yes."""
    queues = [deque([False] * PLACES, maxlen=PLACES) for _ in SIGNS]

    def way(batch: list[Round], begins: int) -> None:
        for presence, gaze, distance, name in batch:
            flags = (presence, gaze, isinstance(distance, float) and distance <= 1.3, name)
            for queue, flag in zip(queues, flags, strict=True):
                queue.append(flag == 1)
                sum(queue)

    return way


def measured(count: int) -> dict[str, Spread]:
    """Microseconds per sample, by way."""
    ways = {"bare queues": bare()}
    ways |= {f"the model, {kind}": through_model(kind) for kind in FILTERS}
    ways["lines, fifo"] = through_lines()
    took: dict[str, list[float]] = {name: [] for name in ways}
    made = rounds(count // len(SIGNS))
    for begins in range(0, len(made), BATCH):
        batch = made[begins : begins + BATCH]
        for name, way in ways.items():
            begun = time.perf_counter_ns()
            way(batch, begins)
            took[name].append((time.perf_counter_ns() - begun) / 1000 / len(batch) / len(SIGNS))
    return {name: Spread.of(values) for name, values in took.items()}


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--samples", type=int, default=200_000, help="samples for each way")
    parser.add_argument("--quick", action="store_true", help="a few samples: does it run at all?")
    arguments = parser.parse_args()
    found = measured(8_000 if arguments.quick else arguments.samples)
    floor = found["bare queues"]
    lines = [
        [
            name,
            *(f"{value:.2f}" for value in (spread.p50, spread.p99, spread.worst)),
            *(f"{share:.1f} x" for share in spread.over(floor)),
            "floor" if spread is floor else verdict(spread.p50, GOAL_US),
        ]
        for name, spread in found.items()
    ]
    head = [
        *("one sample (us)", "p50", "p99", "worst", "p50 / floor", "p99 / floor"),
        f"p50 <= {GOAL_US:.0f}",
    ]
    table(f"means of {BATCH} rounds of four samples, {PLACES} places", head, lines)
    print(machine())


if __name__ == "__main__":
    main()
