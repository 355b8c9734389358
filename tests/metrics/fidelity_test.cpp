// Fidelity figures with known answers: complexes of cubes against boxes.
#include "voroform/metrics/fidelity.hpp"

#include <gtest/gtest.h>

#include <atomic>

#include "support/complexes.hpp"
#include "voroform/core/random.hpp"

namespace voroform::metrics {
namespace {

// The maximum norm's distance to a box, negative inside. The oracle decides what is farther than `silence` from it.
class BoxForm final : public implicit::ImplicitFunction {
 public:
  BoxForm(const Box3& box, double silence) : box_(box), silence_(silence) {}
  double value(const Vec3& p) const override {
    ++asked_;
    return distance(p);
  }
  Vec3 gradient(const Vec3&) const override { return Vec3::Zero(); }
  Box3 bounds() const override { return {box_.min().array() - 0.5, box_.max().array() + 0.5}; }
  double clearance(const Vec3& p) const override {
    const double d = distance(p);
    return std::abs(d) > silence_ ? d : 0;
  }
  std::int64_t asked() const { return asked_; }

 private:
  double distance(const Vec3& p) const {
    return (p - box_.center()).cwiseAbs().cwiseQuotient(box_.sizes() / 2).maxCoeff() - 1;
  }
  Box3 box_;
  double silence_;
  mutable std::atomic<std::int64_t> asked_{0};
};

BoxForm boxForm(const Vec3& min, const Vec3& max, double silence = 0) { return {Box3(min, max), silence}; }

// A quasi-random volume is far better than a random one; the bounds are those of random points.
constexpr double kSigmas = 3;

FidelityOptions someSamples() {
  FidelityOptions options;
  options.volumeSamples = 200'000;
  return options;
}

TEST(Fidelity, ExactComplex) {
  const BoxForm form = boxForm(Vec3::Zero(), Vec3::Constant(3));
  const Fidelity result = fidelity(testing::block(3), form, someSamples(), RunContext{});
  EXPECT_NEAR(result.sampledVolume, 27, kSigmas * result.sampledVolumeSigma);
  // V √(p(1 − p)/n) with p = 27/64.
  EXPECT_NEAR(result.sampledVolumeSigma, 64 * std::sqrt(27.0 / 64 * 37 / 64 / 200'000), 1e-3);
  EXPECT_LE(result.volumeError, 1e-3);
  EXPECT_EQ(result.missedShare, 0);
  EXPECT_GT(result.missedSamples, 80'000);
  EXPECT_EQ(result.disconnectedCells, 0);
  EXPECT_EQ(result.envelopeShare, 0);
  EXPECT_EQ(result.unsupportedShare, 0);
}

TEST(Fidelity, MissingPartIsMissed) {
  // The form has 27 cubes, the complex 18 of them.
  std::vector<std::array<int, 3>> places;
  for (int i = 0; i < 18; ++i) places.push_back({i % 3, i / 3 % 3, i / 9});
  const BoxForm form = boxForm(Vec3::Zero(), Vec3::Constant(3));
  const Fidelity result = fidelity(testing::cubes(places), form, someSamples(), RunContext{});
  EXPECT_NEAR(result.missedShare, 1.0 / 3, 0.005);
  EXPECT_NEAR(result.volumeError, 1.0 / 3, 0.005);
}

TEST(Fidelity, ComplexTooLargeMissesNothing) {
  const BoxForm form = boxForm(Vec3::Zero(), Vec3(3, 3, 1.5));
  const Fidelity result = fidelity(testing::block(3), form, someSamples(), RunContext{});
  EXPECT_EQ(result.missedShare, 0);
  EXPECT_NEAR(result.volumeError, 1, 0.01);
}

TEST(Fidelity, FormWithoutInside) {
  const BoxForm form = boxForm(Vec3::Zero(), Vec3::Constant(1e-9));
  const Fidelity result = fidelity(testing::block(1), form, someSamples(), RunContext{});
  EXPECT_EQ(result.sampledVolume, 0);
  EXPECT_EQ(result.volumeError, 1);
  EXPECT_EQ(result.missedSamples, 0);
}

TEST(Fidelity, OracleIsAskedFirst) {
  const BoxForm plain = boxForm(Vec3::Zero(), Vec3::Constant(3), 1e9);
  const BoxForm withOracle = boxForm(Vec3::Zero(), Vec3::Constant(3), 0.05);
  const Fidelity a = fidelity(testing::block(3), plain, someSamples(), RunContext{});
  const Fidelity b = fidelity(testing::block(3), withOracle, someSamples(), RunContext{});
  EXPECT_EQ(plain.asked(), 200'000);
  EXPECT_LT(withOracle.asked(), 40'000);
  EXPECT_EQ(a.sampledVolume, b.sampledVolume);
  EXPECT_EQ(a.missedSamples, b.missedSamples);
}

TEST(Fidelity, TheFormIsSampledOnceForSeveralTessellations) {
  const BoxForm form = boxForm(Vec3::Zero(), Vec3::Constant(3), 1e9);
  const InsideSamples samples = insideSamples(form, someSamples(), RunContext{});
  EXPECT_EQ(form.asked(), 200'000);
  EXPECT_NEAR(samples.volume, 27, kSigmas * samples.volumeSigma);
  for (const int size : {2, 3}) {
    const Fidelity once = fidelity(testing::block(size), samples, someSamples(), RunContext{});
    EXPECT_EQ(form.asked(), 200'000) << "asked again";
    const BoxForm fresh = boxForm(Vec3::Zero(), Vec3::Constant(3), 1e9);
    const Fidelity again = fidelity(testing::block(size), fresh, someSamples(), RunContext{});
    EXPECT_EQ(once.volumeError, again.volumeError);
    EXPECT_EQ(once.missedSamples, again.missedSamples);
    EXPECT_EQ(once.missedShare, again.missedShare);
  }
}

TEST(Fidelity, FewerLookUpsWhenAsked) {
  const BoxForm form = boxForm(Vec3::Zero(), Vec3::Constant(3));
  FidelityOptions options = someSamples();
  options.missedSamples = 20'000;
  const Fidelity result = fidelity(testing::block(3), form, options, RunContext{});
  // 27/64 of them are inside.
  EXPECT_NEAR(static_cast<double>(result.missedSamples), 20'000 * 27.0 / 64, 200);
  options.missedSamples = 0;
  EXPECT_EQ(fidelity(testing::block(3), form, options, RunContext{}).missedSamples, 0);
}

TEST(Fidelity, DisconnectedCells) {
  mesh::PolyhedralComplex complex = testing::cubes({{0, 0, 0}, {1, 0, 0}, {4, 0, 0}, {6, 0, 0}, {7, 1, 0}});
  const BoxForm form = boxForm(Vec3::Zero(), Vec3(3, 3, 3));
  EXPECT_EQ(fidelity(complex, form, someSamples(), RunContext{}).disconnectedCells, 0);
  // Cells 1 and 2 become one cell in two parts; cells 3 and 4 one cell whose parts touch at an edge only.
  for (auto& cells : complex.faceCells) {
    for (Index& cell : cells) {
      if (cell == 2) cell = 1;
      if (cell == 4) cell = 3;
    }
  }
  EXPECT_EQ(fidelity(complex, form, someSamples(), RunContext{}).disconnectedCells, 1);
}

TEST(Fidelity, EnvelopeShareCountsAreas) {
  mesh::PolyhedralComplex complex =
      testing::mapped(testing::block(1), Vec3(1, 2, 3).asDiagonal().toDenseMatrix(), Vec3::Zero());
  // The first face lies at x = 0: 6 of 22.
  complex.faceTags[0] = mesh::FaceTag::envelope;
  const BoxForm form = boxForm(Vec3::Zero(), Vec3(1, 2, 3));
  EXPECT_NEAR(fidelity(complex, form, someSamples(), RunContext{}).envelopeShare, 6.0 / 22, 1e-14);
}

TEST(Fidelity, UnsupportedShareIsFarFromThePoints) {
  // A block of 3³ cubes with points on the five sides but the top, at a spacing of 0.1.
  std::vector<Vec3> points;
  for (int i = 0; i <= 30; ++i) {
    for (int j = 0; j <= 30; ++j) {
      const double a = 0.1 * i;
      const double b = 0.1 * j;
      for (const Vec3& point : {Vec3(a, b, 0), Vec3(0, a, b), Vec3(3, a, b), Vec3(a, 0, b), Vec3(a, 3, b)}) {
        points.push_back(point);
      }
    }
  }
  const BoxForm form = boxForm(Vec3::Zero(), Vec3::Constant(3));
  FidelityOptions options = someSamples();
  options.points = points;
  options.spacing = 0.1;
  // The top's squares are cut along x = y, so their centroids lie at (2/3, 1/3) and (1/3, 2/3). Nearer than 0.4 to the
  // rim: both of the corner squares at (0, 0) and (2, 2), one of each other corner square and of each edge square; ten
  // triangles of half a unit.
  const Fidelity result = fidelity(testing::block(3), form, options, RunContext{});
  EXPECT_NEAR(result.unsupportedShare, (9 - 5.0) / 54, 1e-14);
  options.spacing = 0.05;
  EXPECT_NEAR(fidelity(testing::block(3), form, options, RunContext{}).unsupportedShare, 9.0 / 54, 1e-14);
  options.spacing = 1;
  EXPECT_EQ(fidelity(testing::block(3), form, options, RunContext{}).unsupportedShare, 0);
}

TEST(Fidelity, SameBitsForAnyNumberOfThreads) {
  const mesh::PolyhedralComplex complex = testing::mapped(testing::block(4), randomRotation(6), Vec3(0.1, 0, 0));
  const BoxForm form = boxForm(Vec3::Zero(), Vec3::Constant(3), 0.1);
  const std::vector<Vec3> points(1, Vec3(0.1, 0, 0));
  FidelityOptions options = someSamples();
  options.points = points;
  options.spacing = 0.4;
  RunContext one;
  one.threads = 1;
  RunContext four;
  four.threads = 4;
  const Fidelity a = fidelity(complex, form, options, one);
  const Fidelity b = fidelity(complex, form, options, four);
  EXPECT_EQ(a.sampledVolume, b.sampledVolume);
  EXPECT_EQ(a.missedShare, b.missedShare);
  EXPECT_GT(a.missedShare, 0);
  EXPECT_EQ(a.unsupportedShare, b.unsupportedShare);
  EXPECT_GT(a.unsupportedShare, 0);
}

}  // namespace
}  // namespace voroform::metrics
