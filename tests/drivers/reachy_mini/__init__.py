"""Tests of the driver for Reachy Mini, on the simulated one."""
