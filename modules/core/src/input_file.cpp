#include "voroform/core/input_file.hpp"

#include <cerrno>
#include <cstring>
#include <system_error>

#include "voroform/core/error.hpp"

namespace voroform {

void requireRegularFile(const std::filesystem::path& path) {
  const auto fail = [&path](const std::string& what) { throw InputError(path.string() + ": " + what); };
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) fail("no such file");
  if (error) fail("cannot be read: " + error.message());
  if (std::filesystem::is_directory(status)) fail("expected a file, found a folder");
  if (!std::filesystem::is_regular_file(status)) fail("expected a regular file, found a pipe, a socket or a device");
}

std::ifstream openInputFile(const std::filesystem::path& path) {
  requireRegularFile(path);
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw InputError(path.string() + ": cannot be opened: " + std::strerror(errno));
  return stream;
}

std::string lowerCaseExtension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return extension;
}

}  // namespace voroform
