"""The connection to the robot process: messages in, requests out."""
