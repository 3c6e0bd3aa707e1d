"""Tests against programs of others, which `make peers` installs: daemons of robots, servers."""
