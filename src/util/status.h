// Outcomes as values: a Status says whether something worked and, if not, in one sentence what a
// user should know and do.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "util/check.h"

namespace msf {

// Success, or a sentence for the user (which file, which line or frame, what is wrong, what to do).
class [[nodiscard]] Status {
 public:
  Status() = default;
  static Status Ok() { return {}; }
  static Status Error(std::string message) {
    Status status;
    status.message_ = std::move(message);
    return status;
  }

  bool ok() const { return !message_.has_value(); }
  // The sentence; empty when ok().
  const std::string& message() const {
    static const std::string kNone;
    return message_ ? *message_ : kNone;
  }

 private:
  std::optional<std::string> message_;
};

// A value, or the Status that explains why there is none.
template <typename T>
class [[nodiscard]] StatusOr {
 public:
  // Implicit: reads as `return value;`
  // NOLINTNEXTLINE(google-explicit-constructor)
  StatusOr(T value) : value_(std::move(value)) {}
  StatusOr(Status status) : status_(std::move(status)) {  // NOLINT(google-explicit-constructor)
    MSF_CHECK(!status_.ok(), "StatusOr needs a value or an error");
  }

  bool ok() const { return value_.has_value(); }
  const Status& status() const { return status_; }
  const std::string& message() const { return status_.message(); }

  T& value() & {
    MSF_CHECK(ok(), message());
    return *value_;
  }
  const T& value() const& {
    MSF_CHECK(ok(), message());
    return *value_;
  }
  T&& value() && {
    MSF_CHECK(ok(), message());
    return *std::move(value_);
  }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }

 private:
  Status status_;
  std::optional<T> value_;
};

}  // namespace msf

// Returns the Status of `expression` from the enclosing function unless it is ok.
#define MSF_RETURN_IF_ERROR(expression)                                                  \
  do {                                                                                   \
    if (::msf::Status msf_status_ = (expression); !msf_status_.ok()) return msf_status_; \
  } while (false)
