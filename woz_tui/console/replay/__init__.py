"""The console in front of a log instead of a robot process: `woz replay`."""
