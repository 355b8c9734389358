#include "voroform/implicit/form_file.hpp"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "support/clouds.hpp"
#include "support/implicit_laws.hpp"
#include "voroform/core/error.hpp"
#include "voroform/implicit/poisson.hpp"

namespace voroform::implicit {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

const Frame kFrame{Vec3(4500000.123456789, -0.1, 1e-30)};

class FormFiles : public ::testing::Test {
 protected:
  FormFiles() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() / ("voroform_form_" + std::to_string(::getpid()) + "_" + test->name());
    fs::create_directories(folder_);
    path_ = folder_ / "form.vtu";
    const points::PointCloud cloud = test::torusCloud(800, 1);
    form_ = fitPoisson(cloud, test::grownBox(cloud, 0.02), {.gridResolution = 40}, {}).form;
    writeForm(path_, *form_, kFrame);
    bytes_ = read(path_);
  }
  ~FormFiles() override { fs::remove_all(folder_); }

  static std::string read(const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  // What readForm() says about other bytes; it must name the file.
  std::string complaintAbout(const std::string& bytes) const {
    std::ofstream(path_, std::ios::binary) << bytes;
    try {
      readForm(path_, {});
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(path_.string()));
      return error.what();
    }
    return "accepted";
  }

  std::string replaced(const std::string& from, const std::string& to) const {
    std::string bytes = bytes_;
    const std::size_t at = bytes.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return bytes.replace(at, from.size(), to);
  }

  std::size_t dataStart() const { return bytes_.find("encoding=\"raw\">\n_") + std::strlen("encoding=\"raw\">\n_"); }

  fs::path folder_;
  fs::path path_;
  std::shared_ptr<const TetrahedralForm> form_;
  std::string bytes_;
};

TEST_F(FormFiles, GiveTheSameFormBitForBit) {
  const FormFile file = readForm(path_, {});
  EXPECT_EQ(file.frame.origin, kFrame.origin);
  EXPECT_EQ(file.form->gridResolution(), 40);
  const TetrahedralMesh& before = form_->mesh();
  const TetrahedralMesh& after = file.form->mesh();
  ASSERT_EQ(after.vertices.size(), before.vertices.size());
  ASSERT_EQ(after.tetrahedra.size(), before.tetrahedra.size());
  EXPECT_EQ(after.measured, before.measured);
  for (std::size_t v = 0; v < before.vertices.size(); ++v) {
    EXPECT_TRUE(test::detail::sameBits(after.vertices[v].value, before.vertices[v].value));
    EXPECT_EQ(after.vertices[v].position, before.vertices[v].position);
  }
  for (std::size_t t = 0; t < before.tetrahedra.size(); ++t) {
    EXPECT_EQ(after.tetrahedra[t].vertices, before.tetrahedra[t].vertices);
    EXPECT_EQ(after.tetrahedra[t].neighbors, before.tetrahedra[t].neighbors);
  }
  EXPECT_EQ(file.form->bounds().min(), form_->bounds().min());
  EXPECT_EQ(file.form->bounds().max(), form_->bounds().max());
  for (const Vec3& p : test::lawPoints(*form_, {.points = 2000})) {
    EXPECT_TRUE(test::detail::sameBits(file.form->value(p), form_->value(p)));
    EXPECT_TRUE(test::detail::sameBits(file.form->clearance(p), form_->clearance(p)));
  }
}

// What any reader of VTK's format does: seek to an array's offset, read its length and its numbers.
TEST_F(FormFiles, HoldEachArrayWhereTheHeaderSays) {
  const auto blockOf = [this](const std::string& name) {
    const std::size_t line = bytes_.find("Name=\"" + name + "\"");
    const std::string key = "offset=\"";
    const std::size_t offset = std::stoul(bytes_.substr(bytes_.find(key, line) + key.size()));
    std::uint64_t length = 0;
    std::memcpy(&length, &bytes_[dataStart() + offset], sizeof length);
    return bytes_.substr(dataStart() + offset + sizeof length, length);
  };
  const auto numbersOf = [&](const std::string& name, auto zero) {
    const std::string block = blockOf(name);
    std::vector<decltype(zero)> numbers(block.size() / sizeof zero);
    std::memcpy(numbers.data(), block.data(), block.size());
    return numbers;
  };
  const TetrahedralMesh& mesh = form_->mesh();
  const auto values = numbersOf("f", 0.0);
  const auto points = numbersOf("points", 0.0);
  ASSERT_EQ(values.size(), mesh.vertices.size());
  ASSERT_EQ(points.size(), 3 * mesh.vertices.size());
  EXPECT_EQ(values[7], mesh.vertices[7].value);
  EXPECT_EQ(points[3 * 7 + 1], mesh.vertices[7].position.y());
  EXPECT_EQ(numbersOf("measured", std::uint8_t{0}), mesh.measured);
  EXPECT_EQ(numbersOf("origin", 0.0)[0], kFrame.origin.x());
  EXPECT_EQ(numbersOf("grid_resolution", std::int64_t{0}), std::vector<std::int64_t>{40});
  const std::size_t count = mesh.tetrahedra.size();
  const auto connectivity = numbersOf("connectivity", Index{0});
  const auto neighbors = numbersOf("neighbors", Index{0});
  ASSERT_EQ(connectivity.size(), 4 * count);
  ASSERT_EQ(neighbors.size(), 4 * count);
  EXPECT_EQ(connectivity[4 * 5 + 2], mesh.tetrahedra[5].vertices[2]);
  EXPECT_EQ(neighbors[4 * 5 + 2], mesh.tetrahedra[5].neighbors[2]);
  EXPECT_EQ(numbersOf("offsets", std::int64_t{0}).back(), static_cast<std::int64_t>(4 * count));
  EXPECT_EQ(numbersOf("types", std::uint8_t{0}), std::vector<std::uint8_t>(count, 10));
}

TEST_F(FormFiles, AreTheSameBytesWhenWrittenAgain) {
  const fs::path copy = folder_ / "again.vtu";
  const FormFile file = readForm(path_, {});
  writeForm(copy, *file.form, file.frame);
  EXPECT_EQ(read(copy), bytes_);
}

TEST_F(FormFiles, KeepFormsWithoutFlagsAsTheyAre) {
  TetrahedralMesh mesh = form_->mesh();
  mesh.measured.clear();
  writeForm(path_, TetrahedralForm(mesh, 20, {}), {});
  EXPECT_TRUE(readForm(path_, {}).form->mesh().measured.empty());
}

TEST_F(FormFiles, AreRefusedWhenCutAnywhere) {
  for (const std::size_t length : {std::size_t{0}, std::size_t{10}, std::size_t{200}, dataStart() - 1, dataStart(),
                                   dataStart() + 5, bytes_.size() / 2, bytes_.size() - 1}) {
    EXPECT_NE(complaintAbout(bytes_.substr(0, length)), "accepted") << length;
  }
  EXPECT_THAT(complaintAbout(bytes_.substr(0, bytes_.size() - 1)), AllOf(HasSubstr("expected"), HasSubstr("bytes")));
  EXPECT_THAT(complaintAbout(bytes_ + "x"), HasSubstr("bytes"));
  EXPECT_THAT(complaintAbout(""), HasSubstr("NumberOfPoints"));
}

TEST_F(FormFiles, AreRefusedWithAnotherHeader) {
  EXPECT_THAT(complaintAbout(replaced("LittleEndian", "BigEndian   ")),
              AllOf(HasSubstr("line 2"), HasSubstr("BigEndian")));
  EXPECT_THAT(complaintAbout(replaced("Name=\"f\"", "Name=\"g\"")), HasSubstr("Name=\"g\""));
  EXPECT_THAT(complaintAbout("ply\nformat ascii 1.0\n"), HasSubstr("NumberOfPoints"));
}

TEST_F(FormFiles, AreRefusedWithCountsBeyondTheirBytes) {
  const std::string vertices = std::to_string(form_->mesh().vertices.size());
  EXPECT_NE(complaintAbout(replaced("NumberOfPoints=\"" + vertices, "NumberOfPoints=\"2000000000")), "accepted");
  EXPECT_THAT(complaintAbout(replaced("NumberOfPoints=\"" + vertices, "NumberOfPoints=\"4000000000")),
              HasSubstr("at most 2147483647"));
  EXPECT_THAT(complaintAbout(replaced("NumberOfPoints=\"" + vertices, "NumberOfPoints=\"-1")), HasSubstr("number"));
}

TEST_F(FormFiles, AreRefusedWithAnyChangedBit) {
  for (std::uint64_t trial = 0; trial < 300; ++trial) {
    const std::size_t at = randomBits(1, RandomStream::test, 2 * trial) % bytes_.size();
    std::string bytes = bytes_;
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << (randomBits(1, RandomStream::test, 2 * trial + 1) % 8)));
    EXPECT_NE(complaintAbout(bytes), "accepted") << "byte " << at;
  }
}

TEST_F(FormFiles, AreRefusedWhenMissingOrAFolder) {
  EXPECT_THROW(readForm(folder_ / "none.vtu", {}), InputError);
  EXPECT_THROW(readForm(folder_, {}), InputError);
}

TEST_F(FormFiles, ThatCannotBeWrittenAreAnEnvironmentError) {
  EXPECT_THROW(writeForm(path_ / "below.vtu", *form_, {}), EnvironmentError);
}

}  // namespace
}  // namespace voroform::implicit
