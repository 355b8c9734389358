// libFuzzer target for one reader of meshes: VOROFORM_FUZZ_FORMAT is its extension. A file is read or refused by an
// InputError; anything else is a finding. What is read must hold what the reader promises.
#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>

#include "voroform/core/error.hpp"
#include "voroform/mesh/read_mesh.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace voroform;
  std::istringstream stream(std::string(reinterpret_cast<const char*>(data), size));
  try {
    const mesh::MeshReadResult result = mesh::readSolidMesh(stream, VOROFORM_FUZZ_FORMAT, "fuzz", RunContext());
    const auto vertices = static_cast<Index>(result.mesh.vertices.size());
    if (result.mesh.triangles.size() < 2 || result.mesh.triangles.size() % 2 != 0) __builtin_trap();
    for (const auto& triangle : result.mesh.triangles) {
      for (const Index v : triangle) {
        if (v < 0 || v >= vertices || !result.mesh.vertices[static_cast<std::size_t>(v)].allFinite()) __builtin_trap();
      }
    }
    if (result.summary.components < 1) __builtin_trap();
  } catch (const InputError&) {
  }
  return 0;
}
