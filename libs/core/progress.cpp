#include "core/progress.h"

#include <unistd.h>

#include <csignal>
#include <cstdio>

#include "core/text.h"

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
  const std::chrono::duration<double> so_far = now - begin_;
  // Before that, a guess would jump about.
  const bool can_tell = so_far > std::chrono::seconds(2) && fraction > 0.01 && fraction < 1;
  const std::string left = can_tell ? ", " + roughly(so_far * (1 / fraction - 1)) + " left" : "";
  std::fprintf(stderr, "\r\033[K%s %3.0f %%%s", what_.c_str(), 100.0 * fraction, left.c_str());
  std::fflush(stderr);
}

std::string roughly(std::chrono::duration<double> time) {
  const double s = time.count();
  if (s < 90) return print("%.0f s", s);
  if (s < 90 * 60) return print("%.0f min", s / 60);
  return print("%.1f h", s / 3600);
}

}  // namespace fathom
