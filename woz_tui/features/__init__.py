"""What is not the core: one package for each feature, with all that it is.

`FEATURES` names them in the order in which their parts are asked. A feature may use those before
it. One that is taken out of the list is not there: a file that uses it is told so.
"""

FEATURES: tuple[str, ...] = (
    "woz_tui.features.study:Study",
    "woz_tui.features.delay:Delay",
    "woz_tui.features.phases:Phases",
    "woz_tui.features.scripts:Scripts",
    "woz_tui.features.choices:Choices",
    "woz_tui.features.slots:Slots",
    "woz_tui.features.people:People",
    "woz_tui.features.profiles:Profiles",
    "woz_tui.features.repairs:Repairs",
    "woz_tui.features.questionnaires:Questionnaires",
    "woz_tui.features.training:Training",
    "woz_tui.features.mcap:Mcap",
    "woz_tui.features.blocks:Blocks",
    "woz_tui.features.lsl:Lsl",
    "woz_tui.features.page:Page",
    "woz_tui.features.bundle:Bundle",
    "woz_tui.features.proposals:Proposals",
    "woz_tui.features.dictation:Dictation",
    "woz_tui.features.move_editor:MoveEditor",
)
