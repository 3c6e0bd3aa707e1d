"""Pictures of several cameras: live for who watches, and kept as files."""
