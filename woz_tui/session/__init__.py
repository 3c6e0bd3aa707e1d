"""One session: experiment, drivers, bus, hub and recorder put together."""
