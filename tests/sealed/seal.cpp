#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>

#include "core/error.h"
#include "core/progress.h"
#include "recording.h"

namespace fathom::sealed {
namespace {

constexpr int kDone = 0, kFault = 1, kBadInput = 2, kInterrupted = 130;

int run(int argc, char** argv) {
  CLI::App app("fathom-seal: make a recording in which something is hidden, by physics of its own");
  std::string file, out, truth;
  app.add_option("CASE", file, "What to hide, CASE.json")->required();
  app.add_option("--out", out, "Folder for the recording")->required();
  app.add_option("--truth", truth, "Folder for what is hidden in it")->required();
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked_for_help) {
    return app.exit(asked_for_help);
  } catch (const CLI::ParseError& mistake) {
    throw Error("command line", "", mistake.what());
  }
  sealRecording(readSealedCase(file), out, truth);
  return kDone;
}

int complain(const std::string& what, int status) {
  std::cerr << "fathom-seal: " << what << "\n";
  return status;
}

}  // namespace
}  // namespace fathom::sealed

int main(int argc, char** argv) {
  using namespace fathom::sealed;
  fathom::catchInterrupts();
  try {
    return run(argc, argv);
  } catch (const fathom::Error& error) {
    return complain(error.what(), kBadInput);
  } catch (const fathom::Interrupted&) {
    return complain("interrupted", kInterrupted);
  } catch (const std::exception& fault) {
    return complain(fault.what(), kFault);
  }
}
