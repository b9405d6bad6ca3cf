#pragma once

#include <chrono>
#include <string>

namespace fathom {

/// A progress line on standard error where that is a terminal, with the time that is left if the rest goes on
/// as the work did so far; silent when piped. Results never depend on the clock.
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
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now(), last_drawn_;
};

/// "12 s", "3 min", "2.5 h": roughly how long, for people.
std::string roughly(std::chrono::duration<double> time);

/// Thrown by Progress::update after SIGINT or SIGTERM: unwinds, so part files are removed.
struct Interrupted {};
/// Makes SIGINT and SIGTERM ask for a stop instead of killing. Called once, in main.
void catchInterrupts();
bool interrupted();

}  // namespace fathom
