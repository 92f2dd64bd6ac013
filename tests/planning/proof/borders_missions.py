"""Where verdicts on missions change: places, angles and speeds that are off, and texts and archives that are odd."""

from __future__ import annotations

import copy
import json
import struct
import zipfile
import zlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from tests.planning.proof.borders import Probe, Section, Verdict, border
from tests.planning.proof.verifiers import PROOF

HEAD = "QGC WPL 110\n0\t1\t0\t16\t0\t0\t0\t0\t0\t0\t0\t1\n"
START, END = "3 22 0 0 0 0 0 0 9", "3 21 0 0 0 0 0 0 0"
PHOTO = (
    *("2 205 -6 0 0 0 0 0 2", "2 115 30 0 0 0 0 0 0", "3 16 5 0 0 0 0.001 0 9"),
    *("2 203 0 0 0 0 1 0 0", "2 93 1 -1 -1 -1 0 0 0"),
)
"""Rows of a mission: frame, command, seven numbers."""

ROWS: tuple[tuple[str, ...], ...] = (
    (),
    PHOTO,
    PHOTO[:4],
    (*PHOTO[:3], "2 532 5 0 0 0 0 0 0", "2 93 2 -1 -1 -1 0 0 0", *PHOTO[3:]),
    *((PHOTO[0], PHOTO[1], f"3 16 {wait} 0 0 0 0.001 0 9", *PHOTO[3:]) for wait in ("-1", "0", "60", "60.5", "100")),
    *((*PHOTO[:4], f"2 93 {wait} -1 -1 -1 0 0 0") for wait in ("-1", "60", "60.5")),
    *((f"3 16 1 0 0 0 {lat} 0 9",) for lat in ("0.000000009", "0.00000001", "0.000000011", "0.000000019", "0")),
    *((f"3 16 1 0 0 0 0 {lon} 9",) for lon in ("0.00000001", "-0.000000011")),
    *((f"3 16 1 0 0 0 0 0 {z}",) for z in ("9.0009", "9.0011", "8.9985")),
    *((f"2 178 1 {speed} -1 0 0 0 0",) for speed in ("15", "1000000", "1000000.5", "1000001", "-1000000.5")),
    ("2 178 1 3 -1 0 0 0 0", "2 202 4 1 2 3 0 0 0", "2 532 1 2 0 0 0 0 0", "2 1001 -2 -2 -1 -1 0 0 0"),
    ("3 16 1 0.5 0 nan 0.001 0 9",),
    tuple(f"3 16 1 0 0 0 {lat} 0 9" for lat in ("0.001", "0.002", "0.001", "0.001")),
    ("3 17 1 0 0 0 0.001 0 9",),
    ("3 16 1 0 0 0 0.001 0",),
    (START,),
)
"""Rows between take-off and landing."""


def _waypoints(rows: Sequence[str]) -> str:
    return HEAD + "".join(f"{n}\t0\t{row.replace(' ', chr(9))}\t1\n" for n, row in enumerate(rows, 1))


def _of_texts(probe: Probe, texts: Iterator[bytes], kind: str) -> Iterator[Any]:
    for text in texts:
        yield probe.said(lambda text=text: vars(probe.module.Mission(text, kind)))


def _lines() -> Iterator[bytes]:
    """Missions in lines."""
    for rows in ROWS:
        yield _waypoints((START, *rows, END)).encode()
    whole = _waypoints((START, *PHOTO, END))
    ground = "3 22 0 0 0 0 0 0 0"
    for rows in ((START,), (END,), (END, START), (ground, "3 16 1 0 0 0 0 0 0.001", END), (ground, *PHOTO, END)):
        yield _waypoints(rows).encode()
    for old, new in (
        ("WPL 110", "WPL 120"),
        ("0\t1\t0\t16", "0\t0\t0\t16"),
        ("\n2\t0\t", "\n3\t0\t"),
        ("\n2\t0\t", "\n2\t1\t"),
        ("\t1\n3\t", "\t0\n3\t"),
        ("\t205\t", "\t205 "),
        ("\t205\t", "\t205\t\t"),
        ("-6", "-6x"),
        ("-6", "1e1"),
        ("-6", "\u0663"),
        ("-6", ".5"),
    ):
        assert old in whole, old
        yield whole.replace(old, new).encode()
    yield whole.removesuffix("\n").encode()
    yield f"{whole}\n".encode()
    yield b""


def _plans(plan: Mapping[str, Any]) -> Iterator[bytes]:
    """A plan with one thing changed."""

    def changed(path: Sequence[Any], value: Any) -> bytes:
        content = copy.deepcopy(plan)
        parent: Any = content
        for key in path[:-1]:
            parent = parent[key]
        if value is None:
            del parent[path[-1]]
        else:
            parent[path[-1]] = value
        return json.dumps(content).encode()

    yield json.dumps(plan).encode()
    for value in ("Map", 1, None):
        yield changed(("fileType",), value)
    for value in (2, "1", None):
        yield changed(("version",), value)
        yield changed(("mission", "version"), value)
    for value in (0, 2, None):
        yield changed(("mission", "globalPlanAltitudeMode"), value)
    for value in ([[0.0, 0.0, 0.0]], None):
        yield changed(("rallyPoints", "points"), value)
    yield changed(("rallyPoints",), None)
    first = ("mission", "items", 0)
    for name, values in {
        "Altitude": (9.0, "8.75", None),
        "AltitudeMode": (0, 2, None),
        "type": ("ComplexItem", None),
        "autoContinue": (False, 1, None),
        "frame": (0, "3", True, 10),
        "command": (82, 22.5, None),
        "params": ([0.0] * 8, [0.0] * 6, []),
        "doJumpId": (9, None),
        "more": (1,),
        "viewpointId": ("v0000",),
    }.items():
        for value in values:
            yield changed((*first, name), value)
    for value in (True, "0", 1.0, [], -0.0, 0.5):
        yield changed((*first, "params", 3), value)
    yield json.dumps(plan).replace("[0.0, 0.0, 0.0, 0.0, 22", "[0.0, 0.0, 0.0, null, 22", 1).encode()
    yield json.dumps(plan).replace("[0.0, 0.0, 0.0, 0.0, 22", "[0.0, 0.0, null, 0.0, 22", 1).encode()


def _member(name: str, text: str, at: int, **changed: Any) -> tuple[bytes, bytes]:
    """A member of an archive and its entry in the directory, as DJI missions are written."""
    packer = zlib.compressobj(-1, zlib.DEFLATED, -15)
    packed = changed.get("packed") or packer.compress(text.encode()) + packer.flush() + changed.get("behind", b"")
    crc, size = zlib.crc32(text.encode()) + changed.get("crc", 0), len(text) + changed.get("size", 0)
    fields = [20, changed.get("flags", 0), changed.get("method", 8), 0, 33, crc, len(packed), size, len(name), 0]
    header = changed.get("mark", b"PK\3\4") + struct.pack("<5H3I2H", *fields) + changed.get("called", name).encode()
    directory = b"PK\1\2\x14\3" + header[4:30] + struct.pack("<3H2I", 0, 0, 0, changed.get("mode", 0o644) << 16, at)
    return header + packed, directory + name.encode()


def archive(template: str, lines: str, *, behind: bytes = b"", **changed: Any) -> bytes:
    """The archive of a DJI mission; what is changed of its second member."""
    first, its_entry = _member("wpmz/template.kml", template, 0)
    second, entry = _member("wpmz/waylines.wpml", lines, len(first), **changed)
    directory = its_entry + entry
    end = struct.pack("<4H2IH", 0, 0, 2, 2, len(directory), len(first) + len(second), 0)
    return first + second + directory + b"PK\5\6" + end + behind


def _archives(kmz: bytes) -> Iterator[bytes]:
    """Archives that are damaged, and texts in them with one thing changed."""
    with zipfile.ZipFile(BytesIO(kmz)) as source:
        template, lines = (source.read(f"wpmz/{name}").decode() for name in ("template.kml", "waylines.wpml"))
    whole = archive(template, lines)
    assert whole == kmz
    yield whole
    for changed in (
        {"flags": 1},
        {"method": 0},
        {"crc": 1},
        {"size": 1},
        {"mark": b"PK\3\5"},
        {"mode": 0o600},
        {"behind": b"x"},
        {"packed": b"x"},
        {"called": "wpmz/waylines.wpmx"},
    ):
        yield archive(template, lines, **changed)
    yield from (whole[:-1], whole + b"x", whole[: len(whole) // 2], b"x" + whole, b"")
    for twice in (template, lines):
        yield archive(twice, twice)
    for old, new in (
        ("<wpml:index>1<", "<wpml:index>2<"),
        ("8.75<", "8.76<"),
        ("<wpml:takeOffSecurityHeight>8.7<", "<wpml:takeOffSecurityHeight>0<"),
        ("<wpml:takeOffSecurityHeight>8.7<", "<wpml:takeOffSecurityHeight>0.5<"),
        ("<wpml:globalRTHHeight>20<", "<wpml:globalRTHHeight>0<"),
        ("<wpml:globalRTHHeight>20<", "<wpml:globalRTHHeight>-1<"),
        ("<wpml:globalTransitionalSpeed>15<", "<wpml:globalTransitionalSpeed>16<"),
        ("<?xml", "<?xmL"),
        ("</kml>\n", "</kml>"),
        ("<Folder>", "<Folder><Folder>"),
        ("goHome", "noAction"),
        ("  </Document>", "x  </Document>"),
        ("coordinates", "Coordinates"),
    ):
        assert old in lines, old
        yield archive(template, lines.replace(old, new))
        yield archive(template.replace(old, new), lines.replace(old, new))
    above = lines.replace("executeHeightMode>relativeToStartPoint", "executeHeightMode>WGS84")
    for mode in ("relativeToStartPoint", "EGM96"):
        other = template.replace("heightMode>relativeToStartPoint", f"heightMode>{mode}")
        for name in ("height", "ellipsoidHeight"):
            higher = other.replace(f"<wpml:{name}>", f"<wpml:{name}>1")
            yield archive(higher, above)
            yield archive(higher, lines)
        yield archive(other, above)


def _of_mission_texts(probe: Probe) -> Iterator[Any]:
    """What is read from missions of each kind, and what is refused."""
    yield from _of_texts(probe, _lines(), ".waypoints")
    for path in sorted(probe.folder.glob("*.plan")):
        yield from _of_texts(probe, _plans(json.loads(path.read_bytes())), ".plan")
    for path in sorted(probe.folder.glob("*.kmz")):
        yield from _of_texts(probe, _archives(path.read_bytes()), ".kmz")
    yield from _of_texts(probe, iter([b"", HEAD.encode()]), ".txt")


def _of_missions_off_the_plan(probe: Probe) -> Iterator[Any]:
    """Homes far from the origin, vertices twice, and places and angles that are off by the limit itself."""
    module, case = probe.module, probe.case()
    mission = module.Mission(next(probe.folder.glob("*.waypoints")).read_bytes(), ".waypoints")
    flies: Callable[[], Any] = lambda: probe.said(lambda: module.flies(case, mission))  # noqa: E731
    home, path = case.home, list(case.paths[0])
    for x, y in ((1999.0, 0.0), (2000.0, 0.0), (2001.0, 0.0), (0.0, -2000.0), (0.0, 2001.0), (-2001.0, -2001.0)):
        case.home = (x, y, home[2])
        yield flies()
    case.home = home
    for k in range(len(path)):
        case.paths = [[*path[: k + 1], *path[k:]]]
        yield flies()
    case.home, case.paths = (0.0, 0.0, 0.0), [[(0.0, 0.0, 0.0), (0.01, 0.0, 0.0), (0.0, 0.0, 0.0)]]
    case.by_id, case.flown = {"v": ("v", (0.01, 0.0, 0.0), 0.0, 0.0)}, [["v"]]
    lat, lon, _ = module.origin_of(case.site)
    mission.places = [(lat, lon, 0.0)] * 2
    for photo in ((0.0, 0.0, 0.0), (0.0, 0.01, 0.0), (0.0, 0.0, -0.01), (0.0, 0.0, 0.0101), (1.0, 0.0, 0.0)):
        mission.photos = [photo]
        yield flies()
    case.paths[0][1] = (0.0100001, 0.0, 0.0)
    yield flies()
    mission.is_relative, case.paths[0][1] = False, (0.01, 0.0, 0.0)
    mission.photos, height = [(0.0, 0.0, 0.0)], module.origin_of(case.site)[2]
    for above in (0.0, height):
        mission.places = [(lat, lon, above)] * 2
        yield flies()


def _of_missions(probe: Probe) -> Iterator[Any]:
    """What missions say, and how far they may be off."""
    module, case = probe.module, probe.case()
    for path in sorted(probe.folder.iterdir()):
        if path.suffix not in (".kmz", ".plan", ".waypoints"):
            continue
        mission = module.Mission(path.read_bytes(), path.suffix)
        yield vars(mission)
        kept = copy.deepcopy(vars(mission))

        def flies(prepare: Callable[[float], None], mission: Any = mission) -> Verdict:
            return lambda x: prepare(x) or probe.said(lambda: module.flies(case, mission))

        for k, axis in [(k, axis) for k in (0, -1) for axis in range(3)]:

            def place(x: float, k: int = k, axis: int = axis, kept: Any = kept, mission: Any = mission) -> None:
                mission.places = list(kept["places"])
                p = mission.places[k]
                mission.places[k] = (*p[:axis], p[axis] + x, *p[axis + 1 :])

            for far in (-1.0, 1.0):
                yield border(flies(place), 0.0, far * (1.0 if axis == 2 else 1e-5))
            mission.places = kept["places"]
        for turn in range(3):

            def photo(x: float, turn: int = turn, kept: Any = kept, mission: Any = mission) -> None:
                mission.photos = list(kept["photos"])
                mission.photos[0] = (
                    *mission.photos[0][:turn],
                    mission.photos[0][turn] + x,
                    *mission.photos[0][turn + 1 :],
                )

            for far in (-1.0, 1.0, 360.0):
                yield border(flies(photo), 0.0, far)
            mission.photos = kept["photos"]
        yield border(flies(lambda x, m=mission: setattr(m, "speeds", [0.0, x])), 0.0, 100.0)
        yield border(flies(lambda x, m=mission: setattr(m, "zooms", [x])), 24.0, 200.0)
        yield border(flies(lambda x, m=mission: setattr(m, "zooms", [x])), 24.0, 0.0)
        mission.speeds, mission.zooms = kept["speeds"], kept["zooms"]
        yield border(flies(lambda x, m=mission: setattr(m, "returns", [x, 18.0])), 18.0, 90.0)
        mission.returns = kept["returns"]
        mission.places = kept["places"][:-1]
        yield probe.said(lambda m=mission: module.flies(case, m))
        mission.places, mission.photos = kept["places"], kept["photos"][:-1]
        yield probe.said(lambda m=mission: module.flies(case, m))


def _of_folders(probe: Probe) -> Iterator[Any]:
    """Which missions belong to which proof."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        names = [
            "a.kmz",
            "a-2.kmz",
            "a-x.kmz",
            "ab.kmz",
            "a.kmz.mission.proof",
            "plan.proof",
            "a.plan",
            "akmz",
            "a+kmz",
        ]
        for each in (*names, "b.proof", "proof", "-3.proof", "a-2.proof"):
            (folder / each).write_bytes((probe.folder / PROOF).read_bytes())
        yield [[path.name for path in job] for job in probe.module.jobs_of(folder)]


SECTIONS: tuple[Section, ...] = (_of_folders, _of_missions_off_the_plan, _of_mission_texts, _of_missions)
