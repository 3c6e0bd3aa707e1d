"""What filters are worth: visitors and sensors that err, made up with a seed, and figures of them.

`sensor_errors` says how sensors fail, `bench_scenes` what visitors do, `bench_figures` which
filters compete, and counts.
"""
