"""Messages in the words of the window: fields by their label instead of command-line options.

The parts without Qt say what to do as the command line does; whoever shows it knows what its fields are called.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

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
        By option, such as `--origin`; one without a label stays as it is.
    quoted
        A label as it stands in a sentence.
    """

    def replaced(found: re.Match[str]) -> str:
        label = labels.get(found["option"])
        return found[0] if label is None else quoted.format(label)

    # The three options of a grid are one step in the window.
    text = re.sub(r"--panel-grid '[^']*' --rows \w+ --columns \w+", "--panel-grid", text)
    return _OPTION.sub(replaced, text)
