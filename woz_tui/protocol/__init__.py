"""Messages, requests, the welcome, and their form as JSON lines."""
