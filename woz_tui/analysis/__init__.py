"""What a session's log says: figures, reports, comparisons, a paragraph for the paper."""
