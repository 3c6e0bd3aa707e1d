"""Shows the wizard the engagement model: who is there, are they engaged, and why."""
