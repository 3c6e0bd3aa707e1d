"""Examples of what is asked of a study's plan, for the golden files of the protocol."""

from woz_tui.features.study.kinds import AskAssign, AskProposal, AskTrial

MESSAGES = ()
REQUESTS = (
    AskProposal(ref=22, participant="P08"),
    AskAssign(ref=23, participant="P08", order=["cold", "warm"]),
    AskTrial(ref=24, what="aborted", text="the head fell asleep"),
)
