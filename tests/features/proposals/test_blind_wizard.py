"""What a blind wizard gets of proposals tells nothing: no condition, no reason, no share."""

from __future__ import annotations

import asyncio
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from hypothesis import given
from hypothesis import strategies as st

from tests.host.rig import served_session
from tests.session.rig import experiment
from woz_tui.features.proposals.kinds import (
    ProposedItem,
    SuggestGone,
    SuggestOffered,
    SuggestRanked,
    SuggestTaken,
)
from woz_tui.features.study.design import Design
from woz_tui.features.study.section import DESIGN
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol.welcome import PerceptionView, StudySettings
from woz_tui.session.redactor import Redactor

SECRET = "Only the warm ones hear this"
TELLING = st.sampled_from(
    [("condition",), ("request",), ("transcript",), ("transcript", "loudness")]
)
names = st.sampled_from(["Hello", "Map", "Bye"])


@st.composite
def sets(draw: st.DrawFn) -> list[m.Message]:
    """A set with its end; what tells something has the secret in it."""
    tells = draw(st.just(()) | TELLING)
    text = f"{draw(names)} {SECRET}" if tells else draw(names)
    items = [
        ProposedItem(
            str(i), text=text, verb=draw(st.sampled_from(["", "say"])), args={"text": text}
        )
        for i in range(1, draw(st.integers(1, 3)) + 1)
    ]
    reasons = [f"words {SECRET}" for _ in items]
    offered = SuggestOffered(set="s1", source="program", items=items, tells=tells)
    ranked = SuggestRanked(set="s1", reasons=reasons, scores=[0.25 for _ in items])
    taken = SuggestTaken(set="s1", item="1", how="edited", text=text, tells=tells)
    return [offered, ranked, draw(st.sampled_from([taken, SuggestGone(set="s1", how="expired")]))]


@given(sets())
def test_no_line_that_a_blind_wizard_gets_tells_what_is_kept(messages: list[m.Message]) -> None:
    hidden = PerceptionView(hide=["transcript", "loudness"])
    redactor = Redactor(StudySettings(blind={"warm": "A", "cold": "B"}, perception=hidden))
    assert redactor.blind
    lines = b""
    for message in messages:
        redactor.apply(message)
        if (seen := redactor.message(message)) is not None:
            lines += codec.encode(seen)
    assert SECRET.encode() not in lines
    assert b"0.25" not in lines
    assert b"suggest.ranked" not in lines


def test_nothing_of_them_reaches_the_socket_of_a_blind_wizard() -> None:
    async def scenario(folder: Path) -> None:
        made = experiment(folder)
        design = Design(blind={"warm": "A", "cold": "B"})
        made = replace(made, sections={**made.sections, DESIGN: design})
        async with served_session(folder, made=made) as host:
            wizard = await host.connect()
            await wizard.hello("wizard")
            items = [ProposedItem("1", text=SECRET)]
            publish = host.session.hub.publish
            publish(SuggestOffered(set="s1", source="program", items=items, tells=("condition",)))
            publish(SuggestRanked(set="s1", reasons=[SECRET], scores=[0.5]))
            publish(SuggestGone(set="s1", how="expired"))
            await wizard.kind("suggest.gone")
            assert not [line for line in wizard.seen if SECRET in str(line)]

    with TemporaryDirectory() as folder:
        asyncio.run(scenario(Path(folder)))
