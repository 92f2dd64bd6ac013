"""Quality against time: runs of planning and routing methods side by side, their curves, and which one wins."""
