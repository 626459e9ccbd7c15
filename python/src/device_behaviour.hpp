// The side of a device that calls functions of Python.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <thread>

#include <nanobind/nanobind.h>

#include "device_outline.hpp"
#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/dictionary/dictionary.hpp"

namespace stator::python {

/// The exception that a device's function in Python ended with, until somebody takes it. Functions
/// are called by whoever lets time pass, which may be a thread that nobody waits for.
class DeviceFailure {
 public:
  /// Keeps the exception that is being handled, if none is kept.
  void keep();
  /// Throws the exception that is kept, if one is, which then is no longer.
  void raise();

 private:
  std::atomic<bool> kept_{false};
  std::mutex mutex_;
  std::exception_ptr exception_;
};

class Behaviour;

/// What an instance of Python reaches its device by; empty once that is gone.
struct DeviceLink {
  Behaviour* behaviour = nullptr;
};

/// A device's instance of Python, whose functions are called with the interpreter's lock.
class Behaviour {
 public:
  /// `make` makes the instance; what its functions throw goes to `failure`.
  Behaviour(std::shared_ptr<const Outline> outline, const std::function<nanobind::object()>& make,
            std::shared_ptr<DeviceFailure> failure);
  Behaviour(const Behaviour&) = delete;
  Behaviour& operator=(const Behaviour&) = delete;
  virtual ~Behaviour();

  [[nodiscard]] nanobind::object instance() const { return instance_; }

  // What functions of Python may do while they are called; elsewhere std::runtime_error.

  nanobind::object value(std::uint16_t index, std::uint8_t subindex);
  void set_value(std::uint16_t index, std::uint8_t subindex, nanobind::handle value);
  /// `data` of the manufacturer has 5 bytes at most.
  void emergency(std::uint16_t code, std::uint8_t error_register, const nanobind::bytes& data);
  [[nodiscard]] std::string state() const;

 protected:
  [[nodiscard]] virtual dictionary::Dictionary& own_objects() = 0;
  [[nodiscard]] virtual const base::EventReporter& own_reporter() const = 0;
  [[nodiscard]] virtual std::string_view network_state_text() const = 0;
  virtual void send(std::uint16_t code, std::uint8_t error_register,
                    const std::array<std::uint8_t, 5>& additional, base::SimTime now) = 0;

  /// Has entries call the functions that the class has. To be called once the objects are there.
  void connect();
  void start(base::SimTime now);
  void step(base::SimTime now);

 private:
  dictionary::Verdict check(const dictionary::Entry& entry, std::uint64_t bits);
  void written(const dictionary::Entry& entry);
  void read(dictionary::Entry& entry);
  /// Does `work`, which calls `function` of the instance, with the interpreter's lock. What that
  /// throws is kept, and afterwards nothing is called any more.
  template <typename Work>
  void call(const char* function, Work&& work);
  void require_called() const;
  dictionary::Entry& entry_of(std::uint16_t index, std::uint8_t subindex);

  std::shared_ptr<const Outline> outline_;
  std::shared_ptr<DeviceFailure> failure_;
  std::shared_ptr<DeviceLink> link_ = std::make_shared<DeviceLink>();
  nanobind::object instance_;
  base::SimTime now_;
  std::thread::id caller_;  ///< which is in a function of the instance
  bool failed_ = false;
};

}  // namespace stator::python
