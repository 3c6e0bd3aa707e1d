"""The contract of drivers, what they are given, and how they are found."""
