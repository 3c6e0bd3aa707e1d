"""The whole program, with real processes, terminals, sockets, files and emulated servos."""
