#!/usr/bin/env python3
"""Loads what `voroform tessellate` or `voroform reconstruct` wrote, with numpy and VTK, and prints what is in it.

    python3 read_results.py DIR

Debian packages: python3-numpy python3-vtk9. Files that are not there (see --formats) are skipped, cells.vtu must be.
"""

import pathlib
import sys

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOPLY import vtkPLYReader
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader


def read_cells(path):
    """Returns VTK's grid and the complex as arrays: vertices, face_offsets, face_vertices, face_cells, face_tags."""
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    if reader.GetErrorCode() != 0:
        sys.exit(f"{path}: VTK cannot read it")
    grid = reader.GetOutput()
    fields = grid.GetFieldData()
    arrays = {fields.GetArrayName(i): vtk_to_numpy(fields.GetArray(i)) for i in range(fields.GetNumberOfArrays())}
    arrays["vertices"] = vtk_to_numpy(grid.GetPoints().GetData())
    data = grid.GetCellData()
    for i in range(data.GetNumberOfArrays()):
        arrays["cell:" + data.GetArrayName(i)] = vtk_to_numpy(data.GetArray(i))
    return grid, arrays


def cell_volumes(arrays, cells):
    """Volumes by the divergence theorem over the faces, each cut into a fan about its first vertex."""
    offsets, loops = arrays["face_offsets"], arrays["face_vertices"]
    points = arrays["vertices"] - arrays["vertices"].mean(axis=0)
    sizes = np.diff(offsets)
    # Triangle k of face f: its first vertex and its vertices k + 1, k + 2.
    face = np.repeat(np.arange(len(sizes)), sizes - 2)
    k = np.arange(len(face)) - np.repeat(np.cumsum(sizes - 2) - (sizes - 2), sizes - 2)
    a, b, c = (points[loops[offsets[face] + shift]] for shift in (0 * k, k + 1, k + 2))
    part = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6
    behind, ahead = arrays["face_cells"][face].T
    inner = ahead >= 0
    return np.bincount(behind, part, cells) - np.bincount(ahead[inner], part[inner], cells)


def read_ply(path):
    reader = vtkPLYReader()  # its coordinates are float32: see read_surface for all the digits
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def read_surface(path):
    """Vertices (float64) and triangles of surface.ply, or the vertices of sites.ply, with numpy alone."""
    raw = path.read_bytes()
    start = raw.index(b"end_header\n") + len(b"end_header\n")
    counts = {}
    for line in raw[:start].decode("ascii").splitlines():
        if line.startswith("element "):
            _, name, count = line.split()
            counts[name] = int(count)
    vertices = np.frombuffer(raw, "<f8", 3 * counts["vertex"], start).reshape(-1, 3)
    record = np.dtype([("size", "u1"), ("vertices", "<i4", 3), ("cell", "<i4"), ("tag", "u1")])
    triangles = np.frombuffer(raw, record, counts.get("face", 0), start + vertices.nbytes)
    return vertices, triangles


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = pathlib.Path(sys.argv[1])

    grid, arrays = read_cells(folder / "cells.vtu")
    cells = grid.GetNumberOfCells()
    face_cells = arrays["face_cells"]
    boundary = face_cells[:, 1] < 0
    print(f"cells.vtu: {cells} cells, {grid.GetNumberOfPoints()} vertices, {len(face_cells)} faces, "
          f"{boundary.sum()} of them on the boundary")
    volumes = cell_volumes(arrays, cells)
    print(f"  volumes: sum {volumes.sum():.6g}, smallest {volumes.min():.6g}, largest {volumes.max():.6g}")
    for name in sorted(key for key in arrays if key.startswith("cell:")):
        values = arrays[name]
        print(f"  {name[5:]}: shape {values.shape}, mean {np.mean(values, axis=0)}")

    surface = folder / "surface.ply"
    if surface.exists():
        polydata = read_ply(surface)
        vertices, triangles = read_surface(surface)
        assert polydata.GetNumberOfPoints() == len(vertices) and polydata.GetNumberOfPolys() == len(triangles)
        a, b, c = (vertices[triangles["vertices"][:, i]] for i in range(3))
        area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
        print(f"surface.ply: {len(vertices)} vertices, {len(triangles)} triangles, area {area:.6g}, "
              f"{np.count_nonzero(triangles['tag'])} triangles on the envelope")

    sites = folder / "sites.ply"
    if sites.exists():
        print(f"sites.ply: {len(read_surface(sites)[0])} sites")

    adjacency = folder / "adjacency.csv"
    if adjacency.exists():
        table = np.loadtxt(adjacency, delimiter=",", skiprows=1, ndmin=2)
        pairs = table[:, :2].astype(int)
        inner = pairs[:, 1] >= 0
        flux = table[:, 2:3] * table[:, 3:]
        sums = np.zeros((cells, 3))
        np.add.at(sums, pairs[:, 0], flux)
        np.add.at(sums, pairs[inner, 1], -flux[inner])
        print(f"adjacency.csv: {inner.sum()} faces between cells, {np.count_nonzero(~inner)} boundary cells, "
              f"largest sum of a cell's area vectors {np.abs(sums).max():.2g}")


if __name__ == "__main__":
    main()
