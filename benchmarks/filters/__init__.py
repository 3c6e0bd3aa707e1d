"""What filters are worth: visitors and sensors that err, made up with a seed, and figures of them.

`errors` says how sensors fail, `scenes` what visitors do, `candidates` which filters compete,
`trials` plays scenes to filters and `figures` counts. Nothing here runs in a session.
"""
