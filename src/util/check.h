// Checks of contracts between our own functions. A failed check is a bug, never a user's mistake
// (those are a Status).
#pragma once

#include <stdexcept>
#include <string>

namespace msf {

// A broken contract inside the program.
class ContractViolation : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

[[noreturn]] inline void FailCheck(const char* file, int line, const char* condition,
                                   const std::string& why) {
  throw ContractViolation(std::string(file) + ":" + std::to_string(line) + ": " + condition + ": " +
                          why);
}

}  // namespace msf

#define MSF_CHECK(condition, why) \
  ((condition) ? static_cast<void>(0) : ::msf::FailCheck(__FILE__, __LINE__, #condition, why))
