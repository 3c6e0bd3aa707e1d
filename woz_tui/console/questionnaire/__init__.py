"""A questionnaire that somebody fills in: its pages, keys and answers."""
