"""Commands to drivers: queues, workers, deadlines, and the stop that none of them can delay."""
