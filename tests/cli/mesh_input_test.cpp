// Triangle meshes as inputs: as signed distance, as Poisson on samples, turned, stored, and refused.
#include <cmath>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "program.hpp"

namespace voroform::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

// A torus (R 1, r 0.4) of 2·around·across triangles about a center, without the last `missing` of them.
std::string torusOff(const Vec3& center = Vec3::Zero(), int missing = 0) {
  constexpr int kAround = 48;
  constexpr int kAcross = 24;
  std::ostringstream text;
  text.precision(17);
  text << "OFF\n" << kAround * kAcross << ' ' << 2 * kAround * kAcross - missing << " 0\n";
  const double step = 2 * std::acos(-1.0);
  for (int i = 0; i < kAround; ++i) {
    for (int k = 0; k < kAcross; ++k) {
      const double u = step * i / kAround;
      const double v = step * k / kAcross;
      const double r = 1 + 0.4 * std::cos(v);
      const Vec3 p = center + Vec3(r * std::cos(u), r * std::sin(u), 0.4 * std::sin(v));
      text << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
    }
  }
  const auto at = [](int i, int k) { return i % kAround * kAcross + k % kAcross; };
  for (int t = 0; t < 2 * kAround * kAcross - missing; ++t) {
    const int i = t / 2 / kAcross;
    const int k = t / 2 % kAcross;
    const int third = t % 2 == 0 ? at(i + 1, k + 1) : at(i, k + 1);
    const int second = t % 2 == 0 ? at(i + 1, k) : at(i + 1, k + 1);
    text << "3 " << at(i, k) << ' ' << second << ' ' << third << '\n';
  }
  return text.str();
}

// Of the torus; that of the mesh is a per cent less.
constexpr double kTorusVolume = 2 * 9.8696044 * 0.16;

class MeshInput : public testing::Test {
 protected:
  std::filesystem::path made(const std::string& name, std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"-o", folder_ / name, "--quiet"});
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    return folder_ / name;
  }
  std::filesystem::path tessellated(const std::string& name, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "tessellate");
    arguments.insert(arguments.end(), {"--sites", "150", "--iterations", "1"});
    return made(name, arguments);
  }
  static void expectSame(const std::filesystem::path& a, const std::filesystem::path& b) {
    EXPECT_EQ(namesIn(a), namesIn(b));
    for (const std::string& name : namesIn(a)) {
      if (name == "metrics.json") continue;
      EXPECT_TRUE(readFile(a / name) == readFile(b / name)) << name;
    }
  }
  int exitCode(std::vector<std::string> arguments, std::string& message) {
    arguments.insert(arguments.end(), {"-o", folder_ / "none"});
    const Outcome outcome = run(arguments);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "none"));
    message = outcome.err;
    return outcome.exitCode;
  }

  TemporaryFolder folder_;
  std::string mesh_ = folder_.write("torus.off", torusOff());
};

TEST_F(MeshInput, BecomesSignedDistance) {
  const auto folder = tessellated("out", {mesh_});
  EXPECT_THAT(namesIn(folder),
              ElementsAre("cells.vtu", "form.json", "form.ply", "metrics.json", "sites.ply", "surface.ply"));
  const auto metrics = readJson(folder / "metrics.json");
  EXPECT_EQ(metrics["input"]["kind"], "mesh");
  EXPECT_EQ(metrics["implicit"]["kind"], "distance");
  EXPECT_EQ(metrics["mesh"]["faces"], 2304);
  EXPECT_EQ(metrics["validity"]["valid"], true);
  EXPECT_EQ(metrics["validity"]["euler_characteristic"], 0);
  EXPECT_EQ(metrics["fidelity"]["unsupported_share"], nullptr);
}

TEST_F(MeshInput, AStoredFormGivesTheSameBits) {
  for (const Vec3& center : {Vec3(0, 0, 0), Vec3(1000.1, -2000.3, 3)}) {
    const std::string mesh = folder_.write("moved.off", torusOff(center));
    const auto first = tessellated("first", {mesh, "--rotation-seed", "7"});
    const auto second = tessellated("second", {(first / "form.ply").string()});
    expectSame(first, second);
    const auto measured = readJson(first / "metrics.json");
    ASSERT_EQ(run({"evaluate", first}).exitCode, 0);
    const auto again = readJson(first / "metrics.json");
    for (const char* key : {"input", "counts", "validity", "fidelity", "regularity", "sha256"}) {
      EXPECT_EQ(measured[key], again[key]) << key;
    }
  }
}

TEST_F(MeshInput, ThreadsLeaveNoTrace) {
  expectSame(tessellated("one", {mesh_, "--threads", "1"}), tessellated("two", {mesh_, "--threads", "2"}));
}

TEST_F(MeshInput, BecomesPoissonOnSamples) {
  const auto folder = tessellated("out", {mesh_, "--implicit", "poisson", "--samples", "3000"});
  const auto form = readJson(folder / "form.json");
  EXPECT_EQ(form["implicit"]["kind"], "poisson");
  EXPECT_EQ(form["mesh"]["samples"], 3000);
  EXPECT_EQ(form["points"]["points"], 3000);
  EXPECT_EQ(form["points"]["normals_estimated"], false);
  EXPECT_EQ(form["implicit"]["wrong_normal_share"], 0);
  EXPECT_EQ(readJson(folder / "metrics.json")["validity"]["euler_characteristic"], 0);
  expectSame(folder, tessellated("again", {(folder / "form.vtu").string()}));
  // Other samples, another form.
  const auto other = tessellated("other", {mesh_, "--implicit", "poisson", "--samples", "3000", "--seed", "1"});
  EXPECT_FALSE(readFile(folder / "points.ply") == readFile(other / "points.ply"));
}

TEST_F(MeshInput, ARotationIsRecordedAndTurnsEveryKindOfInput) {
  const auto plain = made("plain", {"implicit", mesh_});
  const auto turned = made("turned", {"implicit", mesh_, "--rotation-seed", "0"});
  EXPECT_FALSE(readFile(plain / "form.ply") == readFile(turned / "form.ply"));
  EXPECT_EQ(readJson(turned / "form.json")["input"]["rotation_seed"], 0);
  EXPECT_FALSE(readJson(plain / "form.json")["input"].contains("rotation_seed"));
  const auto shape = tessellated("shape", {"shape:torus", "--rotation-seed", "3"});
  const auto before = readJson(shape / "metrics.json");
  EXPECT_EQ(before["input"]["rotation_seed"], 3);
  ASSERT_EQ(run({"evaluate", shape}).exitCode, 0);
  EXPECT_EQ(readJson(shape / "metrics.json")["fidelity"], before["fidelity"]);
  const std::string cloud = folder_.write("torus.xyz", xyzText(torusPoints(1500)));
  const auto scan = tessellated("scan", {cloud, "--rotation-seed", "3"});
  expectSame(scan, tessellated("scan2", {(scan / "form.vtu").string()}));
  EXPECT_EQ(readJson(scan / "form.json")["input"]["rotation_seed"], 3);
}

TEST_F(MeshInput, InfoTellsWhatAMeshIs) {
  const Outcome outcome = run({"info", mesh_, "--json"});
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  const auto info = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(info["kind"], "mesh");
  EXPECT_EQ(info["closed"], true);
  EXPECT_EQ(info["components"], 1);
  EXPECT_EQ(info["euler_characteristic"], 0);
  EXPECT_EQ(info["triangles"], 2304);
  EXPECT_NEAR(info["volume"].get<double>(), kTorusVolume, 0.02 * kTorusVolume);
  const auto open =
      nlohmann::json::parse(run({"info", folder_.write("open.off", torusOff(Vec3::Zero(), 1)), "--json"}).out);
  EXPECT_EQ(open["closed"], false);
  EXPECT_EQ(open["faces"], 2303);
  EXPECT_THAT(open["problem"].get<std::string>(), HasSubstr("is not closed: the edge from vertex"));
}

TEST_F(MeshInput, BadMeshesAreInputErrorsThatNameThePlace) {
  std::string message;
  EXPECT_EQ(exitCode({"tessellate", folder_.write("open.off", torusOff(Vec3::Zero(), 1))}, message), 3);
  EXPECT_THAT(message, AllOf(HasSubstr("open.off: the mesh is not closed: the edge from vertex"),
                             HasSubstr("(the first of 3 such edges)")));
  EXPECT_EQ(exitCode({"implicit", folder_.write("word.obj", "v 0 0 0\nv 1 0 O\n")}, message), 3);
  EXPECT_THAT(message, HasSubstr("word.obj:2: expected a number for z, found \"O\""));
  EXPECT_EQ(exitCode({"reconstruct", folder_.write("cut.stl", "solid\nfacet normal 0 0 1\n")}, message), 3);
  EXPECT_THAT(message, HasSubstr("cut.stl: file ends within triangle 1"));
  EXPECT_EQ(exitCode({"tessellate", folder_ / "missing.obj"}, message), 3);
}

TEST_F(MeshInput, OptionsWithoutMeaningAreUsageErrors) {
  const std::string cloud = folder_.write("torus.xyz", xyzText(torusPoints(200)));
  std::string message;
  EXPECT_EQ(exitCode({"tessellate", cloud, "--implicit", "distance"}, message), 2);
  EXPECT_THAT(message, HasSubstr("a cloud needs Poisson"));
  EXPECT_EQ(exitCode({"tessellate", cloud, "--samples", "200"}, message), 2);
  EXPECT_THAT(message, HasSubstr("--samples"));
  EXPECT_EQ(exitCode({"tessellate", mesh_, "--envelope", "none"}, message), 2);
  EXPECT_THAT(message, HasSubstr("--envelope"));
  EXPECT_EQ(exitCode({"tessellate", mesh_, "--samples", "200"}, message), 2);
  EXPECT_EQ(exitCode({"tessellate", mesh_, "--samples", "99", "--implicit", "poisson"}, message), 2);
  EXPECT_EQ(exitCode({"tessellate", mesh_, "--implicit", "levels"}, message), 2);
  EXPECT_EQ(exitCode({"tessellate", mesh_, "--rotation-seed", "-1"}, message), 2);
  EXPECT_EQ(exitCode({"tessellate", "shape:torus", "--implicit", "distance"}, message), 2);
  const auto form = made("form", {"implicit", mesh_}) / "form.ply";
  EXPECT_EQ(exitCode({"tessellate", form, "--rotation-seed", "1"}, message), 2);
  EXPECT_EQ(exitCode({"reconstruct", form}, message), 2);
  EXPECT_EQ(exitCode({"implicit", form}, message), 2);
}

}  // namespace
}  // namespace voroform::test
