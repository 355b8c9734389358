// Files to read.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

namespace voroform {

// Throws InputError unless the path names a regular file or a link to one. Inputs are read more than once, which a pipe
// does not allow, and a device need not end.
void requireRegularFile(const std::filesystem::path& path);

// Opens a regular file to read it as bytes. Throws InputError with the path and the system's reason.
std::ifstream openInputFile(const std::filesystem::path& path);

// The extension with its dot, by which formats are chosen; the letters A to Z made small whatever the locale.
std::string lowerCaseExtension(const std::filesystem::path& path);

}  // namespace voroform
