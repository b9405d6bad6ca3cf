#include "core/files.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "core/error.h"
#include "support/shared_data.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

std::size_t entriesIn(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(Files, NothingIsThereWhereNobodyCanLook) {
  const fs::path folder = test::scratchFolder(), file = folder / "file",
                 too_long = folder / std::string(300, 'a');
  writeTextFile(file, "text");
  EXPECT_TRUE(isThere(file) && isFile(file) && !isFolder(file));
  EXPECT_TRUE(isThere(folder) && !isFile(folder) && isFolder(folder));
  EXPECT_FALSE(isThere(too_long) || isFile(too_long) || isFolder(too_long));
  EXPECT_FALSE(isThere(file / "inside"));
}

TEST(PendingFile, NothingUnderTheRealNameUntilCommit) {
  const auto target = test::scratchFolder() / "new" / "out.txt";
  PendingFile file(target);
  EXPECT_EQ(file.target(), target);
  std::ofstream(file.path()) << "whole";
  EXPECT_FALSE(fs::exists(target));
  file.commit();
  EXPECT_EQ(readTextFile(target), "whole");
  EXPECT_EQ(entriesIn(target.parent_path()), 1U);
}

TEST(PendingFile, OldFileStaysUntilCommit) {
  const auto target = test::scratchFolder() / "out.txt";
  writeTextFile(target, "old");
  PendingFile file(target);
  std::ofstream(file.path()) << "new";
  EXPECT_EQ(readTextFile(target), "old");
  file.commit();
  EXPECT_EQ(readTextFile(target), "new");
}

// Before the work, not after it.
TEST(FolderClaim, RefusesWhatCannotBeMade) {
  const auto folder = test::scratchFolder();
  writeTextFile(folder / "file", "text");
  EXPECT_THROW(FolderClaim(folder / "file"), Error);
  EXPECT_THROW(FolderClaim(folder / "file" / "results"), Error);
  EXPECT_THROW(FolderClaim(folder / "new" / std::string(300, 'a')), Error);
  EXPECT_EQ(entriesIn(folder), 1U);
}

TEST(PendingFile, AnExceptionRemovesThePart) {
  const auto folder = test::scratchFolder();
  writeTextFile(folder / "out.txt", "old");
  try {
    PendingFile file(folder / "out.txt");
    std::ofstream(file.path()) << "half";
    EXPECT_EQ(entriesIn(folder), 2U);
    throw Error("x", "", "interrupted");
  } catch (const Error&) {
  }
  EXPECT_EQ(entriesIn(folder), 1U);
  EXPECT_EQ(readTextFile(folder / "out.txt"), "old");
}

TEST(PendingFile, FailuresAreErrorsThatNameTheFile) {
  const auto folder = test::scratchFolder();
  writeTextFile(folder / "file", "");
  const auto below_a_file = folder / "file" / "out.txt";
  try {
    PendingFile file(below_a_file);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.file, below_a_file.string());
  }
  PendingFile gone(folder / "other.txt");
  fs::remove(gone.path());
  EXPECT_THROW(gone.commit(), Error);
  fs::create_directories(folder / "taken" / "full");
  EXPECT_THROW(writeTextFile(folder / "taken", "text"), Error);
  EXPECT_FALSE(fs::exists(folder / "taken.part"));
}

// Renaming a file over it would take its place.
TEST(PendingFile, WhatIsNoFileIsNotReplaced) {
  const auto folder = test::scratchFolder();
  const fs::path pipe = folder / "pipe", link = folder / "link", device = folder / "device";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  fs::create_symlink("pipe", link);
  for (const fs::path& target : {pipe, link}) EXPECT_THROW(writeTextFile(target, "text"), Error) << target;
  EXPECT_TRUE(fs::is_fifo(pipe) && fs::is_symlink(link));
  constexpr auto kNull = static_cast<dev_t>(0x103);
  if (mknod(device.c_str(), S_IFCHR | 0600, kNull) == 0) {  // root only
    EXPECT_THROW(writeTextFile(device, "text"), Error);
    EXPECT_TRUE(fs::is_character_file(device));
  }
  ASSERT_EQ(mkfifo((folder / "out.part").c_str(), 0600), 0);
  EXPECT_THROW(writeTextFile(folder / "out", "text"), Error) << "and does not wait for a reader";
}

TEST(PendingFile, ALinkIsReplacedAndWhatItLeadsToIsLeftAlone) {
  const auto folder = test::scratchFolder();
  writeTextFile(folder / "theirs", "theirs");
  fs::create_symlink("theirs", folder / "link");
  fs::create_symlink("loop", folder / "loop");
  for (const char* link : {"link", "loop"}) {
    writeTextFile(folder / link, "ours");
    EXPECT_FALSE(fs::is_symlink(folder / link)) << link;
  }
  EXPECT_EQ(readTextFile(folder / "theirs"), "theirs");
}

TEST(PendingFile, IsOneWritersAtATime) {
  const auto target = test::scratchFolder() / "out.txt";
  writeTextFile(target.string() + ".part", "left by one that was killed");
  {
    PendingFile first(target);
    EXPECT_THROW(PendingFile second(target), Error);
    EXPECT_THROW(writeTextFile(target, "other"), Error);
    EXPECT_TRUE(fs::exists(first.path())) << "it is the first one's";
    first.commit();
    writeTextFile(target, "next");  // what is committed is nobody's any more
  }
  EXPECT_EQ(readTextFile(target), "next");
}

TEST(FolderClaim, LeavesAFolderOnlyWhereThereIsSomethingInIt) {
  const auto folder = test::scratchFolder();
  {
    const FolderClaim claim(folder / "a/b");
    EXPECT_THROW(FolderClaim(folder / "a/b"), Error);
    const FolderClaim beside(folder / "a/c");
    writeTextFile(folder / "a/c/file", "");
  }
  EXPECT_FALSE(fs::exists(folder / "a/b"));
  EXPECT_TRUE(fs::exists(folder / "a/c/file"));
  const FolderClaim again(folder / "a/c");
}

TEST(TextFile, WithoutEndIsAnError) { EXPECT_THROW(readTextFile("/dev/zero"), Error); }

TEST(TextFile, KeepsEveryByte) {
  const auto file = test::scratchFolder() / "bytes";
  std::string bytes;
  for (int i = 0; i < 512; ++i) bytes += static_cast<char>(i % 256);
  writeTextFile(file, bytes);
  EXPECT_EQ(readTextFile(file), bytes);
  EXPECT_THROW(readTextFile(file.parent_path()), Error);
  EXPECT_THROW(readTextFile(file.parent_path() / "absent"), Error);
}

}  // namespace
}  // namespace fathom
