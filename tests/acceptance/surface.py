"""An independent check of surface.ply: shares nothing with voroform but the file format."""

from __future__ import annotations

import math
import struct
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

TYPES = {
    "char": "b", "int8": "b", "uchar": "B", "uint8": "B", "short": "h", "int16": "h", "ushort": "H", "uint16": "H",
    "int": "i", "int32": "i", "uint": "I", "uint32": "I", "float": "f", "float32": "f", "double": "d", "float64": "d",
}

Vertex = tuple[float, float, float]


@dataclass
class SurfaceCheck:
    vertices: int
    faces: int
    open_edges: int  # directed edges that are not matched by exactly one opposite
    unused_vertices: int
    components: int
    euler: int
    volume: float  # enclosed, positive if the faces point outward

    @property
    def closed(self) -> bool:
        return self.open_edges == 0


def read_ply(path: Path) -> tuple[list[Vertex], list[tuple[int, ...]]]:
    """Vertices and faces of a PLY file, ascii or binary little-endian."""
    data = path.read_bytes()
    header, _, body = data.partition(b"end_header\n")
    elements: list[tuple[str, int, list[tuple]]] = []
    ascii_format = False
    for line in header.decode("ascii").splitlines():
        words = line.split()
        if words[0] == "format":
            ascii_format = words[1] == "ascii"
            if not ascii_format and words[1] != "binary_little_endian":
                raise ValueError(f"{path}: format {words[1]} is not read here")
        elif words[0] == "element":
            elements.append((words[1], int(words[2]), []))
        elif words[0] == "property" and words[1] == "list":
            elements[-1][2].append((words[4], TYPES[words[2]], TYPES[words[3]]))
        elif words[0] == "property":
            elements[-1][2].append((words[2], TYPES[words[1]]))
    next_value = ascii_reader(body) if ascii_format else binary_reader(body)

    vertices: list[Vertex] = []
    faces: list[tuple[int, ...]] = []
    for name, count, properties in elements:
        for _ in range(count):
            record = {}
            for prop in properties:
                if len(prop) == 2:
                    record[prop[0]] = next_value(prop[1])
                else:
                    record[prop[0]] = tuple(next_value(prop[2]) for _ in range(next_value(prop[1])))
            if name == "vertex":
                vertices.append((record["x"], record["y"], record["z"]))
            elif name == "face":
                faces.append(record.get("vertex_indices") or record["vertex_index"])
    return vertices, faces


def ascii_reader(body: bytes):
    words = iter(body.split())
    return lambda kind: float(next(words)) if kind in "fd" else int(next(words))


def binary_reader(body: bytes):
    codes = {kind: struct.Struct("<" + kind) for kind in "bBhHiIfd"}
    position = 0

    def read(kind: str):
        nonlocal position
        (value,) = codes[kind].unpack_from(body, position)
        position += codes[kind].size
        return value

    return read


def examine(vertices: list[Vertex], faces: list[tuple[int, ...]]) -> SurfaceCheck:
    directed: Counter[tuple[int, int]] = Counter()
    for face in faces:
        for i, a in enumerate(face):
            directed[(a, face[(i + 1) % len(face)])] += 1
    open_edges = sum(1 for (a, b), n in directed.items() if n != 1 or directed.get((b, a), 0) != 1)

    # Vertices joined along edges.
    root = list(range(len(vertices)))

    def find(i: int) -> int:
        while root[i] != i:
            root[i] = root[root[i]]
            i = root[i]
        return i

    for a, b in directed:
        root[find(a)] = find(b)
    used = {a for a, _ in directed} | {b for _, b in directed}
    edges = len({(min(edge), max(edge)) for edge in directed})

    # Volume by the divergence theorem about the first vertex, which keeps the digits of surfaces far from the origin.
    ox, oy, oz = vertices[0] if vertices else (0.0, 0.0, 0.0)
    terms = []
    for face in faces:
        (ax, ay, az) = vertices[face[0]]
        ax, ay, az = ax - ox, ay - oy, az - oz
        for second, third in zip(face[1:], face[2:]):
            bx, by, bz = vertices[second][0] - ox, vertices[second][1] - oy, vertices[second][2] - oz
            cx, cy, cz = vertices[third][0] - ox, vertices[third][1] - oy, vertices[third][2] - oz
            terms.append(ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx))
    return SurfaceCheck(
        vertices=len(vertices),
        faces=len(faces),
        open_edges=open_edges,
        unused_vertices=len(vertices) - len(used),
        components=len({find(i) for i in used}),
        euler=len(used) - edges + len(faces),
        volume=math.fsum(terms) / 6,
    )


def check_surface(path: Path) -> SurfaceCheck:
    return examine(*read_ply(path))
