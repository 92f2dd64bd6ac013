"""Reads binary glTF by its specification, and nothing of ours: the other half of round trips."""

from __future__ import annotations

import json
import struct
from itertools import pairwise

import numpy as np

DTYPES = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
CELLS = {"FLOAT64": "<f8", "INT32": "<i4", "INT64": "<i8"}

SPLATTING, FEATURES, METADATA = "KHR_gaussian_splatting", "EXT_mesh_features", "EXT_structural_metadata"


class Glb:
    """A file of one JSON chunk and at most one of numbers."""

    def __init__(self, content: bytes) -> None:
        magic, version, length = struct.unpack_from("<4sII", content)
        assert (magic, version, length) == (b"glTF", 2, len(content))
        n_json, kind = struct.unpack_from("<I4s", content, 12)
        assert kind == b"JSON"
        assert n_json % 4 == 0
        self.json = json.loads(content[20 : 20 + n_json].decode())
        rest = content[20 + n_json :]
        self.buffer = b""
        if rest:
            n_bytes, kind = struct.unpack_from("<I4s", rest)
            assert kind == b"BIN\0"
            assert n_bytes == len(rest) - 8 == self.json["buffers"][0]["byteLength"]
            self.buffer = rest[8:]

    def view(self, number: int) -> bytes:
        view = self.json["bufferViews"][number]
        assert view["byteOffset"] % 8 == 0
        assert view["byteLength"] > 0
        assert view["byteOffset"] + view["byteLength"] <= len(self.buffer)
        return self.buffer[view["byteOffset"] : view["byteOffset"] + view["byteLength"]]

    def numbers(self, accessor: int) -> np.ndarray:
        found = self.json["accessors"][accessor]
        values = np.frombuffer(self.view(found["bufferView"]), DTYPES[found["componentType"]])
        values = values.reshape(found["count"], WIDTHS[found["type"]])
        if "min" in found:
            assert values.min(axis=0).tolist() == found["min"]
            assert values.max(axis=0).tolist() == found["max"]
        if found.get("normalized"):
            values = values / np.float64(np.iinfo(values.dtype).max)
        return values[:, 0] if found["type"] == "SCALAR" else values

    @property
    def primitives(self) -> dict:
        """Of meshes, by the mesh's name."""
        return {mesh["name"]: mesh["primitives"][0] for mesh in self.json.get("meshes", [])}

    def attributes(self, mesh: str) -> dict:
        return {name: self.numbers(number) for name, number in self.primitives[mesh]["attributes"].items()}

    @property
    def table(self) -> list[dict]:
        """Rows of the table of properties, without what has no value."""
        metadata = self.json["extensions"][METADATA]
        (table,) = metadata["propertyTables"]
        properties = metadata["schema"]["classes"][table["class"]]["properties"]
        rows: list[dict] = [{} for _ in range(table["count"])]
        assert table["properties"].keys() == properties.keys()
        for key, place in table["properties"].items():
            described = properties[key]
            if described["type"] == "STRING":
                starts = np.frombuffer(self.view(place["stringOffsets"]), "<u4")
                content = self.view(place["values"])
                assert starts[0] == 0
                assert starts[-1] == len(content)
                cells = [content[a:b].decode() for a, b in pairwise(starts)]
            else:
                cells = np.frombuffer(self.view(place["values"]), CELLS[described["componentType"]]).tolist()
            for row, cell in zip(rows, cells, strict=True):
                if "noData" not in described or cell != described["noData"]:
                    row[described["name"]] = cell
                else:
                    assert "required" not in described
        return rows
