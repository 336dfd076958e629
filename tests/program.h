// Runs the program as a user would. For tests that are compiled with MSF_PROGRAM, its path.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <string>

namespace msf {

struct Outcome {
  int exit_code = -1;
  std::string output;  // stdout and stderr
};

// Gives a line to the shell.
inline Outcome RunShell(const std::string& line) {
  Outcome outcome;
  FILE* pipe = popen(("{ " + line + "; } 2>&1").c_str(), "r");
  if (pipe == nullptr) return outcome;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe))
    outcome.output.push_back(static_cast<char>(c));
  const int status = pclose(pipe);
  if (WIFEXITED(status)) outcome.exit_code = WEXITSTATUS(status);
  return outcome;
}

inline Outcome RunProgram(const std::string& arguments) {
  return RunShell(std::string(MSF_PROGRAM) + " " + arguments);
}

// A user's mistake: one sentence, no crash.
inline void ExpectSentence(const Outcome& outcome, const std::string& what) {
  EXPECT_EQ(outcome.exit_code, 1) << outcome.output;
  EXPECT_THAT(outcome.output,
              testing::AllOf(testing::HasSubstr("msf-slam: "), testing::HasSubstr(what),
                             testing::Not(testing::HasSubstr("internal error"))));
}

}  // namespace msf
