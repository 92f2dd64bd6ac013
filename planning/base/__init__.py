"""What everything else stands on: errors, findings, progress, files, effects, compiled kernels, parallel work."""
