"""A participant withdraws: what is kept of one person is found, and taken out."""
