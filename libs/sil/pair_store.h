#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/time.h"
#include "evaluation/chunk_store.h"
#include "sil/pair_maker.h"

/// What is kept of finished pairs, so that a run goes on where it was cut short. Used within this room only.
namespace fathom {

/// What came of one image; a line of the table.
struct PairRecord {
  std::string why_not;  ///< empty: there is a pair; else no number counts
  double range_m = 0, view_angle_rad = 0, panel_share = 0;
  std::vector<std::optional<double>> values;  ///< of all quantities of all measures
  std::vector<std::string> unmeasured;        ///< by measure: why it has no value; empty where it has
};

/// The images of a pair in the pairs' folder.
struct PairFiles {
  std::string recorded, simulated, panel;
  std::vector<std::string> all() const { return {recorded, simulated, panel}; }
};

/// NAME_pairs_Images with the pairs' images, and chunks/ with their numbers. A pair is there when its chunk
/// is, which is written last; the chunk knows its images' bytes.
class PairStore {
 public:
  /// `inputs` is a text that differs where all pairs would. Throws Error.
  PairStore(const std::filesystem::path& folder, const std::string& name, const std::string& inputs);

  static std::filesystem::path imageFolder(const std::filesystem::path& folder, const std::string& name);
  const std::filesystem::path& images() const { return images_; }
  static PairFiles filesOf(const PosedImage& posed);

  /// Nothing where the pair has to be made: not there, not whole, or of another image or pose.
  std::optional<PairRecord> read(const PosedImage& posed) const;
  /// `pair` is null where there is none. Throws Error.
  void write(const PosedImage& posed, const PairRecord& record, const SilPair* pair) const;
  /// A pair's images as they were written, without detections. Throws Error.
  ImagePair readImages(const PosedImage& posed, const PairMaker& maker) const {
    return readImages(images_, posed, maker);
  }
  static ImagePair readImages(const std::filesystem::path& image_folder, const PosedImage& posed,
                              const PairMaker& maker);

 private:
  std::string fingerprintOfImages(const PosedImage& posed) const;

  std::filesystem::path images_;
  ChunkStore chunks_;
};

/// Removes images of ours (six digits and a word) that are not among these names, if there is the folder.
void keepOnly(const std::filesystem::path& folder, const std::set<std::string>& files);

}  // namespace fathom
