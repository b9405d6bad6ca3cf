#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "core/error.h"
#include "core/text.h"
#include "image_files/image_file.h"
#include "report/run_info.h"
#include "similarity/fsim.h"

namespace fathom {
namespace {

struct FsimOptions {
  std::string reference, image;
  bool json = false;
};

FsimScore scoreOf(const FsimOptions& options) {
  const cv::Mat reference = readImage(options.reference), image = readImage(options.image);
  if (const auto why = FsimComparer::whyNot(reference)) throw Error(options.reference, "", *why);
  if (const auto why = FsimComparer::whyNot(reference, image)) throw Error(options.image, "", *why);
  const auto score = FsimComparer().compare(reference, image);
  if (!score) throw Error(options.image, "", "there is nothing to see in it, nor in the reference");
  return *score;
}

void fsim(const FsimOptions& options) {
  const FsimScore score = scoreOf(options);
  if (options.json) {
    const nlohmann::ordered_json json{{"reference", options.reference},
                                      {"image", options.image},
                                      {"fsim", score.fsim},
                                      {"fsimc", score.fsimc}};
    std::cout << json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << "\n";
    return;
  }
  std::cout << print("FSIM   %.6f\nFSIMc  %.6f\n", score.fsim, score.fsimc);
}

}  // namespace

void addFsim(const RunContext& context) {
  auto* command = context.root->add_subcommand("fsim", "Tell how alike two images look (FSIM, FSIMc)");
  command->footer(
      "Prints the feature similarity of Zhang, Zhang, Mou and Zhang (2011): FSIM compares luminance, FSIMc "
      "colour\n"
      "too. Both are 1 for an image and itself, and the less the less alike they look. Which image is the\n"
      "reference does not matter. Images are of one size, 48 pixels or more either way.\n"
      "\n"
      "Examples:\n"
      "  fathom fsim recorded.png simulated.png\n"
      "  fathom fsim recorded.png simulated.png --json | jq .fsim");
  const auto options = std::make_shared<FsimOptions>();
  command->add_option("REFERENCE", options->reference, "PNG, JPEG or BMP image")
      ->required()
      ->type_name(values::kFile);
  command->add_option("IMAGE", options->image, "The one to compare with it")
      ->required()
      ->type_name(values::kFile);
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options] { fsim(*options); });
}

}  // namespace fathom
