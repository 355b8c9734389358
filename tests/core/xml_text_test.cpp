#include "voroform/core/xml_text.hpp"

#include <gtest/gtest.h>

namespace voroform {
namespace {

TEST(XmlText, MarkupBecomesEntities) {
  EXPECT_EQ(xmlEscaped("<a href=\"b\">c & d</a>"), "&lt;a href=&quot;b&quot;&gt;c &amp; d&lt;/a&gt;");
  EXPECT_EQ(xmlEscaped("&amp;"), "&amp;amp;");
}

TEST(XmlText, AllElseStaysAsItIs) {
  EXPECT_EQ(xmlEscaped(""), "");
  EXPECT_EQ(xmlEscaped("site's volume\t10 µm"), "site's volume\t10 µm");
}

}  // namespace
}  // namespace voroform
