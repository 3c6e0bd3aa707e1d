"""Training of wizards: cues, answers, scores."""
