"""Sessions for other programs: tables, ELAN, BIDS and Praat; see docs/export.md."""
