"""Sound as several devices have it: samples and WAV files, a live voice, speech that is noticed."""
