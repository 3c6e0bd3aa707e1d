"""The gate and what it takes the place of give the same answers, whatever holds."""

from __future__ import annotations

import asyncio
from types import SimpleNamespace
from typing import Any, cast

from hypothesis import given, settings
from hypothesis import strategies as st

from tests.bus.rig import Scripted
from tests.fakes.virtual_time import LoopClock, run_virtual
from woz_tui.bus.bus import ATTACH, Bus
from woz_tui.bus.hub import Hub
from woz_tui.drivers.argument_check import ArgumentError, checked
from woz_tui.drivers.contract import Argument, Verb
from woz_tui.gate.facts import Driving, Facts, Watcher
from woz_tui.gate.questions import SubmitCommand
from woz_tui.gate.table import why_not
from woz_tui.host.dead_man_switch import DeadManSwitch
from woz_tui.host.held_driving import _Hold
from woz_tui.protocol import messages as m

CONSOLES = ("con1", "con2", "con3", "")
PARTS = ("", "voice", "body")


names = st.sampled_from
seldom = st.integers(0, 9).map(lambda number: number == 7)

WATCHERS = st.tuples(st.booleans(), names(PARTS), st.booleans(), names(("", "tmux")))


@given(
    wizards=st.dictionaries(names(CONSOLES[:3]), WATCHERS),
    parts=st.dictionaries(names(CONSOLES[:3]), names(PARTS)),
    keys=st.sets(st.tuples(names(CONSOLES[:3]), names(("w", "s")))),
    unwatched=names(("", "", "", "no wizard's console is attached")),
    console=names(CONSOLES),
    source=names(("key", "midi", "script", "program")),
    key=names(("w", "")),
    driving=names(("auto", "held", "pressed")),
)
@settings(max_examples=500, deadline=None)
def test_a_command_that_drives_is_judged_as_before(
    *,
    wizards: dict[str, tuple[bool, str, bool, str]],
    parts: dict[str, str],
    keys: set[tuple[str, str]],
    unwatched: str,
    console: str,
    source: str,
    key: str,
    driving: str,
) -> None:
    clients = [
        SimpleNamespace(
            name=name,
            part=part,
            silent="it does not respond" if silent else "",
            hello=SimpleNamespace(line=line) if hello else None,
        )
        for name, (silent, part, hello, line) in wizards.items()
    ]

    async def scenario() -> None:
        session: Any = SimpleNamespace(
            bus=SimpleNamespace(unwatched="", watch=None),
            experiment=SimpleNamespace(session=SimpleNamespace(driving=driving)),
            state=SimpleNamespace(actions={}),
        )
        switch = DeadManSwitch(session, lambda: cast(Any, clients))
        switch._parts = parts
        for each in keys:
            switch._held._holds[each] = _Hold("", 0.0)
        command = m.Command(
            command="c1", verb="drive", args={}, source=source, key=key, console=console
        )
        facts = Facts(
            driving=Driving(
                unwatched,
                console,
                parts.get(console),
                [
                    Watcher(
                        each.name,
                        each.part,
                        switch.driving_of(cast(Any, each)) == "held",
                        each.hello.line if each.hello else "",
                    )
                    for each in clients
                    if not each.silent
                ],
                keys,
            )
        )
        refusal = why_not(facts, SubmitCommand(command, Verb("drive", "", drives=True)))
        before = (unwatched, ATTACH) if unwatched else switch._why_not(command)
        assert before == ((refusal.reason, refusal.remedy) if refusal else ("", ""))

    run_virtual(scenario())


@given(
    stopped=seldom,
    why=names(("", "the disk is full")),
    verb=names(("say", "mode", "drive", "nonsense")),
    args=st.fixed_dictionaries(
        {}, optional={"text": names(("Hello", 3)), "mode": st.just("normal")}
    ),
    driver=names(("head", "mind", "nobody")),
    unwatched=names(("", "nobody watches")),
)
@settings(max_examples=300, deadline=None)
def test_a_command_is_judged_as_before(
    *, stopped: bool, why: str, verb: str, args: dict[str, m.Json], driver: str, unwatched: str
) -> None:
    offered = (
        Verb("say", "", (Argument("text", "text", required=True),), lane="voice"),
        Verb("mode", "", (Argument("mode", "text"),)),
        Verb("drive", "", drives=True),
    )

    async def scenario() -> None:
        lines: list[m.AnyMessage] = []
        hub = Hub(LoopClock(asyncio.get_running_loop()), lambda message, line: None)
        hub.listen(lines.append)
        performers = {name: Scripted(name) for name in ("head", "mind")}
        bus = Bus(
            hub,
            performers,
            dict.fromkeys(performers, offered),
            unstopped=frozenset({"mind"}),
            unrecorded=lambda: why,
        )
        bus.latched, bus.unwatched = stopped, unwatched
        command = m.Command(command="c1", verb=verb, args=args, driver=driver, source="program")
        bus.submit(command)
        known, wrong = bus.verb(driver, verb), ""
        try:
            if known is not None:
                checked(known, args)
        except ArgumentError as error:
            wrong = str(error)
        refusal = why_not(
            Facts(stopped=stopped, unrecorded=why, driving=Driving(unwatched)),
            SubmitCommand(command, known, bus._unknown(command), wrong, driver != "mind"),
        )
        refused = [line for line in lines if isinstance(line, m.Refused)]
        before = [(line.code, line.reason, line.remedy) for line in refused]
        assert before == ([(refusal.code, refusal.reason, refusal.remedy)] if refusal else [])

    run_virtual(scenario())
