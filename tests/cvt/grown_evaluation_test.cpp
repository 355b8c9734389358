// The energy of sites in a domain that is grown by a layer on its boundary.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "voroform/cvt/implicit_domain.hpp"
#include "voroform/cvt/initial_sites.hpp"
#include "voroform/cvt/planar_domain.hpp"
#include "voroform/implicit/shapes.hpp"

namespace voroform::cvt {
namespace {

TEST(EvaluateGrown, SweepsTheBoundaryOutward) {
  const mesh::PlanarRegion square = mesh::squareRegion();
  const PlanarDomain domain(square);
  const std::vector<Vec2> site = {{1, 2}};
  const double t = 0.5;
  const auto plain = domain.evaluate(site, {}).moments[0];
  const auto grown = domain.evaluateGrown(site, t, {}).moments[0];
  EXPECT_NEAR(grown.mass, 400 + 80 * t, 1e-9);
  // Of opposite layers only what the site is off the center stays: each is 20·t large.
  EXPECT_NEAR((grown.first - plain.first - 80 * t * (Vec2(0, 0) - site[0])).norm(), 0, 1e-9);
  // ∫ x² over [10, 10 + t] × [−10, 10] and ∫ y²; four of these about the center, and the site's offset.
  const double along = 20 * (std::pow(10 + t, 3) - 1000) / 3;
  const double across = t * 2000 / 3;
  EXPECT_NEAR(grown.second - plain.second, 4 * (along + across) + 80 * t * site[0].squaredNorm(), 1e-8);
}

TEST(EvaluateGrown, GivesEachCellItsOwnPieces) {
  const mesh::PlanarRegion square = mesh::squareRegion();
  const PlanarDomain domain(square);
  const std::vector<Vec2> sites = {{-5, 0}, {5, 0}};
  const double t = 0.5;
  const auto plain = domain.evaluate(sites, {}).moments;
  const auto grown = domain.evaluateGrown(sites, t, {}).moments;
  // The layer on the far side has its centroid t/2 beyond it; those above and below balance.
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(grown[i].mass - plain[i].mass, 40 * t, 1e-9);
    const Vec2 expected(20 * t * (5 + t / 2) * (i == 0 ? -1 : 1), 0);
    EXPECT_NEAR((grown[i].first - plain[i].first - expected).norm(), 0, 1e-9);
  }
}

TEST(EvaluateGrown, GrowsABall) {
  const auto ball = implicit::sphere(1);
  const ImplicitDomain domain(*ball);
  const auto sites = randomSites<3>(domain, 4000, 1, {});
  const double t = 0.01;
  const Evaluation<3> plain = domain.evaluate(sites, {});
  EXPECT_EQ(domain.evaluateGrown(sites, 0, {}).energy, plain.energy);
  const Evaluation<3> grown = domain.evaluateGrown(sites, t, {});
  EXPECT_NEAR(grown.volume - plain.volume, 4 * std::numbers::pi * t, 0.01 * 4 * std::numbers::pi * t);
  // Boundary cells' centroids move outward.
  double outward = 0;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    outward += (grown.moments[i].first - plain.moments[i].first).dot(sites[i].normalized());
  }
  EXPECT_GT(outward, 0);
}

TEST(EvaluateGrown, ADensityOfOneChangesNothing) {
  const mesh::PlanarRegion star = mesh::starRegion();
  PlanarDomain domain(star);
  const auto sites = randomSites<2>(domain, 300, 1, {});
  const double energy = domain.evaluateGrown(sites, 0.2, {}).energy;
  domain.setDensity(std::make_shared<const Density<2>>([](const Vec2&) { return 1.0; }, 1.0));
  EXPECT_NEAR(domain.evaluateGrown(sites, 0.2, {}).energy, energy, 1e-12 * energy);
  // Cells twice as wide everywhere: ρ = 1/16, and the layer is twice as thick.
  domain.setDensity(std::make_shared<const Density<2>>([](const Vec2&) { return 2.0; }, 2.0));
  EXPECT_NEAR(domain.evaluateGrown(sites, 0.1, {}).energy, energy / 16, 1e-12 * energy);
}

}  // namespace
}  // namespace voroform::cvt
