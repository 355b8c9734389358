// Text inside XML.
#pragma once

#include <string>
#include <string_view>

namespace voroform {

// The text as it may stand between tags and in quoted attributes: the characters & < > " as entities, all others as
// they are.
std::string xmlEscaped(std::string_view text);

}  // namespace voroform
