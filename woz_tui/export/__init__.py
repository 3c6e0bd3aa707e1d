"""A session's log in the formats of other programs."""
