"""Shows and changes the settings of a whole robot."""
