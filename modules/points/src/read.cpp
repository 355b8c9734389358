#include "voroform/points/read.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include "byte_source.hpp"
#include "readers.hpp"
#include "voroform/core/error.hpp"

namespace voroform::points {
namespace {

std::string lowerCaseExtension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return extension;
}

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
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (error) throw InputError(name + ": cannot be read: " + error.message());
  if (std::filesystem::is_directory(status)) throw InputError(name + ": expected a file, found a folder");
  const std::string format = lowerCaseExtension(path);
  readerOf(format, name);  // a wrong extension is told before a file that cannot be opened
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw InputError(name + ": cannot be opened: " + std::strerror(errno));
  return readPoints(stream, format, name, context);
}

}  // namespace voroform::points
