// Points that two cameras see: their table, and what wrong ones are called.
#include "landmarks/tie_points.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/files.h"
#include "support/shared_data.h"

namespace fathom {
namespace {

constexpr const char* kPointColumns =
    "image,id,left_u_px,left_v_px,left_sigma_px,right_u_px,right_v_px,right_sigma_px\n";

std::string complaintOf(const std::string& rows, const std::string& header = kPointColumns) {
  const auto file = test::scratchFolder() / "points.csv";
  writeTextFile(file, header + rows);
  try {
    readTiePoints(file);
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

TEST(TiePoints, AreReadAsWritten) {
  const auto file = test::scratchFolder() / "points.csv";
  TiePoint a{3, {Vector2d(1.25, -2.5), Vector2d(1000.5, 20)}, {0.5, 1.5}}, b = a;
  b.id = 4;
  writeTiePoints(file, {{"one.png", {a, b}}, {"two.png", {a}}});
  const TiePoints read = readTiePoints(file);
  ASSERT_EQ(read.size(), 2U);
  ASSERT_EQ(read.at("one.png").size(), 2U);
  EXPECT_EQ(read.at("one.png")[1].id, 4);
  EXPECT_EQ(read.at("two.png")[0].pixels, a.pixels);
  EXPECT_EQ(read.at("two.png")[0].sigma_px, a.sigma_px);
}

TEST(TiePoints, WrongTablesAreOneLine) {
  EXPECT_EQ(complaintOf("a.png,0,1,2,1,3,4,1\n"), "");
  EXPECT_NE(complaintOf("a.png,0,1,2,1,3,4,1\n", "image,id,u,v,s,u2,v2,s2\n").find("line 1: must be"),
            std::string::npos);
  EXPECT_NE(complaintOf("a.png,-1,1,2,1,3,4,1\n").find("whole number"), std::string::npos);
  EXPECT_NE(complaintOf("a.png,1e300,1,2,1,3,4,1\n").find("whole number"), std::string::npos);
  EXPECT_NE(complaintOf("a.png,0,1,2,0,3,4,1\n").find("greater than zero"), std::string::npos);
  EXPECT_NE(complaintOf("a.png,0,1,2,1,nan,4,1\n").find("line 2"), std::string::npos);
  EXPECT_NE(complaintOf("a.png,0,1,2,1,3,4,1\na.png,0,5,6,1,7,8,1\n").find("line 3: this point"),
            std::string::npos);
}

}  // namespace
}  // namespace fathom
