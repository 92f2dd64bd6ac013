"""Use cases of plans: making, editing, comparing, judging and closing them."""
