// A signal of a rack: stator._native.Signal.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "session.hpp"
#include "stator/product/device/signal.hpp"

namespace stator::python {

/// A signal that can be read at any time, and over the time since the rack began.
class SignalHandle {
 public:
  /// Throws std::runtime_error if there is none of that name.
  SignalHandle(std::shared_ptr<Session> session, const std::string& name);

  [[nodiscard]] const product::Signal& signal() const { return signal_; }
  [[nodiscard]] double value() const;
  /// Throws std::runtime_error if it is not recorded, times() if none is.
  [[nodiscard]] Column::Look values() const;
  [[nodiscard]] Column::Look times() const;

 private:
  std::shared_ptr<Session> session_;
  product::Signal signal_;
  mutable base::SignalReader reader_;
  mutable std::uint64_t generation_ = 0;  ///< of the rack whose part the reader reads
};

}  // namespace stator::python
