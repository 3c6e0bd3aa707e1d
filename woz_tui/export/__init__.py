"""Sessions for other programs: tables, ELAN, BIDS and Praat; see docs/how-to/export.md."""
