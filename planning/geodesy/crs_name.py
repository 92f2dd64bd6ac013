"""Names of coordinate reference systems, in every form that files use, to PROJ's description of them."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from planning.errors import InputError

if TYPE_CHECKING:
    from pyproj import CRS

_ADV_HORIZONTAL = {"ETRS89_UTM31": 25831, "ETRS89_UTM32": 25832, "ETRS89_UTM33": 25833}
_ADV_HORIZONTAL |= {f"DE_DHDN_3GK{zone}": 31464 + zone for zone in (2, 3, 4, 5)}
_ADV_VERTICAL = {"DE_DHHN12_NOH": 7699, "DE_DHHN85_NOH": 5784, "DE_DHHN92_NH": 5783, "DE_DHHN2016_NH": 7837}
"""Names that the German surveying authorities write instead of EPSG codes (urn:adv:crs:ETRS89_UTM32*DE_DHHN2016_NH)."""


def parse_crs(name: str) -> CRS:
    """Coordinate reference system from its name.

    Understood are `EPSG:7415`, `7415`, `EPSG:25832+7837`, OGC URNs (simple and compound), OGC URLs (likewise), the old
    `epsg.xml#` form, and `urn:adv:crs:` names.

    Raises
    ------
    InputError
        The name means nothing to PROJ, or names something without horizontal coordinates.
    """
    from pyproj import CRS
    from pyproj.exceptions import CRSError

    try:
        crs = CRS.from_user_input(_plain_name(name.strip()))
    except CRSError as error:
        raise InputError(
            f"'{name}' is not a coordinate reference system known here; expected a code such as EPSG:25832, "
            "EPSG:7415 or EPSG:25832+7837"
        ) from error
    horizontal = horizontal_part(crs)
    if not (horizontal.is_projected or horizontal.is_geographic):
        raise InputError(f"'{name}' is a {crs.type_name}; expected a projected or geographic system")
    return crs


def horizontal_part(crs: CRS) -> CRS:
    """The system without the vertical one that it may be compounded with."""
    return crs.sub_crs_list[0] if crs.is_compound else crs


def crs_label(crs: CRS) -> str:
    """Code and name of a system, for messages."""
    codes = [crs.to_epsg()]
    if codes == [None] and crs.is_compound:
        codes = [part.to_epsg() for part in crs.sub_crs_list]
    return crs.name if None in codes else f"EPSG:{'+'.join(str(code) for code in codes)} ({crs.name})"


def _plain_name(name: str) -> str:
    """Name in a form that PROJ itself understands."""
    if codes := re.findall(r"def/crs/EPSG/[\d.]+/(\d+)", name):
        return "EPSG:" + "+".join(codes)
    if old := re.search(r"epsg\.xml#(\d+)$", name):
        return f"EPSG:{old[1]}"
    if adv := re.fullmatch(r"urn:adv:crs:(\w+)(?:\*(\w+))?", name):
        horizontal, vertical = _ADV_HORIZONTAL.get(adv[1]), _ADV_VERTICAL.get(adv[2] or "")
        if horizontal is not None:
            return f"EPSG:{horizontal}" + (f"+{vertical}" if vertical is not None else "")
    return name
