// One reader a format. Each reads from the start of the source to its end.
#pragma once

#include <string>

#include "voroform/core/byte_source.hpp"
#include "voroform/points/read.hpp"

namespace voroform::points {

ReadResult readPly(ByteSource& source);
ReadResult readText(ByteSource& source);
ReadResult readPcd(ByteSource& source);
ReadResult readOff(ByteSource& source);

}  // namespace voroform::points
