"""The base of Reflight: sites, coverage, reachability, viewpoint optimisation, routing and plan checks.

Everything here works in one local ENU frame (x east, y north, z up, metres); geodetic coordinates appear only in
`planning.geo`. The package knows nothing of Qt, torch, aircraft protocols or photos.
"""
