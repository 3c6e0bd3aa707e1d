"""Messages of a session become what holds at a moment (`SessionState`) and what lasted
(`Episode`): how a command ended, which trial it was in, when an engagement began is decided here
and nowhere else. Pure: no clock, no files.
"""
