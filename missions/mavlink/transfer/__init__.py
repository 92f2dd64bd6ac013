"""Missions, fences and rally points to a vehicle and back: state machines that do no input or output themselves.

A machine is given messages and the time, and answers with messages to send. Nothing counts as being on the vehicle
before it was read back and compared: `verified.VerifiedUpload`.
"""
