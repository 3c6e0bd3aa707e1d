"""What the wizard may use at the moment: everything, or what a profile of the experiment names.

The stop, its release, marks, notes and whatever drivers do by themselves are no affair of profiles.
"""

from __future__ import annotations

from collections.abc import Callable

from woz_tui.config.experiment import Experiment, Profile
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError


class ProfileLimits:
    """Knows the profile in use; what it does not allow is said by the gate.

    Args:
        publish: Publishes that another one is in use.
    """

    def __init__(self, publish: Callable[[m.ProfileChanged], object]) -> None:
        self._publish = publish
        self.current: Profile | None = None

    def use(self, name: str, experiment: Experiment, source: str) -> None:
        """Use the profile `name` of `experiment`, or none if it is empty.

        Raises `RequestError` if there is no such profile.
        """
        known = experiment.profiles
        if name and name not in known:
            raise RequestError(
                f"there is no profile {name!r}",
                f"there are {', '.join(known)}" if known else "the file has no profiles",
            )
        self.current = known[name] if name else None
        self._publish(m.ProfileChanged(profile=name, source=source))

    def adopt(self, experiment: Experiment) -> str:
        """Go on with a file that was read again. A profile that has gone from it holds on, because
        nobody said that everything may be used now; a sentence then says so.
        """
        if self.current is None:
            return ""
        name = self.current.name
        if name not in experiment.profiles:
            return f"the profile {name} was removed from the file, but is still in use"
        self.current = experiment.profiles[name]
        return ""
