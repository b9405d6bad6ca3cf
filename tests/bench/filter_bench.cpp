// Predict + update a second of ErrorStateFilter beside the same filter written the textbook way, in one run,
// on the two shared inputs. Usage: filter_bench [FOLDER with syn_inputs.csv and syn_inputs_split.csv]
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include "support/ekf_inputs.h"
#include "support/textbook_filter.h"

using namespace fathom;
using namespace fathom::test;

namespace {

ProcessNoise tunedNoise() {
  ProcessNoise noise;
  noise.angular_velocity.setConstant(1e-3);
  noise.acceleration.setConstant(1e-2);
  return noise;
}

template <class Filter, class Update>
double runOnce(const EkfInputs& inputs, Filter& filter, Update&& update) {
  const ProcessNoise noise = tunedNoise();
  filter.x = inputs.lines.front().z;
  filter.P = inputs.lines.front().R;
  double last_t = inputs.lines.front().t;
  const std::clock_t start = std::clock();  // CPU time: what else runs on the machine does not count
  for (std::size_t i = 1; i < inputs.lines.size(); ++i) {
    const EkfLine& line = inputs.lines[i];
    if (line.t > last_t) filter.predict(line.t - last_t, noise);
    last_t = line.t;
    update(filter, line);
  }
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

void compare(const std::filesystem::path& file) {
  const EkfInputs inputs = readEkfInputs(file);
  ErrorStateFilter<15> ours;
  TextbookFilter<15> textbook;
  double best_ours = 1e9, best_textbook = 1e9;
  for (int round = 0; round < 10; ++round) {
    best_ours =
        std::min(best_ours, runOnce(inputs, ours, [](auto& filter, const EkfLine& line) {
                   withMeasurement<15>(filter.x, line, [&](const auto& m) { return filter.update(m); });
                 }));
    best_textbook = std::min(
        best_textbook, runOnce(inputs, textbook, [](auto& filter, const EkfLine& line) {
          withMeasurement<15>(filter.x, line, [&](const auto& m) { return filter.update(m, line.index); });
        }));
  }
  const double count = static_cast<double>(inputs.lines.size() - 1);
  const double gap = difference<15>(ours.x, textbook.x).cwiseAbs().maxCoeff();
  std::printf("%-22s %9.0f /s  textbook %8.0f /s  ratio %5.2f  largest state difference %.1e\n",
              file.filename().c_str(), count / best_ours, count / best_textbook, best_textbook / best_ours,
              gap);
}

}  // namespace

int main(int argc, char** argv) {
  std::filesystem::path folder = argc > 1 ? argv[1] : std::filesystem::temp_directory_path() / "fathom-bench";
  if (argc <= 1) {
    const auto script = std::filesystem::path(FATHOM_SOURCE_DIR) / "../shared/ekf_inputs/gen_syn.py";
    std::filesystem::create_directories(folder);
    const std::string command =
        "cd '" + folder.string() + "' && /usr/bin/python3 '" + script.string() + "' > /dev/null";
    if (std::system(command.c_str()) != 0) {
      std::fprintf(stderr, "cannot make the inputs: needs ../shared/ekf_inputs and python3-numpy\n");
      return 2;
    }
  }
  for (const char* name : {"syn_inputs.csv", "syn_inputs_split.csv"}) {
    if (!std::filesystem::exists(folder / name)) {
      std::fprintf(stderr, "%s: no such file\n", (folder / name).c_str());
      return 2;
    }
    compare(folder / name);
  }
  return 0;
}
