"""Planned against real times of the sequences that EyePi's own planner asks for, over a broker.

    python benchmarks/bridge_timing.py [--sequences 60] [--quick]

A planner asks for nods, shakes and points in turns, by their start, their stroke and their end, as
the robot has foretold them; `woz bridge` plays them on EyePi without hardware in `woz host`. How
late its feedback comes is seen by the planner, two hops of the broker and two processes away. The
floor is a message that the broker gives back, half there and half back.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import time

from benchmarks.figures import Spread, machine, table
from benchmarks.round_trips import program
from benchmarks.sessions import ROOT, bench
from tests.fakes.stomp_broker import StompBroker
from woz_tui.bridge.ros_data import read_data, write_data
from woz_tui.bridge.stomp_connection import StompConnection, StompPlace, connect_stomp

PREFIX = "/topic/ramsocialrobot_ram."
SEQUENCE, ECHO = f"{PREFIX}animation.hmmm.sequence", f"{PREFIX}echo"
GENERAL, PREDICTION = f"{PREFIX}asap.feedback.general", f"{PREFIX}asap.feedback.prediction"
#: Nod, shake, point left, point right.
SEQUENCES = (3, 4, 5, 7)
START_AT, STROKE_AT, END_AT, PREDICT = 1, 2, 3, 4
#: What feedback says of the progress.
POINTS = {1: "start", 2: "stroke", 3: "end"}
FLOOR = "a message there and back"
#: From the request to the beginning, in seconds.
LEAD_S = 0.3
#: Milliseconds behind the plan, by what was planned.
Late = dict[str, list[float]]


class Planner:
    """Asks for sequences and writes down when it was told what."""

    def __init__(self, connection: StompConnection) -> None:
        self._connection = connection
        self._messages = connection.messages()
        for topic in (GENERAL, PREDICTION, ECHO):
            connection.subscribe(topic)

    def ask(self, ident: str, sequence: int, kind: int, seconds: float) -> None:
        """Ask for a sequence."""
        fields = {"requestType": kind, "request": seconds, "requestCount": 1}
        self._connection.send(SEQUENCE, write_data({"id": ident, "sequence": sequence, **fields}))

    async def foretold(self, ident: str, sequence: int) -> dict[int, float]:
        """When each point would be, in seconds from the beginning."""
        self.ask(ident, sequence, PREDICT, 0.0)
        async for topic, text in self._messages:
            if topic == PREDICTION:
                told = read_data(text)
                stroke, end = told["stroke"], told["duration"]
                assert isinstance(stroke, float) and isinstance(end, float)
                return {1: 0.0, 2: stroke, 3: end}
        raise RuntimeError("the bridge has gone")

    async def played(self, ident: str, sequence: int, kind: int, late: Late) -> None:
        """One sequence, to its end."""
        plan = await self.foretold(ident, sequence)
        asked = time.monotonic()
        self.ask(ident, sequence, kind, LEAD_S + plan[kind])
        async for topic, text in self._messages:
            if topic != GENERAL:
                continue
            told = read_data(text)
            if told["id"] != ident:
                continue
            if told["type"] == 2 and isinstance(point := told["message"], int):
                behind = time.monotonic() - asked - LEAD_S - plan[point]
                late[POINTS[point]].append(behind * 1e3)
                if POINTS[point] == "end":
                    return
            elif not told["message"]:
                raise RuntimeError(f"refused: {told['reason']}")

    async def echoed(self, late: Late) -> None:
        """The floor, once."""
        began = time.monotonic()
        self._connection.send(ECHO, write_data({"id": "echo"}))
        async for topic, _ in self._messages:
            if topic == ECHO:
                late[FLOOR].append((time.monotonic() - began) * 1e3)
                return


async def measured(sequences: int) -> Late:
    """All that was late."""
    late: Late = {key: [] for key in (FLOOR, *POINTS.values())}
    experiment = str(ROOT / "experiments" / "eyepi.yaml")
    async with StompBroker() as broker:
        with contextlib.ExitStack() as opened:
            it = opened.enter_context(bench())
            for ready, *command in (
                ("socket", "-m", "woz_tui", "host", experiment, *it.options(), "--announce"),
                ("connected", "-um", "woz_tui", "bridge", "--stomp", f"127.0.0.1:{broker.port}"),
            ):
                begun = program(*command, ready=ready, environ=it.environ())
                await asyncio.to_thread(opened.enter_context, begun)
            connection = await connect_stomp(StompPlace("127.0.0.1", broker.port))
            planner = Planner(connection)
            await planner.played("warm", SEQUENCES[0], START_AT, {key: [] for key in late})
            for number in range(sequences):
                await planner.echoed(late)
                sequence = SEQUENCES[number % len(SEQUENCES)]
                kind = (START_AT, STROKE_AT, END_AT)[number % 3]
                await planner.played(f"s{number}", sequence, kind, late)
            await connection.close()
    return late


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument("--sequences", type=int, default=60)
    parser.add_argument("--quick", action="store_true", help="only to see that it works")
    arguments = parser.parse_args()
    late = asyncio.run(measured(2 if arguments.quick else arguments.sequences))
    rows = []
    for what, values in late.items():
        spread = Spread.of(values)
        rows.append([what, str(spread.count), f"{spread.p50:.2f}", f"{spread.p99:.2f}"])
        rows[-1].append(f"{spread.worst:.2f}")
    head = ("behind the plan", "count", "p50 ms", "p99 ms", "worst ms")
    table("Sequences of EyePi's planner, told over a broker", head, rows)
    print(f"\n{machine()}")


if __name__ == "__main__":
    main()
