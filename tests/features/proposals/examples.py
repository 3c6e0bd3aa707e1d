"""A message and a request of each kind, for the golden files."""

from __future__ import annotations

from woz_tui.features.proposals.kinds import (
    AskDismiss,
    AskPropose,
    AskTake,
    ProposedItem,
    SuggestGone,
    SuggestOffered,
    SuggestRanked,
    SuggestSettings,
    SuggestTaken,
)

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
)
REQUESTS = (
    AskTake(ref=61, set="s00001", item="1", text="It is a blue whale.", key="f9", age_us=800),
    AskTake(ref=64, set="s00001", item="1", stale=True),
    AskDismiss(ref=62, set="s00002"),
    AskPropose(
        ref=63,
        texts=["How old are you?"],
        actions=["Exhibit"],
        source="model",
        within=5.0,
        cue="ear/3",
    ),
)
