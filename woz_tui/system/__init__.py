"""What every room may use: time, files, text that is safe to show."""
