// Tetrahedral forms on disk, lossless: VTK's unstructured grid (.vtu) with f at the vertices, described in
// docs/formats.md.
#pragma once

#include <filesystem>
#include <memory>

#include "voroform/core/run_context.hpp"
#include "voroform/core/types.hpp"
#include "voroform/implicit/tetrahedral_form.hpp"

namespace voroform::implicit {

// Coordinates are written as they are, local to the frame; the frame's origin is stored with them. The same form gives
// the same bytes. Throws EnvironmentError.
void writeForm(const std::filesystem::path& path, const TetrahedralForm& form, const Frame& frame);

struct FormFile {
  std::shared_ptr<const TetrahedralForm> form;
  Frame frame;
};

// The same form and frame, bit for bit, as writeForm() was given. Throws InputError, naming the file and what was
// expected and found, for anything that writeForm() would not have written, a single changed bit included. Allocates
// nothing before the file is seen to be as long as its header says.
FormFile readForm(const std::filesystem::path& path, const RunContext& context);

}  // namespace voroform::implicit
