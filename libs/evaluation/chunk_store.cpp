#include "evaluation/chunk_store.h"

#include "core/error.h"
#include "core/files.h"
#include "core/fingerprint.h"
#include "core/text.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

constexpr const char* kInputs = "inputs.txt";
constexpr const char* kBegin = "chunk_";
constexpr const char* kEnding = ".txt";

bool isChunk(const std::string& name) {
  return name.starts_with(kBegin) && (name.ends_with(kEnding) || name.ends_with(".part"));
}

/// Last line of a piece: a disk that lost power may keep a name without what was in it.
std::string seal(const std::string& text) { return "end " + Fingerprint().add(text).hex() + "\n"; }

}  // namespace

ChunkStore::ChunkStore(fs::path folder, const std::string& inputs) : folder_(std::move(folder)) {
  const fs::path inputs_file = folder_ / kInputs;
  const bool same = isThere(inputs_file) && readTextFile(inputs_file) == inputs;
  std::error_code problem;
  if (!same) fs::remove(inputs_file, problem);  // first: pieces without it belong to nothing
  if (isFolder(folder_))
    for (const auto& entry : fs::directory_iterator(folder_)) {
      const bool stale =
          isChunk(entry.path().filename().string()) && (!same || entry.path().extension() == ".part");
      if (stale && !fs::remove(entry.path(), problem))
        throw Error(entry.path().string(), "", "cannot be removed: " + problem.message());
    }
  if (!same) writeTextFile(inputs_file, inputs);
}

fs::path ChunkStore::fileOf(std::size_t number) const {
  return folder_ / (kBegin + print("%06zu", number) + kEnding);
}

std::optional<std::string> ChunkStore::read(std::size_t number) const {
  const fs::path file = fileOf(number);
  if (!isThere(file)) return std::nullopt;
  std::string text = readTextFile(file);
  const std::size_t sealed = text.size() - std::min(text.size(), seal("").size());
  const std::string end = text.substr(sealed);
  text.resize(sealed);
  if (end != seal(text)) return std::nullopt;
  return text;
}

void ChunkStore::write(std::size_t number, const std::string& text) const {
  writeTextFile(fileOf(number), text + seal(text));
}

}  // namespace fathom
