#include "voroform/implicit/roots.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "voroform/core/error.hpp"
#include "voroform/core/random.hpp"
#include "voroform/implicit/shapes.hpp"

namespace voroform::implicit {
namespace {

// A function of x alone.
class Profile final : public ImplicitFunction {
 public:
  explicit Profile(std::function<double(double)> profile) : profile_(std::move(profile)) {}
  double value(const Vec3& p) const override { return profile_(p.x()); }
  Vec3 gradient(const Vec3& p) const override { return static_cast<void>(p), Vec3(Vec3::UnitX()); }
  Box3 bounds() const override { return {Vec3::Zero(), Vec3::Ones()}; }

 private:
  std::function<double(double)> profile_;
};

struct Root {
  double t;
  std::int64_t evaluations;
};

Root rootOf(const std::function<double(double)>& profile, double tolerance, RootFinder finder) {
  const Profile f(profile);
  Root root{0, 0};
  root.t = findRoot(f, Vec3::Zero(), Vec3::UnitX(), profile(0), profile(1), tolerance, finder, root.evaluations);
  return root;
}

struct Problem {
  const char* name;
  std::function<double(double)> profile;
  double root;
};

const std::vector<Problem>& problems() {
  static const std::vector<Problem> list = {
      {"linear", [](double x) { return x - 0.3; }, 0.3},
      {"falling", [](double x) { return 0.7 - x; }, 0.7},
      {"square", [](double x) { return x * x - 0.5; }, std::sqrt(0.5)},
      {"flat cubic", [](double x) { return std::pow(x - 0.6, 3); }, 0.6},
      {"flat ninth power", [](double x) { return std::pow(x - 0.123, 9); }, 0.123},
      {"steep at one end", [](double x) { return std::exp(30 * x) - std::exp(28.0); }, 28.0 / 30},
      {"step", [](double x) { return x < 0.37 ? -1.0 : 1.0; }, 0.37},
      {"lopsided step", [](double x) { return x < 1e-3 ? -1e-12 : 1e12; }, 1e-3},
      {"kink", [](double x) { return x < 0.4 ? 100 * (x - 0.4) : 1e-3 * (x - 0.4); }, 0.4},
      {"near an end", [](double x) { return x - 1e-7; }, 1e-7},
      {"near the other end", [](double x) { return x - (1 - 1e-9); }, 1 - 1e-9},
  };
  return list;
}

TEST(Roots, AreFoundToTheTolerance) {
  for (const Problem& problem : problems()) {
    for (const RootFinder finder : {RootFinder::itp, RootFinder::bisection}) {
      for (const double tolerance : {1e-3, 1e-8, 1e-12, 1e-15}) {
        const double slack = 4 * std::numeric_limits<double>::epsilon();
        EXPECT_NEAR(rootOf(problem.profile, tolerance, finder).t, problem.root, tolerance + slack)
            << problem.name << ", tolerance " << tolerance;
      }
    }
  }
}

TEST(Roots, ItpTakesAtMostOneStepMoreThanBisection) {
  for (const Problem& problem : problems()) {
    for (const double tolerance : {1e-1, 1e-3, 0.0009765625, 1e-8, 1e-12, 1e-15}) {
      const auto most = static_cast<std::int64_t>(std::ceil(-std::log2(tolerance)));
      EXPECT_LE(rootOf(problem.profile, tolerance, RootFinder::bisection).evaluations, most) << problem.name;
      EXPECT_LE(rootOf(problem.profile, tolerance, RootFinder::itp).evaluations, most + 1)
          << problem.name << ", tolerance " << tolerance;
    }
  }
}

TEST(Roots, ItpIsFarCheaperOnSmoothFunctions) {
  constexpr double kTolerance = 1e-12;
  const ImplicitPtr torus = namedShape("torus");
  std::int64_t itp = 0;
  std::int64_t bisection = 0;
  int found = 0;
  const Box3 box = torus->bounds();
  for (std::uint64_t i = 0; i < 4000; ++i) {
    const Vec3 a = randomInBox(1, RandomStream::test, 2 * i, box);
    const Vec3 b = a + 0.1 * randomInBox(1, RandomStream::test, 2 * i + 1, box);
    const double valueA = torus->value(a);
    const double valueB = torus->value(b);
    if ((valueA < 0) == (valueB < 0)) continue;
    ++found;
    const double t = findRoot(*torus, a, b, valueA, valueB, kTolerance, RootFinder::itp, itp);
    const double reference = findRoot(*torus, a, b, valueA, valueB, kTolerance, RootFinder::bisection, bisection);
    EXPECT_NEAR(t, reference, 2 * kTolerance);
    EXPECT_NEAR(torus->value(a + t * (b - a)), 0, 1e-12);
  }
  EXPECT_GT(found, 100);
  EXPECT_LT(3 * itp, bisection);
}

TEST(Roots, LieStrictlyBetweenTheEnds) {
  for (const RootFinder finder : {RootFinder::itp, RootFinder::bisection}) {
    const double low = rootOf([](double x) { return x - 1e-30; }, 1e-12, finder).t;
    EXPECT_GT(low, 0);
    EXPECT_LT(low, 1e-11);
    const double high = rootOf([](double x) { return x < 1 ? -1.0 : 1.0; }, 1e-15, finder).t;
    EXPECT_LT(high, 1);
    EXPECT_GT(high, 1 - 1e-11);
  }
}

TEST(Roots, AnExactZeroEndsTheSearch) {
  const Root root = rootOf([](double x) { return x - 0.5; }, 1e-12, RootFinder::bisection);
  EXPECT_EQ(root.t, 0.5);
  EXPECT_EQ(root.evaluations, 1);
}

TEST(Roots, AZeroEndCountsAsOutside) {
  const Root root = rootOf([](double x) { return -x; }, 1e-12, RootFinder::itp);
  EXPECT_GT(root.t, 0);
  EXPECT_LT(root.t, 1e-11);
}

TEST(Roots, EndsOfOneSignAreRefused) {
  EXPECT_THROW(rootOf([](double x) { return x + 1; }, 1e-12, RootFinder::itp), Error);
  EXPECT_THROW(rootOf([](double x) { return x - 2; }, 1e-12, RootFinder::bisection), Error);
}

TEST(Roots, SurviveInfiniteValues) {
  const double infinity = std::numeric_limits<double>::infinity();
  const Root root = rootOf([&](double x) { return x < 0.25 ? -infinity : infinity; }, 1e-12, RootFinder::itp);
  EXPECT_NEAR(root.t, 0.25, 1e-12);
}

}  // namespace
}  // namespace voroform::implicit
