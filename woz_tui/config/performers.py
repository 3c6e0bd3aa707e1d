"""Who carries out verbs beside the drivers."""

from __future__ import annotations

#: The name under which calls of the session's verbs are addressed.
SESSION = "session"
#: The name under which calls of the engagement model's verbs are addressed.
ENGAGEMENT = "engagement"
#: The name under which calls that play blocks of behaviour are addressed, and their verb.
BML = "bml"
#: Who carries out verbs beside the drivers: no driver may have such a name.
PERFORMERS = (SESSION, ENGAGEMENT, BML)
