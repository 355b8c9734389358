#include "voroform/points/read.hpp"

#include <fstream>

#include "readers.hpp"
#include "voroform/core/byte_source.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/input_file.hpp"

namespace voroform::points {
namespace {

using Reader = ReadResult (*)(ByteSource&);

Reader readerOf(const std::string& format, const std::string& name) {
  if (format == ".ply") return readPly;
  if (format == ".pcd") return readPcd;
  if (format == ".off") return readOff;
  if (format == ".xyz" || format == ".xyzn" || format == ".pwn" || format == ".txt") return readText;
  throw InputError(name + ": expected the extension .ply, .xyz, .xyzn, .pwn, .txt, .pcd or .off, found " +
                   quotedToken(format));
}

}  // namespace

ReadResult readPoints(std::istream& stream, const std::string& format, const std::string& name,
                      const RunContext& context) {
  const Reader reader = readerOf(format, name);
  ByteSource source(stream, name, context);
  return reader(source);
}

ReadResult readPoints(const std::filesystem::path& path, const RunContext& context) {
  const std::string name = path.string();
  requireRegularFile(path);
  const std::string format = lowerCaseExtension(path);
  readerOf(format, name);  // a wrong extension is told before a file that cannot be opened
  std::ifstream stream = openInputFile(path);
  return readPoints(stream, format, name, context);
}

}  // namespace voroform::points
