"""A Pepper that needs no hardware: for rehearsals, demonstrations and tests.

`python -m naoqi_simulator` is a process of its own that speaks NAOqi's protocol. Programs that
play a real Pepper play this one unchanged: it says, moves, drives, shows and hears, everything
takes its time, and people come by who look, talk and leave.

To rehearse, write `robots: [simulated]` in the robot file: the driver `pepper` starts one and ends
it. To look behind its face meanwhile, start it yourself and keep the terminal open:

    python -m naoqi_simulator --port 9559 --control

and write `robots: [127.0.0.1]`. Then type, for example,

    {"do": "fault", "kind": "frozen", "seconds": 5}

and see what your wizard gets to see. `--help` has all of it.

How it is built, from the wire inwards:

- `process.py` is the program, `control.py` its orders by standard input.
- `host_qi.py` and `host_own.py` put services on the wire: with the package `qi`, or with
  `qimessaging`. They know only `table.py`, which says how a service declares its
  methods and signals.
- `pepper.py` puts the robot together. One module for each service: `speech.py` with `tags.py`,
  `motion.py` and `base.py`, `posture.py`, `animations.py` with `library.py`, `life.py`, `leds.py`,
  `tablet.py`, `sounds.py`, `audio.py` with `hearing.py`, `camera.py` with `scene.py`, `memory.py`,
  `senses.py`, `system.py`, and `standin.py`, which no real robot has.
- `world.py` is what they share: time (`passing.py`), what goes on, body, visitors, faults, trace.

Signatures are those of NAOqi 2.5. Words of errors are NAOqi's where they are documented, else
ours in its style. How long speech and animations take, and how loud a voice is, are round figures
of ours: rehearse with it, do not measure a robot by it.
"""
