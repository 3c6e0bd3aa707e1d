"""The robot process from here: its start, and the connection: messages in, requests out."""
