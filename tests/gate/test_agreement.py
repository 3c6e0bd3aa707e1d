"""The gate and what it takes the place of give the same answers, whatever holds."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from types import SimpleNamespace
from typing import Any, cast

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.bus.rig import Scripted
from tests.fakes.virtual_time import LoopClock, run_virtual
from tests.session.rig import SessionRig, action, call, experiment, together
from woz_tui.bus.bus import ATTACH, Bus
from woz_tui.bus.hub import Hub
from woz_tui.config.experiment import Experiment, Panel, Profile
from woz_tui.config.session_verbs import ENGAGEMENT
from woz_tui.drivers.argument_check import ArgumentError, checked
from woz_tui.drivers.contract import Argument, Verb
from woz_tui.gate.facts import Driving, Facts, Watcher
from woz_tui.gate.questions import PlayAction, RequestOrigin, SendVerb, SubmitCommand
from woz_tui.gate.table import why_not
from woz_tui.host.dead_man_switch import DeadManSwitch
from woz_tui.host.held_driving import _Hold
from woz_tui.protocol import messages as m
from woz_tui.session.session import Session

CONSOLES = ("con1", "con2", "con3", "")
PARTS = ("", "voice", "body")
TITLES = ("Speech", "Body", "Mind")
VERBS = ("say", "play", "drive", "mark", "mode", "control")
ACTIONS = ("Hello", "Nod", "Normal", "Sense", "Empty", "Never", "Filler", "Nothing")


@dataclass(frozen=True)
class Case:
    """What the file says, what holds, and what is asked."""

    file: tuple[tuple[bool, frozenset[str], frozenset[str]], ...]
    profile: Profile | None
    locked: dict[str, bool]
    phase: bool
    by_phase: frozenset[str]
    ended: bool
    stopped: bool
    unrecorded: str
    consoles: dict[str, tuple[str, str]]
    driver_part: str
    name: str
    verb: str
    args: dict[str, m.Json]
    source: str
    console: str
    at: int


names = st.sampled_from
profiles = st.builds(
    Profile,
    panels=st.frozensets(names(TITLES)),
    actions=st.frozensets(names(ACTIONS)),
    controls=st.frozensets(names(("pan", "tilt"))),
    verbs=st.frozensets(names(VERBS)),
    name=st.just("child"),
)
covers = st.frozensets(names((*VERBS, "robot.say", "left.play")))
seldom = st.integers(0, 9).map(lambda number: number == 7)
cases = st.builds(
    Case,
    file=st.tuples(*[st.tuples(seldom, covers, st.frozensets(names(PARTS[1:])))] * 3),
    profile=st.none() | st.none() | profiles,
    locked=st.dictionaries(names(TITLES), seldom),
    phase=st.booleans(),
    by_phase=st.frozensets(names(TITLES)),
    ended=seldom,
    stopped=names((False, False, True)),
    unrecorded=seldom.map(lambda full: "the disk is full" if full else ""),
    consoles=st.dictionaries(
        names(CONSOLES[:3]),
        st.tuples(names(("wizard", "wizard", "program")), names(PARTS)),
        min_size=1,
    ),
    driver_part=names(PARTS),
    name=names(ACTIONS),
    verb=names(VERBS),
    args=st.fixed_dictionaries(
        {},
        optional={
            "text": names(("Hello", 3)),
            "mode": names(("normal", "hand")),
            "control": names(("pan", "neck")),
            "move": st.just("nod"),
        },
    ),
    source=names(("key", "script", "phase", "program", "midi", "palette")),
    console=names((*CONSOLES, "robot")),
    at=names((0, 0, 1, 10**12, 5_000_000)),
)


def made(case: Case, folder: Path) -> Experiment:
    base = experiment(folder)
    actions = {
        "Speech": (
            action("Hello", together(call("say", text="Hello"))),
            action("Never", together(call("say", text="x")), locked=True),
        ),
        "Body": (
            action("Nod", together(call("play", move="nod")), panel="Body"),
            action("Normal", together(call("mode", mode="normal")), panel="Body"),
        ),
        "Mind": (
            action("Sense", together(call("sense", ENGAGEMENT, sign="face")), panel="Mind"),
            action("Empty", panel="Mind"),
        ),
    }
    panels = tuple(
        Panel(title, actions[title], base.panels[0].place, locked, tuple(covered), tuple(parts))
        for title, (locked, covered, parts) in zip(TITLES, case.file, strict=True)
    )
    repairs = (action("Filler", together(call("say", text="Well")), panel="Repairs"),)
    drivers = tuple(replace(each, part=case.driver_part) for each in base.drivers)
    return replace(base, panels=panels, repairs=repairs, drivers=drivers)


def hold(case: Case, session: Session) -> None:
    """Let hold what the case says."""
    session.locked |= case.locked
    session.phases.locked.update(case.by_phase)
    session.profiles.current = case.profile
    session.bus.latched = case.stopped
    for name, (role, part) in case.consoles.items():
        session.state.consoles[name] = m.ConsoleAttached(console=name, role=role, part=part)
    session.recorder._writable = not case.unrecorded  # what full disks do in a thread of their own
    session.recorder._failed = case.unrecorded


@given(cases)
@settings(max_examples=300, deadline=None, suppress_health_check=list(HealthCheck))
def test_an_action_and_a_verb_are_judged_as_before(case: Case) -> None:
    with TemporaryDirectory() as folder:
        rig = SessionRig(Path(folder), made=made(case, Path(folder)))

        async def scenario(rig: SessionRig) -> None:
            session = rig.session
            hold(case, session)
            session.ended = case.ended
            try:
                _compare(case, session)
            finally:
                session.ended = False
                session.recorder._writable, session.recorder._failed = True, ""

        rig.run(scenario)


def _compare(case: Case, session: Session) -> None:
    found = session.experiment.action(case.name)
    old = RequestOrigin(case.source, "", case.console)
    new = RequestOrigin(case.source, "", case.console)
    facts = session.facts()
    question = PlayAction(
        case.name, found, new, at=case.at, repair=found in session.experiment.repairs
    )
    reason = session._why_not(case.name, old)
    remedy = session._what_would_help(found, old) if reason else ("", "")
    refusal = why_not(facts, question)
    told = refusal.reason if refusal else ""
    assert told == (reason or session._no_moment(case.at))
    if refusal and not (refusal.code == "profile" and facts.stopped):
        assert (refusal.remedy, refusal.command) == remedy

    if not session.ended:
        wrong = ""
        robot = case.console != "robot"
        sent = session._call("say", case.args, "") if robot else None
        driver = sent.driver if sent else "left"
        sent = replace(
            sent or session._call("say", {}, ""), verb=case.verb, args=case.args, driver=driver
        )
        known = session.bus.verb(sent.driver, sent.verb)
        try:
            if known is not None:
                checked(known, sent.args)
        except ArgumentError as error:
            wrong = str(error)
        before = session._no_verb(sent, old)
        if before is None and case.at:
            before = session._no_later_verb(sent, case.at)
        asked = SendVerb(sent.verb, sent.args, sent.driver, new, at=case.at, wrong=wrong)
        after = why_not(facts, asked)
        one = before and (before.code, before.reason, before.hint, before.command)
        other = after and (after.code, after.reason, after.remedy, after.command)
        assert one == other


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
