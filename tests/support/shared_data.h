#pragma once

#include <gtest/gtest.h>

#include <filesystem>

namespace fathom::test {

/// Recorded data beside the checkout: ../shared/NAME from the project's root.
inline std::filesystem::path sharedData(const std::string& name) {
  return std::filesystem::path(FATHOM_SOURCE_DIR) / ".." / "shared" / name;
}

/// A folder of this test's own, empty at the start.
inline std::filesystem::path scratchFolder() {
  const auto* info = testing::UnitTest::GetInstance()->current_test_info();
  std::string name = std::string(info->test_suite_name()) + "." + info->name();
  for (char& c : name)
    if (c == '/') c = '_';
  auto folder = std::filesystem::temp_directory_path() / "fathom-tests" / name;
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

}  // namespace fathom::test

/// Skips, with a reason, where recorded data is not at hand (it has no licence to be shipped).
#define FATHOM_NEEDS_SHARED(name)                               \
  if (!std::filesystem::exists(fathom::test::sharedData(name))) \
  GTEST_SKIP() << "needs ../shared/" << (name) << ", which is not here"
