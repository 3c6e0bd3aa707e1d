"""The body's behaviour, as arithmetic: no hardware, no thread, no clock of its own.

`engine.Engine` is asked for the setpoints of a moment and told what people want. Layers, from the
inside out: a *primary* (the pose held, a gaze, a move, a mode), compressed and smoothed; *offsets*
on top of it (breathing); then `safety`, the last and only writer. Angles are degrees, times
seconds, lengths metres; x points forward, y to the robot's left, z up.
"""
