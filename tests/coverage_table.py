"""Lines that the fast tests run, by room: `make coverage` prints it from what pytest-cov measured."""

import json
import sys
from collections import defaultdict
from pathlib import Path


def table(measured):
    """A Markdown table of the product's rooms, from what `coverage json` wrote."""
    rooms = defaultdict(lambda: [0, 0])
    for name, file in measured["files"].items():
        parts = Path(name).parts
        room = "/".join(parts[:2]) if len(parts) > 2 else parts[0]
        for each in (room, "all"):
            rooms[each][0] += file["summary"]["covered_lines"]
            rooms[each][1] += file["summary"]["num_statements"]
    lines = ["| room | lines | run by tests |", "| --- | ---: | ---: |"]
    for room, (n_run, n_lines) in sorted(rooms.items(), key=lambda item: (item[0] == "all", item[0])):
        lines.append(f"| {room} | {n_lines} | {n_run / max(n_lines, 1):.0%} |")
    return "\n".join(lines)


if __name__ == "__main__":
    sys.stdout.write(table(json.loads(Path(sys.argv[1]).read_text("utf-8"))) + "\n")
