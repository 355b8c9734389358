// What the makers of forms share.
#pragma once

#include <filesystem>
#include <string>

#include "voroform/pipeline/form.hpp"

namespace voroform::pipeline {

inline constexpr Index kFewestSamples = 100;
inline constexpr Index kMostSamples = 100'000'000;

void throwIfInvalid(const FormOptions& options);

// Throws InputError if the file cannot be read.
InputRecord fileRecord(const std::filesystem::path& path, const std::string& kind, const std::string& format);

// Fits the form to form.cloud and closes it by the envelope.
void fitPoissonForm(Form& form, const FormOptions& options, const RunContext& context);

}  // namespace voroform::pipeline
