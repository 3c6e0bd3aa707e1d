"""From raw samples to verdicts of signs, states of the conversation and visitors by name."""
