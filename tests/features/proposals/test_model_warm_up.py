"""`woz suggest` warms its model up, and the wizard reads how it stands with it."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.console.piloting import piloted_console
from tests.features.phases.test_phases_on_screen import at
from tests.features.proposals.test_model_program import asked, asking, say, starting, states
from tests.host.rig import ServedSession
from tests.session.rig import with_section
from woz_tui.features.proposals import model_program
from woz_tui.features.proposals.chat import ChatAnswer, ChatClient
from woz_tui.features.proposals.kinds import (
    SuggestAsked,
    SuggestModel,
    SuggestOffered,
    SuggestSettings,
    SuggestState,
)
from woz_tui.features.proposals.section import PROPOSALS, Proposals, SuggestKeysOfFile
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m

pytestmark = pytest.mark.real_clock


@pytest.fixture(autouse=True)
def no_pauses(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(model_program, "AGAIN_S", 0.0)
    monkeypatch.setattr(model_program, "PAUSE_S", 0.01)


def pairs(host: ServedSession) -> list[tuple[str, str]]:
    return [(line.how, line.why) for line in host.of(SuggestState)]


async def test_it_is_loaded_and_has_read_its_prompt_before_anybody_speaks(tmp_path: Path) -> None:
    async with starting(tmp_path) as (host, server):
        await host.until(lambda: "ready" in states(host))
        assert states(host) == ["loading", "ready"]
        (request,) = server.asked
        assert [line["content"] for line in request["messages"]] == ["Suggest.", "Hello."]
        (told,) = host.of(SuggestAsked)
        assert (told.warm_up, told.cue, told.answer) == (True, "", server.text)
        ready = host.of(SuggestState)[-1]
        assert (ready.model, ready.first_us >= 0) == ("small-q4", True)
        (finding,) = host.session.features.findings()
        assert finding.level == "ok"
        assert finding.text.startswith("small-q4 answers: its first word after 0.")
        assert host.of(SuggestOffered) == []


async def test_what_is_said_while_it_loads_is_answered_then(tmp_path: Path) -> None:
    async with starting(tmp_path, fault="hang") as (host, server):
        await host.until(lambda: states(host))
        say(host, "What is this?")
        say(host, "And how old?", 2)
        assert [one.text for one in host.session.features.findings()] == ["the model is loading"]
        server.fault = ""
        server.released.set()
        await host.until(lambda: host.of(SuggestOffered))
        assert [line.cue for line in host.of(SuggestOffered)] == ["ear/2"]
        assert [line["content"] for line in server.asked[-1]["messages"]] == [
            *("Suggest.", "What is this?", "And how old?"),
        ]


async def test_what_somebody_has_answered_meanwhile_is_not(tmp_path: Path) -> None:
    async with starting(tmp_path, fault="hang") as (host, server):
        await host.until(lambda: states(host))
        say(host, "What is this?")
        host.session.play("Hello", RequestOrigin("key", "h", "con1"))
        server.fault = ""
        server.released.set()
        await host.until(lambda: "ready" in states(host))
        await ChatClient(server.url).ask({}, ChatAnswer())  # in this time it could have been asked
        say(host, "Really?", 2)
        await host.until(lambda: host.of(SuggestOffered))
        assert [line.cue for line in host.of(SuggestOffered)] == ["ear/2"]


async def test_a_server_that_reads_its_model_is_not_said_to_fail(tmp_path: Path) -> None:
    async with starting(tmp_path, fault="503") as (host, server):
        await host.until(lambda: ("loading", "loading") in pairs(host))
        server.fault = ""
        await host.until(lambda: "ready" in states(host))
        assert pairs(host) == [("loading", ""), ("loading", "loading"), ("ready", "")]
        assert [bool(line.error) for line in host.of(SuggestAsked)] == [True, False], "once"
        assert host.of(m.Notice) == []


async def test_one_that_is_not_there_is_told_once_and_found_when_it_comes(tmp_path: Path) -> None:
    async with starting(tmp_path, fault="500") as (host, server):
        await host.until(lambda: len(server.asked) > 3)
        (finding,) = host.session.features.findings()
        assert (finding.level, finding.text) == ("warning", "its server refuses")
        server.fault = ""
        await host.until(lambda: "ready" in states(host))
        assert pairs(host) == [("loading", ""), ("failing", "refuses"), ("ready", "")]
        assert len(host.of(m.Notice)) == 1


async def test_one_that_failed_is_asked_again_before_the_visitor_waits_for_it(
    tmp_path: Path,
) -> None:
    async with asking(tmp_path) as (host, server):
        server.fault = "500"
        for segment in range(model_program.FAILURES):
            say(host, "Hm?", segment)
            await host.until(lambda: len(asked(host)) > segment)  # noqa: B023
        await host.until(lambda: "failing" in states(host))
        server.fault = ""
        await host.until(lambda: states(host)[-1] == "ready")
        say(host, "And now?", 9)
        await host.until(lambda: host.of(SuggestOffered))


async def test_an_answer_that_is_dropped_is_named_and_the_next_one_counts(tmp_path: Path) -> None:
    async with asking(tmp_path) as (host, server):
        server.fault = "empty"
        say(host, "What is this?")
        await host.until(lambda: pairs(host)[-1] == ("dropped", ""))
        (finding,) = host.session.features.findings()
        assert finding.text == "it writes no sentence that could be offered"
        server.fault = ""
        say(host, "And now?", 2)
        await host.until(lambda: states(host)[-1] == "ready")
        assert len(host.of(SuggestOffered)) == 1
        assert host.of(m.Notice) == []


async def test_one_that_is_started_anew_is_waited_for(tmp_path: Path) -> None:
    async with asking(tmp_path) as (host, server):
        server.fault = "503"
        say(host, "What is this?")
        await host.until(lambda: ("loading", "loading") in pairs(host))
        server.fault = ""
        await host.until(lambda: host.of(SuggestOffered))
        assert host.of(SuggestOffered)[0].cue == "ear/1"
        assert host.of(m.Notice) == []


async def test_a_file_that_names_no_model_any_more_asks_none(tmp_path: Path) -> None:
    async with asking(tmp_path) as (host, _):
        made = host.experiment
        plain = Proposals(SuggestKeysOfFile(after=0.0))
        host.session.adopt(with_section(made, PROPOSALS, plain), ["suggest"])
        say(host, "What is this?")
        assert [*host.session.features.findings()] == []
        host.session.adopt(made, ["suggest"])
        say(host, "And now?", 2)
        await host.until(lambda: host.of(SuggestOffered))
        assert [line.cue for line in host.of(SuggestOffered)] == ["ear/2"]


async def test_a_program_that_leaves_is_named(tmp_path: Path) -> None:
    async with asking(tmp_path) as (host, _):
        attached = next(each for each in host.of(m.ConsoleAttached) if each.name == "suggest")
        host.session.features.lose(attached.console)
        assert states(host)[-1] == "gone"
        (finding,) = host.session.features.findings()
        assert finding.text == "`woz suggest` does not run: no sentences of a model"
        assert finding.remedy.startswith("woz suggest ")


@pytest.mark.parametrize(
    ("state", "row"),
    [
        (None, "no sentences: `woz suggest` does not run"),
        (SuggestState(how="loading"), "no sentences yet: the model is loading"),
        (SuggestState(how="failing", why="slow"), "no sentences of the model: it takes too long"),
        (SuggestState(how="dropped", why="slow"), "last answer dropped: it takes too long"),
        (SuggestState(how="ready", first_us=1_600_000), "nothing is proposed"),
    ],
)
async def test_the_wizard_reads_why_nothing_comes(state: SuggestState | None, row: str) -> None:
    async with piloted_console(size=(200, 50)) as pilot:
        await at(pilot, SuggestModel(url="http://127.0.0.1:8080/v1"))
        await at(pilot, SuggestSettings(sources=["program", "model"]), 5001)
        if state is not None:
            await at(pilot, state, 5002)
        assert row in pilot.drawn()
        if state is not None and state.how == "ready":
            assert "The model is ready" in pilot.text("EventList")
            assert "first word after 1.6 s" in pilot.text("EventList")
