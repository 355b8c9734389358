// Initial sites.
#pragma once

#include <cstdint>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/implicit/implicit_function.hpp"

namespace voroform::cvt {

// `count` points uniform in {f < 0}, in spatial order. Throws MethodError if the form's bounds hold too little inside.
std::vector<Vec3> randomSites(const implicit::ImplicitFunction& f, Index count, std::uint64_t seed,
                              const RunContext& context);

}  // namespace voroform::cvt
