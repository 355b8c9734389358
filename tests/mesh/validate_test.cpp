// The certificate: valid complexes pass, and each corruption is rejected by the counter meant for it.
#include "voroform/mesh/validate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "support/complexes.hpp"
#include "voroform/core/random.hpp"

namespace voroform::mesh {
namespace {

using testing::block;
using ::testing::Contains;
using testing::cubes;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::mapped;
using ::testing::Not;
using testing::sideBySide;

ValidateOptions fewSamples() {
  ValidateOptions options;
  options.pointSamples = 2000;
  return options;
}

Certificate examine(const PolyhedralComplex& complex) { return validate(complex, fewSamples(), RunContext{}); }

// A valid complex whose coordinates are nothing special, in 27 cells; cell 13 and vertex (1, 1, 1) are inside.
PolyhedralComplex sample() { return mapped(block(3), randomRotation(5), Vec3(0.3, -0.2, 0.7)); }

Index faceBetween(const PolyhedralComplex& complex, Index behind, Index ahead) {
  for (Index f = 0; f < complex.faceCount(); ++f) {
    const auto& cells = complex.faceCells[static_cast<std::size_t>(f)];
    if ((cells[0] == behind && cells[1] == ahead) || (cells[0] == ahead && cells[1] == behind)) return f;
  }
  ADD_FAILURE() << "no face between " << behind << " and " << ahead;
  return 0;
}

// The complex without the faces that `drop` names.
template <class Drop>
PolyhedralComplex without(const PolyhedralComplex& complex, const Drop& drop) {
  PolyhedralComplex result = complex;
  result.faceOffsets = {0};
  result.faceVertices.clear();
  result.faceCells.clear();
  result.faceTags.clear();
  for (Index f = 0; f < complex.faceCount(); ++f) {
    const auto cells = complex.faceCells[static_cast<std::size_t>(f)];
    if (!drop(f)) result.addFace(complex.face(f), cells[0], cells[1]);
  }
  return result;
}

void reverseFace(PolyhedralComplex& complex, Index f) {
  const auto begin = complex.faceVertices.begin();
  std::reverse(begin + complex.faceOffsets[static_cast<std::size_t>(f)],
               begin + complex.faceOffsets[static_cast<std::size_t>(f) + 1]);
}

void expectRejected(const Certificate& certificate) {
  EXPECT_FALSE(certificate.valid);
  EXPECT_THAT(certificate.problems, Not(IsEmpty()));
}

void expectValid(const Certificate& certificate, Index components, std::int64_t euler) {
  EXPECT_TRUE(certificate.valid);
  EXPECT_THAT(certificate.problems, IsEmpty());
  EXPECT_EQ(certificate.components, components);
  EXPECT_EQ(certificate.eulerCharacteristic, euler);
  EXPECT_EQ(certificate.selfIntersections, 0);
  EXPECT_EQ(certificate.pointSamples, fewSamples().pointSamples);
  EXPECT_EQ(certificate.pointViolations, 0);
  EXPECT_TRUE(certificate.closedCells());
  EXPECT_TRUE(certificate.manifoldBoundary());
  EXPECT_TRUE(certificate.oriented());
  EXPECT_LE(certificate.volumeError, 1e-13);
}

TEST(ValidComplex, RotatedBlockPasses) {
  const Certificate certificate = examine(sample());
  expectValid(certificate, 1, 2);
  EXPECT_NEAR(certificate.volume, 27, 1e-11);
}

TEST(ValidComplex, AxisParallelBlockPasses) { expectValid(examine(block(4)), 1, 2); }

TEST(ValidComplex, PolyhedraPass) {
  expectValid(examine(testing::tetrahedron()), 1, 2);
  expectValid(examine(testing::truncatedOctahedron()), 1, 2);
}

TEST(ValidComplex, RingOfCubesHasAHandle) {
  expectValid(examine(cubes({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {2, 2, 0}, {1, 2, 0}, {0, 2, 0}, {0, 1, 0}})),
              1, 0);
}

TEST(ValidComplex, VoidAndSeparateCubesAreComponents) {
  std::vector<std::array<int, 3>> shell;
  for (int i = 0; i < 27; ++i) {
    if (i != 13) shell.push_back({i % 3, i / 3 % 3, i / 9});
  }
  const Certificate hollow = examine(cubes(shell));
  expectValid(hollow, 2, 4);
  EXPECT_NEAR(hollow.volume, 26, 1e-12);
  expectValid(examine(cubes({{0, 0, 0}, {2, 0, 0}})), 2, 4);
}

TEST(ValidComplex, TinyAndFarAwayPass) {
  expectValid(examine(mapped(block(3), 0x1p-30 * randomRotation(2), Vec3::Zero())), 1, 2);
  expectValid(examine(mapped(block(3), Mat3::Identity(), Vec3(0x1p22, -0x1p22, 0))), 1, 2);
}

TEST(ValidComplex, CollinearPointsOnAFaceDoNotCountAsIntersection) {
  // A cube's face with an extra corner in the middle of an edge, shared with the neighboring face.
  PolyhedralComplex cube = block(1);
  cube.vertices.emplace_back(0.5, 0, 0);
  PolyhedralComplex result;
  result.vertices = cube.vertices;
  result.cellCount = 1;
  for (Index f = 0; f < cube.faceCount(); ++f) {
    testing::Loop loop;
    const auto old = cube.face(f);
    for (std::size_t i = 0; i < old.size(); ++i) {
      loop.push_back(old[i]);
      const Index next = old[(i + 1) % old.size()];
      if (old[i] + next == 1 && old[i] != next) loop.push_back(8);
    }
    result.addFace(loop, 0, kNone);
  }
  expectValid(examine(result), 1, 2);
}

TEST(ValidComplex, SameFiguresForAnyNumberOfThreads) {
  PolyhedralComplex complex = sideBySide(sample(), mapped(sample(), Mat3::Identity(), Vec3(0.5, 0.5, 0.5)));
  RunContext one;
  one.threads = 1;
  RunContext four;
  four.threads = 4;
  const Certificate a = validate(complex, fewSamples(), one);
  const Certificate b = validate(complex, fewSamples(), four);
  EXPECT_EQ(a.problems, b.problems);
  EXPECT_GT(a.selfIntersections, 0);
  EXPECT_EQ(a.selfIntersections, b.selfIntersections);
  EXPECT_EQ(a.pointViolations, b.pointViolations);
  EXPECT_EQ(a.volume, b.volume);
}

TEST(ValidComplex, PartsCanBeSkipped) {
  ValidateOptions options;
  options.pointSamples = 0;
  options.selfIntersections = false;
  const Certificate certificate = validate(sample(), options, RunContext{});
  EXPECT_TRUE(certificate.valid);
  EXPECT_EQ(certificate.selfIntersections, -1);
  EXPECT_EQ(certificate.pointSamples, 0);
}

// --- Negative controls: combinatorial ---

TEST(Corruption, BoundaryFaceRemoved) {
  const PolyhedralComplex complex = sample();
  Index removed = 0;
  while (!complex.isBoundary(removed)) ++removed;
  const Certificate certificate = examine(without(complex, [&](Index f) { return f == removed; }));
  expectRejected(certificate);
  EXPECT_EQ(certificate.openCells, 1);
  EXPECT_EQ(certificate.nonManifoldEdges, 4);
  EXPECT_GT(certificate.pointViolations, 0);
}

TEST(Corruption, InteriorFaceRemoved) {
  const PolyhedralComplex complex = sample();
  const Index removed = faceBetween(complex, 13, 14);
  const Certificate certificate = examine(without(complex, [&](Index f) { return f == removed; }));
  expectRejected(certificate);
  EXPECT_EQ(certificate.openCells, 2);
  EXPECT_TRUE(certificate.manifoldBoundary());
}

TEST(Corruption, VolumesThatDoNotAddUp) {
  const PolyhedralComplex complex = sample();
  // The two cells measure the missing face from apexes of their own, so that their errors do not cancel.
  const Index removed = faceBetween(complex, 13, 14);
  const Certificate certificate = examine(without(complex, [&](Index f) { return f == removed; }));
  EXPECT_GT(certificate.volumeError, kVolumeConsistency);
  EXPECT_THAT(certificate.problems, Contains(HasSubstr("volumes add up to")));
  expectRejected(certificate);
}

TEST(Corruption, BoundaryFaceFlipped) {
  PolyhedralComplex complex = sample();
  Index f = 0;
  while (!complex.isBoundary(f)) ++f;
  reverseFace(complex, f);
  const Certificate certificate = examine(complex);
  expectRejected(certificate);
  EXPECT_EQ(certificate.openCells, 1);
  EXPECT_EQ(certificate.inconsistentEdges, 4);
  EXPECT_FALSE(certificate.oriented());
}

TEST(Corruption, InteriorFaceGivenToTheWrongCell) {
  PolyhedralComplex complex = sample();
  complex.faceCells[static_cast<std::size_t>(faceBetween(complex, 13, 14))] = {13, 26};
  const Certificate certificate = examine(complex);
  expectRejected(certificate);
  EXPECT_GE(certificate.openCells, 2);
}

TEST(Corruption, PinchedVertex) {
  const Certificate certificate = examine(cubes({{0, 0, 0}, {1, 1, 1}}));
  expectRejected(certificate);
  EXPECT_EQ(certificate.nonManifoldVertices, 1);
  EXPECT_EQ(certificate.nonManifoldEdges, 0);
  EXPECT_EQ(certificate.openCells, 0);
  EXPECT_EQ(certificate.selfIntersections, 0);
}

TEST(Corruption, NonManifoldEdge) {
  const Certificate certificate = examine(cubes({{0, 0, 0}, {1, 1, 0}}));
  expectRejected(certificate);
  EXPECT_EQ(certificate.nonManifoldEdges, 1);
  EXPECT_EQ(certificate.openCells, 0);
}

TEST(Corruption, InvertedComplex) {
  PolyhedralComplex complex = sample();
  for (Index f = 0; f < complex.faceCount(); ++f) reverseFace(complex, f);
  const Certificate certificate = examine(complex);
  expectRejected(certificate);
  EXPECT_FALSE(certificate.outward);
  EXPECT_EQ(certificate.nonPositiveVolumes, 27);
  EXPECT_EQ(certificate.openCells, 0);
  EXPECT_EQ(certificate.inconsistentEdges, 0);
}

TEST(Corruption, CellWithoutFaces) {
  PolyhedralComplex complex = sample();
  ++complex.cellCount;
  const Certificate certificate = examine(complex);
  expectRejected(certificate);
  EXPECT_EQ(certificate.nonPositiveVolumes, 1);
}

// --- Negative controls: data that cannot be walked ---

TEST(Corruption, VertexNotANumber) {
  PolyhedralComplex complex = sample();
  complex.vertices[11][1] = std::numeric_limits<double>::quiet_NaN();
  complex.vertices[12][0] = std::numeric_limits<double>::infinity();
  const Certificate certificate = examine(complex);
  expectRejected(certificate);
  EXPECT_EQ(certificate.nonFiniteVertices, 2);
  EXPECT_EQ(certificate.selfIntersections, -1);
}

TEST(Corruption, SiteNotANumberOrMissing) {
  PolyhedralComplex complex = sample();
  complex.cellSites.assign(27, Vec3::Zero());
  EXPECT_TRUE(examine(complex).valid);
  complex.cellSites[3][2] = std::numeric_limits<double>::quiet_NaN();
  expectRejected(examine(complex));
  complex.cellSites.assign(26, Vec3::Zero());
  expectRejected(examine(complex));
}

TEST(Corruption, VertexIndexOutOfRange) {
  for (const Index bad : {Index{64}, Index{-1}, std::numeric_limits<Index>::max()}) {
    PolyhedralComplex complex = sample();
    complex.faceVertices[17] = bad;
    const Certificate certificate = examine(complex);
    expectRejected(certificate);
    EXPECT_EQ(certificate.invalidFaces, 1) << bad;
  }
}

TEST(Corruption, CellIndexOutOfRange) {
  for (const std::array<Index, 2> bad :
       {std::array<Index, 2>{27, kNone}, {-1, 3}, {-1, -1}, {3, 27}, {3, -2}, {3, 3}}) {
    PolyhedralComplex complex = sample();
    complex.faceCells[5] = bad;
    const Certificate certificate = examine(complex);
    expectRejected(certificate);
    EXPECT_EQ(certificate.invalidFaces, 1) << bad[0] << ' ' << bad[1];
  }
}

TEST(Corruption, VertexTwiceInAFace) {
  PolyhedralComplex complex = sample();
  complex.faceVertices[4] = complex.faceVertices[6];
  const Certificate certificate = examine(complex);
  expectRejected(certificate);
  EXPECT_EQ(certificate.invalidFaces, 1);
}

TEST(Corruption, FaceOfTwoVertices) {
  PolyhedralComplex complex = sample();
  complex.addFace(std::array<Index, 2>{0, 1}, 0, kNone);
  const Certificate certificate = examine(complex);
  expectRejected(certificate);
  EXPECT_EQ(certificate.invalidFaces, 1);
}

TEST(Corruption, ArraysThatDoNotFit) {
  PolyhedralComplex offsets = sample();
  offsets.faceOffsets[3] = 1'000'000;
  EXPECT_GT(examine(offsets).invalidFaces, 0);
  PolyhedralComplex noOffsets = sample();
  noOffsets.faceOffsets.clear();
  EXPECT_GT(examine(noOffsets).invalidFaces, 0);
  PolyhedralComplex tags = sample();
  tags.faceTags.pop_back();
  EXPECT_GT(examine(tags).invalidFaces, 0);
  PolyhedralComplex cells = sample();
  cells.cellCount = -5;
  EXPECT_GT(examine(cells).invalidFaces, 0);
}

TEST(Corruption, EmptyComplex) { expectRejected(examine(PolyhedralComplex{})); }

// --- Negative controls: geometric ---

TEST(Corruption, CellTurnedInsideOut) {
  PolyhedralComplex complex = block(3);
  // The inner vertex (1, 1, 1) goes far through the opposite corner of cell 0; the boundary stays as it is.
  for (Vec3& vertex : complex.vertices) {
    if (vertex == Vec3(1, 1, 1)) vertex = Vec3(-2, -2, -2);
  }
  const Certificate certificate = examine(complex);
  expectRejected(certificate);
  EXPECT_GE(certificate.nonPositiveVolumes, 1);
  EXPECT_GT(certificate.pointViolations, 0);
  EXPECT_EQ(certificate.selfIntersections, 0);
  EXPECT_EQ(certificate.openCells, 0);
}

TEST(Corruption, CrossingSheets) {
  // A U whose left prong leans through the right one: every cell is closed and positive.
  PolyhedralComplex complex = cubes({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 0, 1}, {2, 0, 1}});
  EXPECT_TRUE(examine(complex).valid);
  for (Vec3& vertex : complex.vertices) {
    if (vertex[0] == 1 && vertex[2] == 2) vertex[0] = 2.5;
  }
  const Certificate certificate = examine(complex);
  expectRejected(certificate);
  EXPECT_GT(certificate.selfIntersections, 0);
  EXPECT_GT(certificate.pointViolations, 0);
  EXPECT_EQ(certificate.nonPositiveVolumes, 0);
  EXPECT_TRUE(certificate.manifoldBoundary());
  EXPECT_TRUE(certificate.closedCells());
}

TEST(Corruption, NestedCellsAreFoundByPointsAlone) {
  const PolyhedralComplex inner = mapped(block(1), 0.5 * Mat3::Identity(), Vec3::Constant(0.25));
  const Certificate certificate = examine(sideBySide(block(1), inner));
  expectRejected(certificate);
  EXPECT_GT(certificate.pointViolations, 0);
  EXPECT_EQ(certificate.selfIntersections, 0);
  EXPECT_EQ(certificate.problems.size(), 1U);
}

TEST(Corruption, HoleInTheCoverage) {
  const PolyhedralComplex complex = sample();
  const Certificate certificate = examine(without(complex, [&](Index f) {
    const auto& cells = complex.faceCells[static_cast<std::size_t>(f)];
    return cells[0] == 13 || cells[1] == 13;
  }));
  expectRejected(certificate);
  EXPECT_GT(certificate.pointViolations, 0);
  EXPECT_EQ(certificate.nonPositiveVolumes, 1);
  EXPECT_EQ(certificate.openCells, 6);
}

TEST(Corruption, CubesThatTouchWithoutSharing) {
  const auto touching = [](const Vec3& shift) {
    return examine(sideBySide(block(1), mapped(block(1), Mat3::Identity(), shift))).selfIntersections;
  };
  EXPECT_GT(touching({1, 0, 0}), 0) << "coplanar faces, the same corners";
  EXPECT_GT(touching({1, 0.25, 0.25}), 0) << "coplanar faces that overlap";
  EXPECT_GT(touching({1, 1, 0.5}), 0) << "an edge on an edge";
  EXPECT_GT(touching({1, 1, 1}), 0) << "a corner on a corner";
  EXPECT_EQ(touching({1 + 1e-15, 0, 0}), 0) << "apart by a few units in the last place";
}

TEST(Corruption, CornerThatPiercesItsNeighbors) {
  // A pyramid whose tip dives through the base: triangles that share a vertex or an edge cross.
  const std::vector<testing::Loop> faces = {{0, 1, 2, 3}, {0, 4, 1}, {1, 4, 2}, {2, 4, 3}, {3, 4, 0}};
  const auto pyramid = [&](const Vec3& tip) {
    return testing::joinCells({{0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 0, 0}, tip}, {faces});
  };
  EXPECT_TRUE(examine(pyramid({0.5, 0.5, 1})).valid);
  const Certificate folded = examine(pyramid({0.3, 0.6, 0}));
  EXPECT_GT(folded.selfIntersections, 0) << "coplanar neighbors over an edge";
  EXPECT_GT(folded.nonPositiveVolumes, 0);
  expectRejected(folded);
}

TEST(Corruption, NeighborsFoldedOverTheirEdge) {
  // All pairs of a tetrahedron's faces share an edge. Flat, with the fourth corner inside of the triangle of the
  // others: the three small faces lie on the large one.
  const std::vector<testing::Loop> faces = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  const auto tetrahedron = [&](const Vec3& corner) {
    return examine(testing::joinCells({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, corner}, {faces}));
  };
  EXPECT_TRUE(tetrahedron({0.25, 0.25, 1e-12}).valid);
  EXPECT_EQ(tetrahedron({0.25, 0.25, 0}).selfIntersections, 3);
  // With the fourth corner beyond a side, only faces over opposite sides of the square stay apart.
  EXPECT_EQ(tetrahedron({1, 1, 0}).selfIntersections, 4);
}

TEST(Corruption, NeighborsThatShareAVertexCross) {
  // A bipyramid: faces of the two halves share an edge or a vertex. The lower apex is lifted through an upper face.
  const std::vector<testing::Loop> faces = {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {1, 0, 4}, {2, 1, 4}, {0, 2, 4}};
  const auto bipyramid = [&](const Vec3& apex) {
    return examine(testing::joinCells({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.2, 0.2, 1}, apex}, {faces}));
  };
  EXPECT_TRUE(bipyramid({0.25, 0.25, -1}).valid);
  // The edge from corner 0 to the apex pierces the face (1, 2, 3); both faces on it share one vertex with that face.
  const Certificate pierced = bipyramid({0.9, 0.9, 1});
  EXPECT_EQ(pierced.selfIntersections, 2);
  expectRejected(pierced);
}

TEST(Corruption, DuplicatedSheet) {
  // A lens of thickness zero: two triangles over the same three vertices.
  const Certificate certificate = examine(testing::joinCells({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{{0, 1, 2}}}));
  expectRejected(certificate);
  PolyhedralComplex lens;
  lens.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  lens.cellCount = 1;
  lens.addFace(std::array<Index, 3>{0, 1, 2}, 0, kNone);
  lens.addFace(std::array<Index, 3>{2, 1, 0}, 0, kNone);
  EXPECT_EQ(examine(lens).selfIntersections, 1);
  EXPECT_EQ(examine(lens).nonPositiveVolumes, 1);
}

// --- Whatever the complex holds ---

TEST(Corruption, RandomDamageNeverCrashesAndIsMostlyFound) {
  const PolyhedralComplex original = mapped(block(2), randomRotation(9), Vec3::Zero());
  ValidateOptions options;
  options.pointSamples = 200;
  int rejected = 0;
  constexpr int kTrials = 500;
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto bits = [&](std::uint64_t i) {
      return randomBits(static_cast<std::uint64_t>(trial), RandomStream::test, i);
    };
    PolyhedralComplex complex = original;
    const auto index = static_cast<Index>(bits(1) % 40) - 5;
    switch (bits(0) % 5) {
      case 0:
        complex.faceVertices[bits(2) % complex.faceVertices.size()] = index;
        break;
      case 1:
        complex.faceCells[bits(2) % complex.faceCells.size()][bits(3) % 2] = index;
        break;
      case 2:
        complex.faceOffsets[bits(2) % complex.faceOffsets.size()] += index == 0 ? 1 : index;
        break;
      case 3:
        complex.vertices[bits(2) % complex.vertices.size()] *= index == 1 ? -1e300 : 1e300;
        break;
      default:
        complex.vertices[bits(2) % complex.vertices.size()] += Vec3(5, 7, index == 0 ? 1 : index);
        break;
    }
    if (!validate(complex, options, RunContext{}).valid) ++rejected;
  }
  // An index may be replaced by itself, and a corner of the block may be pulled out without harm; all else is damage.
  EXPECT_GE(rejected, kTrials * 3 / 4);
}

}  // namespace
}  // namespace voroform::mesh
