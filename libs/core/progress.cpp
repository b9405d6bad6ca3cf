#include "core/progress.h"

#include <unistd.h>

#include <csignal>
#include <cstdio>

namespace fathom {
namespace {
volatile std::sig_atomic_t stop_requested = 0;
void requestStop(int) { stop_requested = 1; }
}  // namespace

void catchInterrupts() {
  std::signal(SIGINT, requestStop);
  std::signal(SIGTERM, requestStop);
}
bool interrupted() { return stop_requested != 0; }

Progress::Progress(std::string what) : what_(std::move(what)), terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (terminal_) std::fprintf(stderr, "\r\033[K");
}

void Progress::update(double fraction) {
  if (interrupted()) throw Interrupted{};
  const auto now = std::chrono::steady_clock::now();
  if (!terminal_ || now - last_drawn_ < std::chrono::milliseconds(100)) return;
  last_drawn_ = now;
  std::fprintf(stderr, "\r\033[K%s %3.0f %%", what_.c_str(), 100.0 * fraction);
  std::fflush(stderr);
}

}  // namespace fathom
