// Files of eval/ that the program carries with it, so that it finds them wherever it is installed.
#pragma once

#include <string_view>

namespace voroform::pipeline {

// The content of a file by its name within eval/, e.g. "published/table-5.1.csv". Throws UsageError for an unknown one.
std::string_view embeddedFile(std::string_view name);

}  // namespace voroform::pipeline
