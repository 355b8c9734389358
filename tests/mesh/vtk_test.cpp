// What VTK's own readers make of our files.
#include <gtest/gtest.h>

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPLYReader.h>
#include <vtkPolyData.h>
#include <vtkSTLReader.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>

#include "file_support.hpp"
#include "support/complexes.hpp"
#include "voroform/core/random.hpp"
#include "voroform/mesh/formats.hpp"
#include "voroform/mesh/moments.hpp"

namespace voroform::mesh {
namespace {

using testing::TemporaryFolder;

constexpr double kRounding = 1e-12;

PolyhedralComplex sample() {
  PolyhedralComplex complex = testing::mapped(testing::block(3), randomRotation(4), Vec3(1.0 / 3, 0, 0));
  complex.frame.origin = Vec3(1000, -2000, 0);
  for (int i = 0; i < 27; ++i) complex.cellSites.emplace_back(i, 0.5, -i);
  return complex;
}

Vec3 pointOf(vtkUnstructuredGrid& grid, vtkIdType id) {
  Vec3 point;
  grid.GetPoint(id, point.data());
  return point;
}

// Volume from VTK's face stream: number of faces, then size and vertices of each.
double volumeOfStream(vtkUnstructuredGrid& grid, vtkIdList& stream) {
  vtkIdType place = 1;
  double sum = 0;
  const Vec3 apex = pointOf(grid, stream.GetId(2));
  for (vtkIdType face = 0; face < stream.GetId(0); ++face) {
    const vtkIdType size = stream.GetId(place++);
    const Vec3 a = pointOf(grid, stream.GetId(place)) - apex;
    for (vtkIdType i = 2; i < size; ++i) {
      const Vec3 b = pointOf(grid, stream.GetId(place + i - 1)) - apex;
      const Vec3 c = pointOf(grid, stream.GetId(place + i)) - apex;
      sum += a.dot(b.cross(c));
    }
    place += size;
  }
  EXPECT_EQ(place, stream.GetNumberOfIds());
  return sum / 6;
}

TEST(VtkReader, ReadsTheCells) {
  const TemporaryFolder folder;
  const PolyhedralComplex complex = sample();
  const auto moments = cellMoments(complex, RunContext{});
  std::vector<double> numbers;
  for (int i = 0; i < 27; ++i) numbers.push_back(i * 0.1);
  writeCellsVtu(folder / "cells.vtu", complex, std::vector<CellData>{{"number", numbers}});
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName((folder / "cells.vtu").c_str());
  reader->Update();
  ASSERT_EQ(reader->GetErrorCode(), 0U);
  vtkUnstructuredGrid& grid = *reader->GetOutput();
  ASSERT_EQ(grid.GetNumberOfCells(), 27);
  ASSERT_EQ(grid.GetNumberOfPoints(), 64);
  for (vtkIdType v = 0; v < 64; ++v) {
    EXPECT_EQ(pointOf(grid, v), Vec3(complex.frame.origin + complex.vertices[static_cast<std::size_t>(v)]));
  }
  vtkDataArray* site = grid.GetCellData()->GetArray("site");
  vtkDataArray* number = grid.GetCellData()->GetArray("number");
  ASSERT_NE(site, nullptr);
  ASSERT_NE(number, nullptr);
  ASSERT_EQ(site->GetNumberOfComponents(), 3);
  vtkNew<vtkIdList> stream;
  for (vtkIdType cell = 0; cell < 27; ++cell) {
    const auto row = static_cast<std::size_t>(cell);
    EXPECT_EQ(grid.GetCellType(cell), 42);
    grid.GetFaceStream(cell, stream);
    EXPECT_EQ(stream->GetId(0), 6);
    EXPECT_NEAR(volumeOfStream(grid, *stream), moments[row].volume, 1e3 * kRounding);
    vtkNew<vtkIdList> points;
    grid.GetCellPoints(cell, points);
    EXPECT_EQ(points->GetNumberOfIds(), 8);
    EXPECT_EQ(number->GetComponent(cell, 0), numbers[row]);
    EXPECT_EQ(site->GetComponent(cell, 0), 1000.0 + static_cast<double>(cell));
  }
}

TEST(VtkReader, ReadsTheSurface) {
  const TemporaryFolder folder;
  const PolyhedralComplex complex = testing::block(2);
  const BoundarySurface surface = boundarySurface(complex);
  writeSurfacePly(folder / "surface.ply", surface, complex);
  writeSurfaceStl(folder / "surface.stl", surface.mesh);
  vtkNew<vtkPLYReader> ply;
  ply->SetFileName((folder / "surface.ply").c_str());
  ply->Update();
  ASSERT_EQ(ply->GetOutput()->GetNumberOfPoints(), 26);
  ASSERT_EQ(ply->GetOutput()->GetNumberOfPolys(), 48);
  vtkNew<vtkIdList> ids;
  for (vtkIdType t = 0; t < 48; ++t) {
    ply->GetOutput()->GetCellPoints(t, ids);
    ASSERT_EQ(ids->GetNumberOfIds(), 3);
    for (vtkIdType i = 0; i < 3; ++i) {
      EXPECT_EQ(ids->GetId(i), surface.mesh.triangles[static_cast<std::size_t>(t)][static_cast<std::size_t>(i)]);
    }
  }
  vtkNew<vtkSTLReader> stl;
  stl->SetFileName((folder / "surface.stl").c_str());
  stl->Update();
  EXPECT_EQ(stl->GetOutput()->GetNumberOfPolys(), 48);
  EXPECT_EQ(stl->GetOutput()->GetNumberOfPoints(), 26);
}

}  // namespace
}  // namespace voroform::mesh
