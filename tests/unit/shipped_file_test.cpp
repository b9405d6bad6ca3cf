#include "core/shipped_file.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "core/files.h"
#include "support/shared_data.h"
#include "support/shipped.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

/// Somewhere else for as long as it lives.
class CurrentFolder {
 public:
  explicit CurrentFolder(const fs::path& folder) { fs::current_path(folder); }
  ~CurrentFolder() { fs::current_path(before_); }
  CurrentFolder(const CurrentFolder&) = delete;
  CurrentFolder& operator=(const CurrentFolder&) = delete;

 private:
  fs::path before_ = fs::current_path();
};

TEST(ShippedFile, IsFoundFromAnyFolder) {
  const CurrentFolder elsewhere(test::scratchFolder());
  EXPECT_TRUE(fs::equivalent(shippedFile("config/TL2.yaml"), test::kConfig / "TL2.yaml"));
}

TEST(ShippedFile, ThatOfTheCurrentFolderComesFirstThenThoseOfTheSystem) {
  const fs::path folder = test::scratchFolder();
  setenv("XDG_DATA_DIRS", ("relative:" + (folder / "share").string()).c_str(), 1);
  writeTextFile(folder / "share/fathom/config/TL2.yaml", "");
  writeTextFile(folder / "here/config/TL2.yaml", "");
  {
    const CurrentFolder elsewhere(folder);
    EXPECT_EQ(shippedFile("config/TL2.yaml"), folder / "share/fathom/config/TL2.yaml");
  }
  const CurrentFolder here(folder / "here");
  EXPECT_EQ(shippedFile("config/TL2.yaml"), "config/TL2.yaml");
  unsetenv("XDG_DATA_DIRS");
}

TEST(ShippedFile, WhatIsNowhereStaysAsItIs) {
  for (const char* file : {"", "config/none.yaml", "/none/config/TL2.yaml"})
    EXPECT_EQ(shippedFile(file), file);
}

}  // namespace
}  // namespace fathom
