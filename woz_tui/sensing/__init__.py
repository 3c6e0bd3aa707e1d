"""From raw samples to what the wizard needs to know: filters, sound, distance, engagement."""
