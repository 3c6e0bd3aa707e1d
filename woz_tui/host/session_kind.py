"""Kinds of sessions without a participant, which features add: what `woz host` does for them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from woz_tui.config.experiment import Experiment
from woz_tui.drivers.contract import Driver
from woz_tui.session.participant_identity import SessionIdentity

if TYPE_CHECKING:  # the options are the command line's
    from argparse import ArgumentParser, Namespace


class SessionKind:
    """A kind of session that an option of `woz host` begins. Everything but the options is as in a
    session with a participant, unless it is told here.
    """

    #: The option that begins such a session.
    flag: str

    def add(self, parser: ArgumentParser) -> None:
        """Declare its options."""
        raise NotImplementedError

    def start(self, arguments: Namespace) -> object | None:
        """With what the feature starts in such a session (`session_features.SessionFeature.start`);
        None: another kind is wanted. Raises `RequestError` where options do not go together.
        """
        raise NotImplementedError

    def identity(self, identity: SessionIdentity, experiment: Experiment) -> SessionIdentity:
        """Whose session it is."""
        return identity

    def experiment(self, experiment: Experiment) -> Experiment:
        """What of the file holds in it."""
        return experiment

    def drivers(self, catalogue: Mapping[str, type[Driver]]) -> Mapping[str, type[Driver]]:
        """The drivers in it, by type."""
        return catalogue
