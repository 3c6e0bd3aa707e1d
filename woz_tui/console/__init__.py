"""The wizard's screen and keyboard."""
