// libFuzzer target for one reader of point clouds: VOROFORM_FUZZ_FORMAT is its extension. A file is read or refused by
// an InputError; anything else is a finding. What is read is prepared too, as the program would.
#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>

#include "voroform/core/error.hpp"
#include "voroform/points/prepare.hpp"
#include "voroform/points/read.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace voroform;
  std::istringstream stream(std::string(reinterpret_cast<const char*>(data), size));
  try {
    points::ReadResult result = points::readPoints(stream, VOROFORM_FUZZ_FORMAT, "fuzz", RunContext());
    if (result.summary.records != result.cloud.positions.size()) __builtin_trap();
    RunContext oneThread;
    oneThread.threads = 1;
    const points::PrepareResult prepared =
        points::prepare(std::move(result.cloud), "fuzz", points::PrepareOptions(), oneThread);
    if (prepared.cloud.positions.size() != prepared.cloud.normals.size()) __builtin_trap();
  } catch (const InputError&) {
  }
  return 0;
}
