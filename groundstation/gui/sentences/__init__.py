"""Templates of the sentences that the parts without Qt make, for Qt Linguist and to recognise them by.

One module for each field; `groundstation.services.sentences` says what fields a template has.
"""

from __future__ import annotations
