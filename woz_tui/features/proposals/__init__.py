"""Proposals: something proposes, the wizard takes it."""

from woz_tui.feature import CommandLine, Feature


class Proposals(Feature):
    """What programs want to do waits for the wizard. Stands behind what it looks at."""

    name = "proposals"
    kinds = "kinds:KINDS"
    section = "section:PROPOSALS"
    keys = "keys.json"
    sentences = "console:SENTENCES"
    notes = "notes:ShownProposals"
    console = "console:CONSOLE"
    gate = "gate:GATE"
    session = "in_session:ProposalsInSession"
    history = "history:ProposalHistory"
    export = "export:EXPORT"
    figures = "figures:FIGURES"
    gathered = "gathered:GatheredProposals"
    report = "report:REPORT"
    doctor = "doctor:CHECKS"
    command = CommandLine(
        name="suggest",
        summary="ask a language model for sentences that the wizard may take",
        module="command",
        behind="mcp",
    )
