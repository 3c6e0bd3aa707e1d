"""What robots with NAOqi (Pepper, NAO) have in common: their drivers are made of it."""
