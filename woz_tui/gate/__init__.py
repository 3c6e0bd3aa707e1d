"""Whether something may happen now, and if not why: `table.py` has every reason, in their order."""
