// The Poisson form of a scan with its default envelope, as `voroform reconstruct` makes it.
#pragma once

#include <string>

#include "voroform/implicit/poisson.hpp"
#include "voroform/implicit/shapes.hpp"
#include "voroform/implicit/tetrahedral_form.hpp"
#include "voroform/points/prepare.hpp"
#include "voroform/points/read.hpp"

namespace voroform::benchmarks {

inline implicit::ImplicitPtr scanForm(const std::string& path, const RunContext& context) {
  points::ReadResult raw = points::readPoints(path, context);
  const points::PrepareResult prepared = points::prepare(std::move(raw.cloud), path, {}, context);
  Box3 envelope = prepared.cloud.boundingBox();
  const Vec3 margin = Vec3::Constant(0.02 * envelope.diagonal().norm());
  envelope = Box3(envelope.min() - margin, envelope.max() + margin);
  return implicit::enveloped(implicit::fitPoisson(prepared.cloud, envelope, {}, context).form, envelope);
}

}  // namespace voroform::benchmarks
