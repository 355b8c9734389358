#!/usr/bin/env python3
"""Draws a results folder: the solid cut open, its cells in colors, as docs/images/kitten.png was made.

    voroform reconstruct data/kitten.xyz -o kitten --sites 4000
    xvfb-run python3 docs/make_picture.py kitten docs/images/kitten.png

Debian packages: python3-numpy python3-vtk9 xvfb xauth libgl1-mesa-dri (without a screen, xvfb-run provides one).
"""

import sys

import numpy as np
import vtkmodules.vtkRenderingFreeType  # noqa: F401  (VTK's rendering needs these two loaded)
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow, vtkWindowToImageFilter

WIDTH, HEIGHT = 900, 640
SUPERSAMPLING = 3


def read(folder):
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(f"{folder}/cells.vtu")
    reader.Update()
    grid = reader.GetOutput()
    fields = grid.GetFieldData()
    offsets, loops, cells = (
        vtk_to_numpy(fields.GetArray(name)) for name in ("face_offsets", "face_vertices", "face_cells")
    )
    return vtk_to_numpy(grid.GetPoints().GetData()), offsets, loops, cells.reshape(-1, 2), grid


def visible_faces(kept, cells):
    """Faces with a kept cell on one side only: (face, cell, true if the face has to be turned to look outward)."""
    behind, ahead = cells[:, 0], cells[:, 1]
    has_behind = (behind >= 0) & kept[behind]
    has_ahead = (ahead >= 0) & kept[ahead]
    for face in np.flatnonzero(has_behind != has_ahead):
        yield face, (behind if has_behind[face] else ahead)[face], has_ahead[face]


def cell_colors(count, seed=4):
    """Muted colors that differ from cell to cell."""
    random = np.random.default_rng(seed)
    base = np.array([[226, 180, 128], [214, 158, 112], [238, 205, 160], [203, 146, 116], [230, 190, 150]], float)
    colors = base[random.integers(len(base), size=count)] + random.normal(0, 6, (count, 1))
    return np.clip(colors, 0, 255).astype(np.uint8)


def poly_data(points, offsets, loops, cells, kept):
    colors = cell_colors(len(kept))
    # Cells that the cut laid bare are cooler than the skin.
    bare = (colors * np.array([0.68, 0.95, 1.18])).clip(0, 255).astype(np.uint8)
    array, shade = vtkCellArray(), []
    for face, cell, turned in visible_faces(kept, cells):
        loop = loops[offsets[face] : offsets[face + 1]]
        array.InsertNextCell(len(loop))
        for vertex in loop[::-1] if turned else loop:
            array.InsertCellPoint(int(vertex))
        on_surface = cells[face].min() < 0
        shade.append(colors[cell] if on_surface else bare[cell])
    data = vtkPolyData()
    vtk_points = vtkPoints()
    vtk_points.SetData(numpy_to_vtk(points, deep=True))
    data.SetPoints(vtk_points)
    data.SetPolys(array)
    data.GetCellData().SetScalars(numpy_to_vtk(np.array(shade, np.uint8), deep=True))
    return data


def outlines(points, offsets, loops, cells, kept):
    """Edges between visible faces of different cells, or with a clear bend: the borders of the cells."""
    owners = {}
    for face, cell, _ in visible_faces(kept, cells):
        loop = loops[offsets[face] : offsets[face + 1]]
        on_surface = cells[face].min() < 0
        for a, b in zip(loop, np.roll(loop, -1)):
            owners.setdefault((min(a, b), max(a, b)), []).append((cell, on_surface))
    array = vtkCellArray()
    for (a, b), sides in owners.items():
        if len(set(sides)) > 1 or not all(surface for _, surface in sides):
            array.InsertNextCell(2)
            array.InsertCellPoint(int(a))
            array.InsertCellPoint(int(b))
    data = vtkPolyData()
    vtk_points = vtkPoints()
    vtk_points.SetData(numpy_to_vtk(points, deep=True))
    data.SetPoints(vtk_points)
    data.SetLines(array)
    return data


def actor(data, shift_x, line=False):
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(data)
    mapper.SetResolveCoincidentTopologyToPolygonOffset()
    result = vtkActor()
    result.SetMapper(mapper)
    result.SetPosition(shift_x, 0, 0)
    if line:
        mapper.ScalarVisibilityOff()
        result.GetProperty().SetColor(0.24, 0.16, 0.12)
        result.GetProperty().SetLineWidth(1.1 * SUPERSAMPLING)
        result.GetProperty().LightingOff()
    else:
        result.GetProperty().SetAmbient(0.35)
        result.GetProperty().SetDiffuse(0.8)
        result.GetProperty().SetInterpolationToFlat()
    return result


def main(folder, target):
    points, offsets, loops, cells, grid = read(folder)
    sites = vtk_to_numpy(grid.GetCellData().GetArray("site"))
    center = (points.max(axis=0) + points.min(axis=0)) / 2
    size = points.max(axis=0) - points.min(axis=0)
    renderer = vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    whole = np.ones(len(sites), bool)
    cut = sites[:, 2] < center[2]
    for kept, shift in ((whole, -0.55 * size[0]), (cut, 0.55 * size[0])):
        renderer.AddActor(actor(poly_data(points, offsets, loops, cells, kept), shift))
        renderer.AddActor(actor(outlines(points, offsets, loops, cells, kept), shift, line=True))
    camera = renderer.GetActiveCamera()
    camera.SetFocalPoint(*center)
    camera.SetPosition(*(center + np.array([0.35, 0.25, 1.0]) * 3 * size.max()))
    camera.SetViewUp(0, 1, 0)
    camera.SetViewAngle(20)
    renderer.ResetCamera()
    camera.Zoom(1.75)

    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(WIDTH * SUPERSAMPLING, HEIGHT * SUPERSAMPLING)
    window.AddRenderer(renderer)
    window.Render()
    image = vtkWindowToImageFilter()
    image.SetInput(window)
    image.ReadFrontBufferOff()
    image.Update()
    write_smaller(image.GetOutput(), target)


def write_smaller(image, target):
    """Averages blocks of pixels, keeps fewer shades so that the file is small, and writes a PNG."""
    pixels = vtk_to_numpy(image.GetPointData().GetScalars())[:, :3].astype(np.uint32)
    n = SUPERSAMPLING
    pixels = pixels.reshape(HEIGHT, n, WIDTH, n, 3).sum(axis=(1, 3)) // (n * n)
    pixels = np.minimum(np.round(pixels / 8) * 8, 255).astype(np.uint8)
    image.SetDimensions(WIDTH, HEIGHT, 1)
    image.GetPointData().SetScalars(numpy_to_vtk(pixels.reshape(-1, 3), deep=True))
    writer = vtkPNGWriter()
    writer.SetCompressionLevel(9)
    writer.SetInputData(image)
    writer.SetFileName(target)
    writer.Write()


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
