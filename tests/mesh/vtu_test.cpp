// cells.vtu: round trips bit for bit, and a reader that survives anything.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "file_support.hpp"
#include "support/complexes.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/random.hpp"
#include "voroform/mesh/formats.hpp"

namespace voroform::mesh {
namespace {

using ::testing::HasSubstr;
using testing::readAll;
using testing::TemporaryFolder;
using testing::writeAll;

template <class T>
std::string bytesOf(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

void expectSameBits(const PolyhedralComplex& a, const PolyhedralComplex& b) {
  EXPECT_EQ(bytesOf(a.vertices), bytesOf(b.vertices));
  EXPECT_EQ(bytesOf<Vec3>({a.frame.origin}), bytesOf<Vec3>({b.frame.origin}));
  EXPECT_EQ(a.faceOffsets, b.faceOffsets);
  EXPECT_EQ(a.faceVertices, b.faceVertices);
  EXPECT_EQ(a.faceCells, b.faceCells);
  EXPECT_EQ(a.faceTags, b.faceTags);
  EXPECT_EQ(a.cellCount, b.cellCount);
  EXPECT_EQ(bytesOf(a.cellSites), bytesOf(b.cellSites));
}

PolyhedralComplex sample(const Vec3& origin) {
  PolyhedralComplex complex = testing::mapped(testing::block(2), randomRotation(11), Vec3(0.1, -0.2, 0.3));
  complex.frame.origin = origin;
  complex.faceTags[3] = FaceTag::envelope;
  complex.vertices[0][1] = -0.0;
  for (std::uint64_t i = 0; i < 8; ++i) {
    complex.cellSites.push_back(randomInBox(1, RandomStream::test, i, Box3(Vec3::Zero(), Vec3::Ones())));
  }
  return complex;
}

std::string messageOfReading(const std::filesystem::path& path) {
  try {
    readCellsVtu(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(CellsVtu, ReturnsTheSameBits) {
  const TemporaryFolder folder;
  for (const Vec3& origin : {Vec3(0, 0, 0), Vec3(-0.0, 0, 0), Vec3(4.5e6, 1.0 / 3, -7e-7), Vec3(0, 0, 1e15)}) {
    const PolyhedralComplex complex = sample(origin);
    writeCellsVtu(folder / "cells.vtu", complex, std::vector<CellData>{{"volume", std::vector<double>(8, 1.5)}});
    expectSameBits(readCellsVtu(folder / "cells.vtu"), complex);
  }
}

TEST(CellsVtu, ReturnsComplexesWithoutSitesAndEmptyOnes) {
  const TemporaryFolder folder;
  for (const PolyhedralComplex& complex : {testing::truncatedOctahedron(), PolyhedralComplex{}}) {
    writeCellsVtu(folder / "cells.vtu", complex, {});
    expectSameBits(readCellsVtu(folder / "cells.vtu"), complex);
  }
}

TEST(CellsVtu, WritesTheSameBytesEveryTime) {
  const TemporaryFolder folder;
  const std::vector<CellData> data = {{"a<\"b\">&c", {1, 2, 3, 4, 5, 6, 7, 8}}};
  writeCellsVtu(folder / "a.vtu", sample(Vec3(1, 2, 3)), data);
  writeCellsVtu(folder / "b.vtu", sample(Vec3(1, 2, 3)), data);
  EXPECT_EQ(readAll(folder / "a.vtu"), readAll(folder / "b.vtu"));
  expectSameBits(readCellsVtu(folder / "a.vtu"), sample(Vec3(1, 2, 3)));
}

TEST(CellsVtu, RefusesDataOfTheWrongSize) {
  const TemporaryFolder folder;
  const PolyhedralComplex complex = sample(Vec3::Zero());
  EXPECT_THROW(writeCellsVtu(folder / "c.vtu", complex, std::vector<CellData>{{"volume", {1, 2}}}), UsageError);
  EXPECT_THROW(writeCellsVtu(folder / "c.vtu", complex, std::vector<CellData>{{"site", std::vector<double>(8)}}),
               UsageError);
  EXPECT_FALSE(std::filesystem::exists(folder / "c.vtu"));
}

TEST(CellsVtu, MissingAndForeignFilesAreInputErrors) {
  const TemporaryFolder folder;
  EXPECT_THAT(messageOfReading(folder / "none.vtu"), HasSubstr("no such file"));
  EXPECT_THAT(messageOfReading(folder / ""), HasSubstr("found a folder"));
  for (const std::string text : {"", "ply\n", "<VTKFile", "<a>\n<AppendedData encoding=\"raw\">\n_"}) {
    writeAll(folder / "foreign.vtu", text);
    EXPECT_THAT(messageOfReading(folder / "foreign.vtu"), HasSubstr("foreign.vtu")) << text;
  }
}

TEST(CellsVtu, EveryTruncationIsAnInputError) {
  const TemporaryFolder folder;
  writeCellsVtu(folder / "cells.vtu", sample(Vec3(1, 2, 3)), {});
  const std::string bytes = readAll(folder / "cells.vtu");
  for (std::size_t length = 0; length < bytes.size(); length += length < 4000 ? 13 : 101) {
    writeAll(folder / "cut.vtu", bytes.substr(0, length));
    EXPECT_NE(messageOfReading(folder / "cut.vtu"), "") << length << " bytes";
  }
  writeAll(folder / "cut.vtu", bytes.substr(0, bytes.size() - 1));
  EXPECT_NE(messageOfReading(folder / "cut.vtu"), "");
}

TEST(CellsVtu, DamageIsFoundOrHarmless) {
  const TemporaryFolder folder;
  const PolyhedralComplex original = sample(Vec3(1, 2, 3));
  writeCellsVtu(folder / "cells.vtu", original, {});
  const std::string bytes = readAll(folder / "cells.vtu");
  int found = 0;
  constexpr std::uint64_t kTrials = 400;
  for (std::uint64_t trial = 0; trial < kTrials; ++trial) {
    std::string damaged = bytes;
    const std::uint64_t bits = randomBits(trial, RandomStream::test, 0);
    damaged[bits % bytes.size()] ^= static_cast<char>(1U << (randomBits(trial, RandomStream::test, 1) % 8));
    writeAll(folder / "damaged.vtu", damaged);
    if (!messageOfReading(folder / "damaged.vtu").empty()) ++found;
  }
  // Harmless: a digit of the XML version, a sign of an exponent of nothing, the tag of a face.
  EXPECT_GE(found, static_cast<int>(kTrials * 9 / 10));
}

// Replaces the first occurrence in the file.
void replaceIn(const std::filesystem::path& path, const std::string& from, const std::string& to) {
  std::string bytes = readAll(path);
  const std::size_t place = bytes.find(from);
  ASSERT_NE(place, std::string::npos) << from;
  writeAll(path, bytes.replace(place, from.size(), to));
}

TEST(CellsVtu, DeclaredSizesThatAreNotThere) {
  const TemporaryFolder folder;
  const auto write = [&] { writeCellsVtu(folder / "cells.vtu", sample(Vec3::Zero()), {}); };
  write();
  replaceIn(folder / "cells.vtu", "NumberOfPoints=\"27\"", "NumberOfPoints=\"2000000000\"");
  EXPECT_THAT(messageOfReading(folder / "cells.vtu"), HasSubstr("expected 2000000000"));
  write();
  replaceIn(folder / "cells.vtu", "NumberOfCells=\"8\"", "NumberOfCells=\"2000000000\"");
  EXPECT_THAT(messageOfReading(folder / "cells.vtu"), HasSubstr("number of cells"));
  write();
  replaceIn(folder / "cells.vtu", "NumberOfCells=\"8\"", "NumberOfCells=\"99999999999999999999999\"");
  EXPECT_THAT(messageOfReading(folder / "cells.vtu"), HasSubstr("expected a count"));
  write();
  replaceIn(folder / "cells.vtu", "header_type=\"UInt64\"", "header_type=\"UInt32\"");
  EXPECT_THAT(messageOfReading(folder / "cells.vtu"), HasSubstr("header_type"));
  write();
  // The first block is the format's version: 4 bytes. Let it declare 2⁶³ of them.
  std::string bytes = readAll(folder / "cells.vtu");
  bytes[bytes.find(">\n_") + 3 + 7] = static_cast<char>(0x80);
  writeAll(folder / "cells.vtu", bytes);
  EXPECT_THAT(messageOfReading(folder / "cells.vtu"), HasSubstr("declares 9223372036854775812 bytes"));
}

TEST(CellsVtu, PolyhedraThatDisagreeWithTheFaces) {
  const TemporaryFolder folder;
  const PolyhedralComplex cube = testing::block(1);
  writeCellsVtu(folder / "cells.vtu", cube, {});
  std::string bytes = readAll(folder / "cells.vtu");
  // The stream of the polyhedron starts with 6 faces of 4 vertices.
  const std::int64_t start[2] = {6, 4};
  const std::size_t place = bytes.find(std::string(reinterpret_cast<const char*>(start), sizeof(start)));
  ASSERT_NE(place, std::string::npos);
  std::swap(bytes[place + 16], bytes[place + 24]);
  writeAll(folder / "cells.vtu", bytes);
  EXPECT_THAT(messageOfReading(folder / "cells.vtu"), HasSubstr("'faces' of the cells disagrees"));
}

}  // namespace
}  // namespace voroform::mesh
