#include "recording/mrpt_classes.h"

#include <dlfcn.h>
#include <mrpt/obs/CObservation.h>

#include <string_view>

namespace fathom {
namespace {

/// The file of MRPT's library `name` of the version that runs: named as that of the observations.
std::string libraryFile(const std::string& name) {
  constexpr std::string_view kObservations = "mrpt-obs";
  Dl_info loaded{};
  if (dladdr(CLASS_ID(mrpt::obs::CObservation), &loaded) == 0) return {};
  std::string file = loaded.dli_fname;
  const std::size_t at = file.rfind(kObservations);
  return at == std::string::npos ? "" : file.replace(at, kObservations.size(), "mrpt-" + name);
}

bool load(const std::string& name) {
  const std::string file = libraryFile(name);
  return !file.empty() && dlopen(file.c_str(), RTLD_NOW) != nullptr;
}

}  // namespace

bool loadFurtherMrptClasses() {
  static bool asked = false;
  if (asked) return false;
  asked = true;
  const bool maps = load("maps"), vision = load("vision");
  return maps || vision;
}

const mrpt::rtti::TRuntimeClassId* findMrptClass(const std::string& name) {
  const auto* found = mrpt::rtti::findRegisteredClass(name, true);
  return found != nullptr || !loadFurtherMrptClasses() ? found : mrpt::rtti::findRegisteredClass(name, true);
}

}  // namespace fathom
