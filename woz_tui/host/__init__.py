"""The robot process: a socket for consoles and programs, and what happens when they vanish."""
