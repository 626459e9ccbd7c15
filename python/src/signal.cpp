// Values over time: stator._native.Signal.
#include <algorithm>
#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include "bindings.hpp"
#include "session.hpp"
#include "signal_handle.hpp"

namespace nb = nanobind;

namespace stator::python {

namespace {

/// Numbers of a column, as an array of NumPy that keeps them.
nb::ndarray<nb::numpy, const double, nb::ndim<1>> array_of(Column::Look look) {
  auto owned = std::make_unique<std::shared_ptr<const double[]>>(std::move(look.values));
  const double* const data = owned->get();
  const nb::capsule keeper(owned.get(), [](void* values) noexcept {
    delete static_cast<std::shared_ptr<const double[]>*>(values);  // NOLINT: a capsule owns it
  });
  static_cast<void>(owned.release());
  return {data, {look.size}, keeper};
}

const SignalStore& require_signals(Session& session) {
  const SignalStore* const store = session.signals();
  if (store == nullptr) {
    throw std::runtime_error(
        "the rack records no signals; make it with signals=[\"*\"], or the names you want");
  }
  return *store;
}

std::size_t require_signal(const SignalStore& store, const std::string& name) {
  const auto found = std::ranges::find(store.signals(), name, &product::Signal::name);
  if (found == store.signals().end()) {
    throw std::runtime_error(fmt::format(
        "the signal \"{}\" is not recorded; make the rack with signals=[\"{}\"]", name, name));
  }
  return static_cast<std::size_t>(found - store.signals().begin());
}

}  // namespace

SignalHandle::SignalHandle(std::shared_ptr<Session> session, const std::string& name)
    : session_(std::move(session)) {
  session_->held([&] {
    signal_ = session_->require_signal(name);
    reader_ = signal_.read;
    generation_ = session_->generation();
  });
}

double SignalHandle::value() const {
  return session_->held([this] {
    if (generation_ != session_->generation()) {
      reader_ = session_->require_signal(signal_.name).read;
      generation_ = session_->generation();
    }
    return reader_();
  });
}

Column::Look SignalHandle::values() const {
  return session_->held([this] {
    const SignalStore& store = require_signals(*session_);
    return store.values(require_signal(store, signal_.name));
  });
}

Column::Look SignalHandle::times() const {
  return session_->held([this] { return require_signals(*session_).times(); });
}

void bind_signals(nb::module_& module) {
  nb::class_<SignalHandle>(module, "Signal", "A value of a device or bus over time.")
      .def_prop_ro(
          "name", [](const SignalHandle& self) { return self.signal().name; },
          "With the device in front, e.g. \"x.axis0.shaft_speed\".")
      .def_prop_ro(
          "unit", [](const SignalHandle& self) { return self.signal().unit; },
          "E.g. \"rad/s\"; empty for plain numbers.")
      .def_prop_ro("value", &SignalHandle::value, "The present value.")
      .def(
          "numpy", [](const SignalHandle& self) { return array_of(self.values()); },
          nb::sig("def numpy(self) -> Array[typing.Any]"),
          "All samples so far, one for each of times(). The array is a look at them, not a copy, "
          "and stays as it is when the rack goes on.")
      .def(
          "times", [](const SignalHandle& self) { return array_of(self.times()); },
          nb::sig("def times(self) -> Array[typing.Any]"),
          "When the samples were taken, in simulated seconds.")
      .def("__float__", &SignalHandle::value)
      .def("__repr__", [](const SignalHandle& self) {
        return fmt::format("<Signal {} = {:g} {}>", self.signal().name, self.value(),
                           self.signal().unit);
      });
}

}  // namespace stator::python
