#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include "support/memory.h"
#include "support/stopwatch.h"

/// Work in a child process of its own, so that its peak memory is its own.
namespace fathom::test {

/// Runs `work` in a child and brings its figures (plain data) back by a pipe.
template <class Figures, class Work>
bool inChild(Figures& figures, Work work) {
  int ends[2];
  if (pipe(ends) != 0) return false;
  const pid_t child = fork();
  if (child < 0) return false;
  if (child == 0) {
    work(figures);
    const bool sent = write(ends[1], &figures, sizeof figures) == static_cast<ssize_t>(sizeof figures);
    _exit(sent ? 0 : 1);
  }
  close(ends[1]);
  const bool received = read(ends[0], &figures, sizeof figures) == static_cast<ssize_t>(sizeof figures);
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  return received && status == 0;
}

}  // namespace fathom::test
