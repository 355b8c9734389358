#include "voroform/implicit/shapes.hpp"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/implicit_laws.hpp"
#include "voroform/core/error.hpp"

namespace voroform::implicit {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr double kPi = std::numbers::pi;
constexpr double kExact = 1e-14;

double volumeOf(const ImplicitFunction& f, std::uint64_t samples) {
  const Box3 box = f.bounds();
  std::uint64_t inside = 0;
  for (std::uint64_t i = 0; i < samples; ++i) inside += f.value(quasiRandomInBox(7, i, box)) < 0 ? 1U : 0U;
  return box.volume() * static_cast<double>(inside) / static_cast<double>(samples);
}

class NamedShapes : public ::testing::TestWithParam<std::string> {};

TEST_P(NamedShapes, ObeyTheLaws) { EXPECT_THAT(test::violatedLaws(namedShape(GetParam()), {}), IsEmpty()); }

TEST_P(NamedShapes, ObeyTheLawsWhenMoved) {
  const ImplicitPtr moved = transformed(namedShape(GetParam()), randomRotation(3), Vec3(100, -7, 0.1), 0.01);
  EXPECT_THAT(test::violatedLaws(moved, {.seed = 5}), IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(Catalog, NamedShapes, ::testing::ValuesIn(shapeNames()), [](const auto& tested) {
  std::string name = tested.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST(Shapes, AreTheSevenOfTheCommandLine) {
  EXPECT_THAT(shapeNames(),
              ElementsAre("sphere", "torus", "box", "ellipsoid", "bumpy-sphere", "gyroid-ball", "two-tori"));
}

TEST(Shapes, AnUnknownNameIsRefusedWithTheKnownOnes) {
  try {
    namedShape("thorus");
    FAIL() << "no exception";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("'thorus'"));
    EXPECT_THAT(error.what(), HasSubstr("bumpy-sphere, gyroid-ball, two-tori"));
  }
}

TEST(Shapes, RefuseSizesThatMakeNoSolid) {
  EXPECT_THROW(sphere(0), UsageError);
  EXPECT_THROW(sphere(std::nan("")), UsageError);
  EXPECT_THROW(torus(1, -1), UsageError);
  EXPECT_THROW(box(Vec3(1, 0, 1)), UsageError);
  EXPECT_THROW(ellipsoid(Vec3(1, 1, -1)), UsageError);
  EXPECT_THROW(transformed(sphere(1), 2 * Mat3::Identity(), Vec3::Zero()), UsageError);
  EXPECT_THROW(transformed(sphere(1), Mat3::Identity(), Vec3::Zero(), 0), UsageError);
  EXPECT_THROW(unionOf(sphere(1), nullptr), UsageError);
  EXPECT_THROW(enveloped(sphere(1), Box3()), UsageError);
}

TEST(Shapes, HaveTheirKnownVolumes) {
  constexpr std::uint64_t kSamples = 400000;
  constexpr double kShare = 3e-3;  // several times the error of so many quasi-random samples
  const auto near = [](double volume) { return ::testing::DoubleNear(volume, kShare * volume); };
  EXPECT_THAT(volumeOf(*namedShape("sphere"), kSamples), near(4 * kPi / 3));
  EXPECT_THAT(volumeOf(*namedShape("torus"), kSamples), near(2 * kPi * kPi * 0.16));
  EXPECT_THAT(volumeOf(*namedShape("box"), kSamples), near(8));
  EXPECT_THAT(volumeOf(*namedShape("ellipsoid"), kSamples), near(4 * kPi / 3 * 0.35));
  // Odd bumps cancel to first order: ∫ (1 + 0.12 s)³/3 dω = 4π/3·(1 + 3·0.0144·⟨s²⟩), ⟨s²⟩ by the same samples below
  // 1/4.
  EXPECT_THAT(volumeOf(*namedShape("bumpy-sphere"), kSamples),
              ::testing::AllOf(::testing::Gt(4.18), ::testing::Lt(4.24)));
  EXPECT_THAT(volumeOf(*namedShape("two-tori"), kSamples), near(2 * 2 * kPi * kPi * 0.7 * 0.04));
}

TEST(Shapes, HaveTheirKnownValues) {
  EXPECT_DOUBLE_EQ(namedShape("sphere")->value(Vec3(0, 3, 4)), 4);
  EXPECT_NEAR(namedShape("torus")->value(Vec3(0, 1, 0.4)), 0, kExact);
  EXPECT_NEAR(namedShape("torus")->value(Vec3(0, 0, 0)), 0.6, kExact);
  EXPECT_DOUBLE_EQ(namedShape("box")->value(Vec3(0.5, 0, 0)), -0.5);
  EXPECT_DOUBLE_EQ(namedShape("box")->value(Vec3(4, 5, 1)), 5);
  EXPECT_NEAR(namedShape("ellipsoid")->value(Vec3(0, 0.7, 0)), 0, kExact);
  EXPECT_DOUBLE_EQ(namedShape("ellipsoid")->value(Vec3(2, 0, 0)), 0.5);
  const Vec3 n = Vec3(1, 1, 1).normalized();
  const double bump = 0.12 * std::pow(std::sin(6 / std::sqrt(3.0)), 3);
  EXPECT_NEAR(namedShape("bumpy-sphere")->value(1.5 * n), 0.5 - bump, kExact);
  EXPECT_LT(namedShape("bumpy-sphere")->value(Vec3::Zero()), 0);
  const Vec3 p(0.1, 0.2, 0.3);
  const double gyroid = std::sin(0.7) * std::cos(1.4) + std::sin(1.4) * std::cos(2.1) + std::sin(2.1) * std::cos(0.7);
  EXPECT_NEAR(namedShape("gyroid-ball")->value(p), std::max(p.norm() - 1, gyroid), kExact);
  EXPECT_NEAR(namedShape("two-tori")->value(Vec3(-0.35 + 0.7, 0, 0)), -0.2, kExact);  // on the first ring's circle
  EXPECT_NEAR(namedShape("two-tori")->value(Vec3(0.35, 0, 0.7)), -0.2, kExact);       // on the second's
}

TEST(Shapes, ClearanceIsTheDistanceWhereThatIsKnown) {
  constexpr double kRounding = 1e-12;
  for (const Vec3& p : {Vec3(0.2, 0.1, 0), Vec3(2, -3, 1), Vec3(0.9, 0.3, 0.1)}) {
    EXPECT_NEAR(namedShape("sphere")->clearance(p), p.norm() - 1, kRounding);
    EXPECT_NEAR(namedShape("torus")->clearance(p), namedShape("torus")->value(p), kRounding);
    EXPECT_NEAR(namedShape("box")->clearance(p), namedShape("box")->value(p), kRounding);
  }
  EXPECT_EQ(namedShape("sphere")->clearance(Vec3(1, 0, 0)), 0);
}

TEST(Csg, CombinesSolids) {
  const ImplicitPtr a = sphere(1);
  const ImplicitPtr b = transformed(sphere(1), Mat3::Identity(), Vec3(1, 0, 0));
  const Vec3 onlyA(-0.5, 0, 0);
  const Vec3 both(0.5, 0.1, 0);
  const Vec3 onlyB(1.5, 0, 0);
  const auto inside = [](const ImplicitPtr& f, const Vec3& p) { return f->value(p) < 0; };
  EXPECT_TRUE(inside(unionOf(a, b), onlyA) && inside(unionOf(a, b), both) && inside(unionOf(a, b), onlyB));
  EXPECT_TRUE(!inside(intersectionOf(a, b), onlyA) && inside(intersectionOf(a, b), both));
  EXPECT_TRUE(inside(differenceOf(a, b), onlyA) && !inside(differenceOf(a, b), both) &&
              !inside(differenceOf(a, b), onlyB));
  EXPECT_NEAR(intersectionOf(a, b)->bounds().sizes().x(), 1, 1e-6);
  EXPECT_NEAR(unionOf(a, b)->bounds().sizes().x(), 3, 1e-6);
}

TEST(Csg, ObeysTheLaws) {
  const ImplicitPtr a = torus(1, 0.4);
  const ImplicitPtr b = transformed(box(Vec3(1, 2, 3)), randomRotation(9), Vec3(0.4, 0.1, 0));
  EXPECT_THAT(test::violatedLaws(unionOf(a, b), {}), IsEmpty());
  EXPECT_THAT(test::violatedLaws(intersectionOf(a, b), {}), IsEmpty());
  EXPECT_THAT(test::violatedLaws(differenceOf(a, b), {}), IsEmpty());
  EXPECT_THAT(test::violatedLaws(differenceOf(b, unionOf(a, bumpySphere())), {.decidedShare = 0.3}), IsEmpty());
}

TEST(Envelope, ClosesTheSolidAndKnowsItsFaces) {
  const Box3 box(Vec3(-2, -2, -0.5), Vec3(2, 2, 2));
  const ImplicitPtr cut = enveloped(sphere(1), box);
  EXPECT_THAT(test::violatedLaws(cut, {}), IsEmpty());
  EXPECT_EQ(cut->value(Vec3(0, 0, -0.75)), 0.25);
  EXPECT_TRUE(cut->onEnvelope(Vec3(0.1, 0.2, -0.5)));
  EXPECT_FALSE(cut->onEnvelope(Vec3(0, 0, 1)));
  EXPECT_FALSE(cut->onEnvelope(Vec3(0.6, 0.8, 0)));
  EXPECT_EQ(cut->gradient(Vec3(0.1, 0.2, -0.5)), Vec3(0, 0, -1));
  EXPECT_NEAR(cut->bounds().min().z(), -0.5, 1e-6);
  EXPECT_NEAR(cut->bounds().max().z(), 1, 1e-6);
  // The mark survives motions and set operations.
  const ImplicitPtr moved = transformed(cut, Mat3::Identity(), Vec3(5, 0, 0), 2);
  EXPECT_TRUE(moved->onEnvelope(Vec3(5.2, 0.4, -1)));
  EXPECT_TRUE(unionOf(cut, transformed(sphere(1), Mat3::Identity(), Vec3(9, 0, 0)))->onEnvelope(Vec3(0.1, 0.2, -0.5)));
}

// Each of these breaks one law, and the check must say which.
class Unlawful : public ImplicitFunction {
 public:
  double value(const Vec3& p) const override { return p.norm() - 1; }
  Vec3 gradient(const Vec3& p) const override { return p.normalized(); }
  Box3 bounds() const override { return {Vec3::Constant(-1.001), Vec3::Constant(1.001)}; }
  double clearance(const Vec3& p) const override { return 0.99 * value(p); }
};

TEST(Laws, AcceptALawfulControl) { EXPECT_THAT(test::violatedLaws(std::make_shared<Unlawful>(), {}), IsEmpty()); }

TEST(Laws, RejectAWrongGradient) {
  struct Wrong : Unlawful {
    Vec3 gradient(const Vec3& p) const override { return 1.01 * p.normalized(); }
  };
  EXPECT_THAT(test::violatedLaws(std::make_shared<Wrong>(), {}), ElementsAre(HasSubstr("gradient")));
}

TEST(Laws, RejectBoundsThatCutTheSolid) {
  struct Tight : Unlawful {
    Box3 bounds() const override { return {Vec3::Constant(-0.98), Vec3::Constant(0.98)}; }
  };
  EXPECT_THAT(test::violatedLaws(std::make_shared<Tight>(), {}), ElementsAre(HasSubstr("bounds")));
}

TEST(Laws, RejectAClearanceThatIsTooLarge) {
  struct Greedy : Unlawful {
    double clearance(const Vec3& p) const override { return 1.02 * value(p); }
  };
  EXPECT_THAT(test::violatedLaws(std::make_shared<Greedy>(), {}), ElementsAre(HasSubstr("balls meet S")));
}

TEST(Laws, RejectAClearanceThatContradictsNearTheSurface) {
  struct Contradicting : Unlawful {
    double clearance(const Vec3& p) const override {
      const double v = value(p);
      return std::abs(v) < 1e-7 ? -1e-30 : 0.99 * v;
    }
  };
  EXPECT_THAT(test::violatedLaws(std::make_shared<Contradicting>(), {}), Contains(HasSubstr("signs contradict f")));
}

TEST(Laws, RejectAnIdleClearance) {
  struct Idle : Unlawful {
    double clearance(const Vec3& p) const override { return static_cast<void>(p), 0.0; }
  };
  EXPECT_THAT(test::violatedLaws(std::make_shared<Idle>(), {}), ElementsAre(HasSubstr("decides only")));
}

TEST(Laws, RejectListsThatDifferInTheLastBit) {
  struct Sloppy : Unlawful {
    void values(std::span<const Vec3> points, std::span<double> out) const override {
      for (std::size_t i = 0; i < points.size(); ++i) out[i] = std::nextafter(value(points[i]), 9);
    }
  };
  EXPECT_THAT(test::violatedLaws(std::make_shared<Sloppy>(), {}), ElementsAre(HasSubstr("other bits")));
}

TEST(Laws, RejectAFunctionWithoutAnInside) {
  struct Empty : Unlawful {
    double value(const Vec3& p) const override { return p.norm(); }
    double clearance(const Vec3& p) const override { return 0.99 * p.norm(); }
  };
  EXPECT_THAT(test::violatedLaws(std::make_shared<Empty>(), {}), Contains(HasSubstr("no inside")));
}

TEST(ImplicitFunction, ListsOfUnlikeLengthsAreRefused) {
  const std::vector<Vec3> points(3, Vec3::Zero());
  std::vector<double> out(2);
  EXPECT_THROW(sphere(1)->values(points, out), std::invalid_argument);
  EXPECT_THROW(sphere(1)->clearances(points, out), std::invalid_argument);
}

}  // namespace
}  // namespace voroform::implicit
