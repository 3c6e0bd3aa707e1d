"""Text, signs, colours and how they get to the terminal."""
