// Text that results are written as.
#pragma once

#include <string>

#include "voroform/pipeline/artifact_store.hpp"

namespace voroform::pipeline {

// A field of comma-separated values (RFC 4180): in quotes where it needs them.
std::string quoted(const std::string& field);

// Puts a file of this content.
void putText(ArtifactStore& store, const std::string& name, const std::string& content);

}  // namespace voroform::pipeline
