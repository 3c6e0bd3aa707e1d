"""The study as the wizard and the participant see it: order, trials, questionnaires, what is kept
from the wizard.
"""
