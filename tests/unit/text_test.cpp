#include "core/text.h"

#include <gtest/gtest.h>

namespace fathom {
namespace {

TEST(Text, WhatATerminalWouldObeyIsShownInstead) {
  EXPECT_EQ(printable("INS"), "INS");
  EXPECT_EQ(printable("a\x1b[31mred\n/../x\r\x7f"), "a\\x1b[31mred\\n/../x\\x0d\\x7f");
  EXPECT_EQ(printable(std::string("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(printable("Überfahrt \xc2\xa0 \xc2\x9b"), "Überfahrt \xc2\xa0 \\x9b");  // U+009B, as ESC [
}

}  // namespace
}  // namespace fathom
