"""What every room uses: time, files, tasks."""
