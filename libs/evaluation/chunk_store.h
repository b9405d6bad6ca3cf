#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace fathom {

/// Finished pieces of a long computation, one file each in a folder, so that it goes on where it was cut
/// short, whatever cut it.
class ChunkStore {
 public:
  /// `inputs` is a text that differs where results would; it stays in the folder as inputs.txt. Where the
  /// folder holds pieces of other inputs, they are removed, and half-written ones always; other files are
  /// left alone. Throws Error.
  ChunkStore(std::filesystem::path folder, const std::string& inputs);

  /// The piece as it was written; nothing where it is not there or not whole.
  std::optional<std::string> read(std::size_t number) const;
  /// Appears under its name when whole. Throws Error.
  void write(std::size_t number, const std::string& text) const;

 private:
  std::filesystem::path fileOf(std::size_t number) const;

  std::filesystem::path folder_;
};

}  // namespace fathom
