#include "clean.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <sstream>

#include "voroform/core/error.hpp"

namespace voroform::points {
namespace {

constexpr std::size_t kFewestPoints = 50;
// Extents beyond this range would overflow or underflow when squared and cubed.
constexpr double kLargestDiagonal = 1e100;
constexpr double kSmallestDiagonal = 1e-100;

// Keeps the records for which keep(i) holds; returns how many went. `keep` is called once an index, in order.
template <class Keep>
std::uint64_t dropUnless(PointCloud& cloud, const Keep& keep) {
  const std::size_t before = cloud.positions.size();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < before; ++i) {
    if (!keep(i)) continue;
    cloud.positions[kept] = cloud.positions[i];
    if (cloud.hasNormals()) cloud.normals[kept] = cloud.normals[i];
    ++kept;
  }
  // A cloud with normals whose records are all dropped ends without: nothing is left to estimate them from either.
  if (cloud.hasNormals()) cloud.normals.resize(kept);
  cloud.positions.resize(kept);
  return before - kept;
}

std::uint64_t mix(std::uint64_t bits) {
  bits = (bits ^ (bits >> 30U)) * 0xbf58476d1ce4e5b9U;
  bits = (bits ^ (bits >> 27U)) * 0x94d049bb133111ebU;
  return bits ^ (bits >> 31U);
}

std::uint64_t hashOf(const Vec3& position) {
  std::uint64_t hash = 0;
  // Adding zero makes −0 to +0, which compare equal.
  for (const double value : position)
    hash = mix(hash + 0x9e3779b97f4a7c15U + std::bit_cast<std::uint64_t>(value + 0.0));
  return hash;
}

std::string extentText(const Box3& box) {
  const Vec3 sizes = box.sizes();
  std::ostringstream text;
  text << sizes.x() << " × " << sizes.y() << " × " << sizes.z();
  return text.str();
}

std::string countsText(const PrepareSummary& summary) {
  return std::to_string(summary.records) + " records, dropped: " + std::to_string(summary.nonFinite) +
         " with NaN or infinite values, " + std::to_string(summary.zeroNormals) + " with zero normals, " +
         std::to_string(summary.duplicates) + " duplicates" +
         (summary.unoriented > 0 ? ", " + std::to_string(summary.unoriented) + " not oriented" : std::string());
}

// Root-mean-square extents along the principal axes, smallest first.
Vec3 principalExtents(const std::vector<Vec3>& positions) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : positions) mean += p;
  mean /= static_cast<double>(positions.size());
  Mat3 covariance = Mat3::Zero();
  for (const Vec3& p : positions) covariance += (p - mean) * (p - mean).transpose();
  covariance /= static_cast<double>(positions.size());
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(covariance, Eigen::EigenvaluesOnly);
  return solver.eigenvalues().cwiseMax(0).cwiseSqrt();
}

// The thickness below which a cloud counts as flat. Files often hold floats or six digits, so a plane lies in them only
// to a few units of float precision of its extent; and to double precision of the distance to the input's origin.
double flatThickness(const PointCloud& cloud, const Box3& box) {
  const double storedTo = 16.0 * static_cast<double>(std::numeric_limits<float>::epsilon()) * box.diagonal().norm();
  const double largest =
      (box.min() + cloud.frame.origin).cwiseAbs().cwiseMax((box.max() + cloud.frame.origin).cwiseAbs()).maxCoeff();
  return std::max(storedTo, 8.0 * std::numeric_limits<double>::epsilon() * largest);
}

}  // namespace

void dropNonFinite(PointCloud& cloud, PrepareSummary& summary) {
  summary.nonFinite += dropUnless(cloud, [&](std::size_t i) {
    return cloud.positions[i].allFinite() && (!cloud.hasNormals() || cloud.normals[i].allFinite());
  });
}

void dropZeroNormals(PointCloud& cloud, PrepareSummary& summary) {
  if (!cloud.hasNormals()) return;
  summary.zeroNormals += dropUnless(cloud, [&](std::size_t i) { return cloud.normals[i].cwiseAbs().maxCoeff() > 0; });
  for (Vec3& normal : cloud.normals) {
    normal /= normal.cwiseAbs().maxCoeff();  // first to a range whose squares neither overflow nor vanish
    normal.normalize();
  }
}

void dropDuplicates(PointCloud& cloud, PrepareSummary& summary) {
  // An open hash table of indices into the part that is kept.
  std::vector<Index> table(std::bit_ceil(2 * cloud.positions.size() + 1), kNone);
  const std::size_t mask = table.size() - 1;
  Index kept = 0;
  summary.duplicates += dropUnless(cloud, [&](std::size_t i) {
    const Vec3& position = cloud.positions[i];
    std::size_t slot = static_cast<std::size_t>(hashOf(position)) & mask;
    for (; table[slot] != kNone; slot = (slot + 1) & mask) {
      if (cloud.positions[static_cast<std::size_t>(table[slot])] == position) return false;
    }
    table[slot] = kept++;
    return true;
  });
}

void shiftFrame(PointCloud& cloud) {
  if (cloud.positions.empty()) return;
  constexpr double kFarDiagonals = 16.0;
  const Box3 box = cloud.boundingBox();
  const double diagonal = box.diagonal().norm();
  const Vec3 center = 0.5 * box.min() + 0.5 * box.max();
  // A cloud of no extent or beyond all measure is refused later.
  if (!(diagonal >= kSmallestDiagonal && diagonal <= kLargestDiagonal)) return;
  if (!(center.norm() > kFarDiagonals * diagonal)) return;
  // The origin is a multiple of the power of two below the diagonal. Along an axis whose center is farther than two
  // diagonals from zero, coordinate and origin then differ by less than a factor of two, so that their difference is
  // exact (Sterbenz's lemma); along the other axes nothing is gained and the origin stays zero.
  const double unit = std::exp2(std::floor(std::log2(diagonal)));
  Vec3 shift = Vec3::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(center[axis]) > 2 * diagonal) shift[axis] = std::nearbyint(center[axis] / unit) * unit;
  }
  for (Vec3& position : cloud.positions) position -= shift;
  cloud.frame.origin += shift;
}

void requireUsable(const PointCloud& cloud, const PrepareSummary& summary, const std::string& name) {
  const std::size_t points = cloud.positions.size();
  if (points < kFewestPoints) {
    throw InputError(name + ": expected at least " + std::to_string(kFewestPoints) + " usable points, found " +
                     std::to_string(points) + " (" + countsText(summary) + ")");
  }
  const Box3 box = cloud.boundingBox();
  const double diagonal = box.diagonal().norm();
  const std::string found =
      " (" + std::to_string(points) + " points, extent " + extentText(box) + "; " + countsText(summary) + ")";
  if (!(diagonal >= kSmallestDiagonal && diagonal <= kLargestDiagonal)) {
    throw InputError(name + ": expected an extent between 1e-100 and 1e100" + found);
  }
  const Vec3 extents = principalExtents(cloud.positions);
  const double flat = flatThickness(cloud, box);
  if (extents[0] > flat) return;
  const char* const shape = extents[2] <= flat ? "at one place" : extents[1] <= flat ? "on a line" : "in a plane";
  throw InputError(name + ": expected points around a solid, found all of them " + shape + found);
}

}  // namespace voroform::points
