"""A message and a request of each kind, for the golden files."""

from __future__ import annotations

from tests.session.rig import with_section
from woz_tui.config.experiment import Experiment
from woz_tui.features.proposals.kinds import (
    AskDismiss,
    AskModelState,
    AskModelTold,
    AskPropose,
    AskShown,
    AskTake,
    ProposedItem,
    SuggestAsked,
    SuggestGone,
    SuggestModel,
    SuggestOffered,
    SuggestRanked,
    SuggestRehearsed,
    SuggestSettings,
    SuggestShown,
    SuggestState,
    SuggestTaken,
    SuggestTrial,
)
from woz_tui.features.proposals.section import PROPOSALS as SECTION
from woz_tui.features.proposals.section import Proposals

PROPOSALS = (
    SuggestSettings(sources=["program"], programs=["mcp"], after_us=1_000_000),
    SuggestOffered(
        set="s00001",
        source="program",
        who="mcp",
        approval=True,
        items=[
            ProposedItem("1", text="It is a whale.", verb="say", args={"text": "It is a whale."})
        ],
        until=31_000_000,
    ),
    SuggestTaken(
        set="s00001",
        item="1",
        how="edited",
        run="c00041",
        after_us=1_204_000,
        text="It is a blue whale.",
        console="con1",
        tells=("transcript",),
    ),
    SuggestOffered(
        set="s00002",
        source="model",
        who="suggest",
        items=[ProposedItem("1", text="How old are you?"), ProposedItem("2", action="Exhibit")],
        cue="ear/3",
        until=51_000_000,
    ),
    SuggestRanked(set="s00002", reasons=["words", "script"], scores=[0.61, 0.2]),
    SuggestGone(set="s00002", how="other_act"),
    SuggestModel(
        url="http://127.0.0.1:8080/v1",
        name="small",
        sampling={"temperature": 0.0, "seed": 1.0, "max_tokens": 80.0},
        prompt="Suggest two sentences.",
    ),
    SuggestAsked(
        cue="ear/3",
        asked={"model": "small"},
        model="small-q4",
        fingerprint="fp1",
        answer="It is a whale.",
        prompt_sha256="ab12",
        first_us=210_000,
        took_us=640_000,
        error="it took too long",
        warm_up=True,
    ),
    SuggestShown(set="s00002", items=["1", "2"], after_us=41_000, console="con1"),
    SuggestTrial(trial=2, offered=False),
    SuggestRehearsed(cue="q0003", items=["Exhibit", "Hello"], fits=True),
    SuggestState(how="failing", why="slow", model="small-q4", first_us=210_000),
)
REQUESTS = (
    AskTake(ref=61, set="s00001", item="1", text="It is a blue whale.", key="f9", age_us=800),
    AskTake(ref=64, set="s00001", item="1", stale=True),
    AskDismiss(ref=62, set="s00002"),
    AskModelTold(
        ref=65,
        cue="ear/3",
        asked={"model": "small"},
        model="small-q4",
        fingerprint="fp1",
        answer="It is a whale.",
        prompt_sha256="ab12",
        first_us=210_000,
        took_us=640_000,
        error="it took too long",
        given_up=True,
        warm_up=True,
    ),
    AskPropose(
        ref=63,
        texts=["How old are you?"],
        actions=["Exhibit"],
        source="model",
        within=5.0,
        cue="ear/3",
    ),
    AskShown(ref=66, set="s00002", items=["1", "2"]),
    AskModelState(ref=67, how="failing", why="slow", model="small-q4", first_us=210_000),
)


def used(made: Experiment) -> Experiment:
    """The same file with something to do for the feature."""
    return with_section(made, SECTION, Proposals())
