// Errors of the library as exceptions of the package: stator.Error and those derived from it.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <nanobind/nanobind.h>

#include "stator/dictionary/refusal.hpp"
#include "stator/master/error.hpp"
#include "stator/settings/problem.hpp"

namespace stator::python {

/// stator.MasterError: what a master got to hear.
class MasterFailure : public std::runtime_error {
 public:
  explicit MasterFailure(master::Error error)
      : std::runtime_error(error.text), error_(std::move(error)) {}
  [[nodiscard]] const master::Error& error() const { return error_; }

 private:
  master::Error error_;
};

/// stator.ObjectRefused: a read or write of an object that the dictionary refuses.
class ObjectRefusal : public std::runtime_error {
 public:
  ObjectRefusal(const std::string& text, dictionary::AbortCode code)
      : std::runtime_error(text), code_(code) {}
  [[nodiscard]] dictionary::AbortCode code() const { return code_; }

 private:
  dictionary::AbortCode code_;
};

/// stator.RackFileError with the sentences of all mistakes and the place of the first.
class RackFileMistakes : public std::runtime_error {
 public:
  /// `mistakes` has at least one.
  explicit RackFileMistakes(const std::vector<settings::Problem>& mistakes);
  [[nodiscard]] const settings::Problem& first() const { return first_; }

 private:
  settings::Problem first_;
};

/// The value of a result. Throws MasterFailure.
template <typename T>
T value_or_throw(master::Result<T> result) {
  if (!result) {
    throw MasterFailure(result.error());
  }
  if constexpr (!std::is_void_v<T>) {
    return std::move(*result);
  }
}

/// The sentence of a refusal, and its abort code, as an exception.
[[nodiscard]] ObjectRefusal refusal(const dictionary::Refusal& refusal);

/// Has exceptions of C++ become those of stator/_errors.py.
void bind_errors();

}  // namespace stator::python
