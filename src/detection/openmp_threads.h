// Keeps oneDNN's parallel loops on the calling thread.
#pragma once

namespace msf {

// While it lives, OpenMP regions that this thread opens have `threads` threads. The setting belongs
// to the calling thread alone: other threads of the program keep theirs. One thread means that no
// OpenMP worker is started, so none spins beside the SLAM threads.
class OpenMpThreadsScope {
 public:
  explicit OpenMpThreadsScope(int threads);
  ~OpenMpThreadsScope();
  OpenMpThreadsScope(const OpenMpThreadsScope&) = delete;
  OpenMpThreadsScope& operator=(const OpenMpThreadsScope&) = delete;

 private:
  int before_;
};

}  // namespace msf
