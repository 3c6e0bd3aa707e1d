"""Shows three words, marks when each is on the screen, and lets the robot comment 1.5 s later.

With PsychoPy the words stand in a window; without it they are printed, to try the program out.

    woz run experiments/demo.yaml         # in one terminal
    .venv/bin/python experiments/programs/stimulus.py
"""

from woz_tui.client.blocking import connect

try:
    from psychopy.visual import TextStim, Window
except ImportError:  # the same three calls, without a screen

    class Window:
        def __init__(self, **options):
            self.calls = []

        def callOnFlip(self, function, *args):
            self.calls.append((function, args))

        def flip(self):
            for function, args in self.calls:
                function(*args)
            self.calls.clear()

    class TextStim:
        def __init__(self, win, text):
            self.text = text

        def draw(self):
            print(self.text)


win = Window(fullscr=True)
with connect(name="stimulus") as woz:
    for word in ("whale", "boat", "lighthouse"):
        TextStim(win, text=word).draw()
        win.callOnFlip(woz.mark_soon, f"onset {word}")  # returns at once: no frame is lost
        win.flip()  # what it returns is a time of PsychoPy's own clock
        shown = woz.now()
        done = woz.say(f"This is a {word}.", at=shown + 1.5)  # waits until it has been said
        late_ms = (done.t - done.duration_us) / 1e3 - (shown + 1.5) * 1e3
        print(f"{word}: the robot began {late_ms:.1f} ms after its moment")
