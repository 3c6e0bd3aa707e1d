"""SoftBank's Pepper over NAOqi."""
