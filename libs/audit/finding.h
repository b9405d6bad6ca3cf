#pragma once

#include <string>
#include <vector>

namespace fathom {

/// What is wrong with one stream of a recording, or seems so.
struct Finding {
  /// "accelerometer-in-g"; of an instrument that is not the first of its kind "accelerometer-in-g.2". What
  /// --accept takes.
  std::string name;
  std::string label;  ///< the recording's entries that it is about: "INS", "DVL.2"
  enum class Certainty {
    likely,  ///< a warning
    sure     ///< physics leave no other explanation: an error, unless the user accepts or corrects it
  } certainty = Certainty::likely;
  std::string what;       ///< with numbers and units, one line
  std::string corrected;  ///< what it would be, one line; empty where nothing is known that would mend it
  /// What --correct takes; empty likewise. Mostly the name; with what was found out where the name does not
  /// say it: "dvl-axes:x,-y,-z".
  std::string correction;
};

/// "INS: WHAT (sure); CORRECTED: --correct NAME", one line.
std::string toText(const Finding& finding);

}  // namespace fathom
