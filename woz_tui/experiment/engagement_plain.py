"""The settings of the engagement model as plain JSON, the form in which a log has them."""

from __future__ import annotations

import msgspec

from woz_tui.core.envelope import Json
from woz_tui.experiment.engagement import EngagementSettings

#: A path of the machine on which the session ran; the model does not look at it.
_LEFT_OUT = "visitors"


def plain(settings: EngagementSettings) -> dict[str, Json]:
    """Every setting, also where it has its default: what a log says holds whatever the defaults of
    later versions are. Only `visitors` is left out, a path that belongs to the machine.
    """
    values: dict[str, Json] = msgspec.json.decode(msgspec.json.encode(settings))
    del values[_LEFT_OUT]
    return values


def settings_from(values: dict[str, Json]) -> EngagementSettings:
    """The settings again; what a later version has added is passed over, what is missing has its
    default. Raises `ValueError` with a sentence if they are no settings.
    """
    try:
        settings = msgspec.convert(values, EngagementSettings)
        problems = settings.problems()
    except msgspec.ValidationError as error:
        raise ValueError(str(error)) from error
    except ArithmeticError as error:
        raise ValueError("rate is no number of samples a second") from error
    if problems:
        raise ValueError("; ".join(f"{name}: {why}" for name, why in problems))
    return settings
