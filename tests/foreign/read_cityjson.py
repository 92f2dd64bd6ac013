"""What cjio reads in a CityJSON file: `python read_cityjson.py FILE` prints it as JSON.

A process of its own: cjio changes how Python's `json` writes numbers.
"""

import json
import sys
from pathlib import Path

from cjio.cityjson import CityJSON


def main(path: str) -> None:
    """Print what was read."""
    with Path(path).open() as stream:
        model = CityJSON(file=stream)
    model.check_version()
    found = {
        "epsg": model.get_epsg(),
        "n_objects": model.number_city_objects_level1(),
        "box": model.calculate_bbox(),
        "extent": model.j["metadata"]["geographicalExtent"],
        "n_vertices": len(model.j["vertices"]),
    }
    model.remove_duplicate_vertices()
    model.remove_orphan_vertices()
    sys.stdout.write(json.dumps(found | {"n_needed": len(model.j["vertices"])}))


if __name__ == "__main__":
    main(sys.argv[1])
