"""What the console knows, and its words for it; nothing here draws."""
