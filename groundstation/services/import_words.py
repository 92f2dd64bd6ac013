"""Messages of the site import in the words of the window: fields by their label instead of command-line options.

The import says what to do in terms of `ImportOptions`; its messages name them as the command line does. Here every
option stands with the field of `ImportOptions` that it sets.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

FIELDS = {
    "--airspace-margin": "airspace_margin_m",
    "--axis-order": "axis_order",
    "--building": "building",
    "--ceiling": "ceiling_m",
    "--columns": "n_columns",
    "--crs": "crs",
    "--deflection": "deflection_m",
    "--floor": "floor_m",
    "--gap": "gap_m",
    "--grid-tolerance": "grid_tolerance_m",
    "--ground": "ground_z",
    "--height-reference": "height_reference",
    "--home": "home_enu_m",
    "--name": "name",
    "--origin": "origin",
    "--panel-grid": "panel_grids",
    "--rows": "n_rows",
    "--units": "unit",
    "--up": "up",
    "--without-panels": "panels_required",
}
"""Options of `site import` by the field of `ImportOptions` or `PanelGrid` that they set."""

HEIGHT_HINT = " (--height-reference orthometric for sea level)"
"""Of no use in the window, where the origin's height can be given in either reference."""

_OPTION = re.compile(
    r"(?P<option>--[a-z]+(?:-[a-z]+)*)"
    # What stands for, or is, its value: 'a quoted text', WORDS,IN,CAPITALS with or without a code, a number.
    r"(?P<value> '[^']*'| EPSG:CODE| [A-Z]+(?:,[A-Z]+)*\b| -?\d+(?:\.\d+)?(?:e-?\d+)?(?![\w.]*,))?"
)


def in_window_words(text: str, labels: Mapping[str, str], quoted: str = "“{0}”") -> str:
    """A message with the label of a field in place of each option and of the placeholder behind it.

    Parameters
    ----------
    labels
        By field of `ImportOptions` or `PanelGrid`; an option without a label stays as it is.
    quoted
        A label as it stands in a sentence.
    """

    def replaced(found: re.Match[str]) -> str:
        label = labels.get(FIELDS.get(found["option"], ""))
        return found[0] if label is None else quoted.format(label)

    text = text.replace(HEIGHT_HINT, "")
    # The three options of a grid are one step in the window.
    text = re.sub(r"--panel-grid '[^']*' --rows \w+ --columns \w+", "--panel-grid", text)
    return _OPTION.sub(replaced, text)
