"""What is said of reminders in the log and on the socket."""

from __future__ import annotations

from woz_tui.protocol.envelope import Message
from woz_tui.protocol.kinds import FeatureKinds


class ReminderDue(Message, frozen=True, kw_only=True, tag="reminder.due"):
    """The wizard is reminded of `text`, as the experiment file has it."""

    text: str


#: Open: the text is the researcher's, the same for everybody.
KINDS = FeatureKinds(messages=(ReminderDue,), open=(ReminderDue,))
