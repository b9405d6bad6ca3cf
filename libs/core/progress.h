#pragma once

#include <chrono>
#include <string>

namespace fathom {

/// A progress line on standard error where that is a terminal; silent when piped. The clock only limits how
/// often it is redrawn, results never depend on it.
class Progress {
 public:
  explicit Progress(std::string what);
  ~Progress();  ///< wipes the line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// fraction in [0, 1]. Also throws Interrupted after Ctrl-C, so every loop that reports can be stopped.
  void update(double fraction);

 private:
  std::string what_;
  bool terminal_;
  std::chrono::steady_clock::time_point last_drawn_;
};

/// Thrown by Progress::update after SIGINT or SIGTERM: unwinds, so part files are removed.
struct Interrupted {};
/// Makes SIGINT and SIGTERM ask for a stop instead of killing. Called once, in main.
void catchInterrupts();
bool interrupted();

}  // namespace fathom
