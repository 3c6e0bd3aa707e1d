"""Reminders: what the wizard's list of events says at times that the experiment file gives."""

from woz_tui.feature import Feature


class Reminders(Feature):
    """The section `reminders`, and a line for the wizard and the log when one is due."""

    name = "reminders"
    kinds = "kinds:KINDS"
    section = "section:REMINDERS"
    session = "in_session:DueReminders"
    history = "history:ReminderHistory"
    sentences = "console:SENTENCES"
    export = "export:EXPORT"
