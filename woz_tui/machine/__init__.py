"""What a machine must be good at to play a robot: ports, disk, clock, processor, terminal.

Each check is a small function that returns findings; `woz doctor` shows them all, a session's
preflight those that may change between two participants. Checks look and measure, they change
nothing. `machine_checks.bounded` keeps any of them from hanging or raising.
"""
