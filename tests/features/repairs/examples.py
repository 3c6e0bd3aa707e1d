"""A file that uses repairs."""

from dataclasses import replace

from tests.session.rig import HERE
from woz_tui.config.experiment import Action, Experiment
from woz_tui.features.repairs.section import PANEL, REPEAT


def used(made: Experiment) -> Experiment:
    """The same file with something to do for the feature."""
    return replace(made, beside_panels=(Action(REPEAT, REPEAT, "", PANEL, (), HERE),))
