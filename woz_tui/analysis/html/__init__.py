"""A report as one file for the browser: tables, pictures, and a timeline to move in."""
