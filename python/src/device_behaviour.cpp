#include "device_behaviour.hpp"

#include <exception>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>

#include "bindings.hpp"
#include "errors.hpp"
#include "stator/dictionary/content.hpp"
#include "values.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace stator::python {

namespace {

constexpr base::EventRule kFailed{
    "own-device-failed", base::Severity::fault,
    "the device's function {0}() ended with {1}; none of its functions is called any more"};
constexpr base::EventRule kRefused{"own-device-refused", base::Severity::refusal,
                                   "write to {0:x4}:{1:x2} \"{2}\" refused by the device: {3}"};

/// What a traceback says of the exception.
std::string last_line(std::string_view text) {
  while (text.ends_with('\n')) {
    text.remove_suffix(1);
  }
  return std::string(text.substr(text.rfind('\n') + 1));
}

void set(dictionary::Entry& entry, std::span<const std::byte> bytes) {
  if (dictionary::is_string(entry.type())) {
    entry.set_text({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  } else {
    entry.set_value(bits_of(entry.type(), bytes));
  }
}

Behaviour& behaviour_of(const DeviceLink& link) {
  if (link.behaviour == nullptr) {
    throw std::runtime_error("the device is gone with its rack");
  }
  return *link.behaviour;
}

}  // namespace

void DeviceFailure::keep() {
  const std::scoped_lock lock(mutex_);
  if (!exception_) {
    exception_ = std::current_exception();
    kept_ = true;
  }
}

void DeviceFailure::raise() {
  if (!kept_.load(std::memory_order_relaxed)) {
    return;
  }
  std::exception_ptr exception;
  {
    const std::scoped_lock lock(mutex_);
    exception = std::exchange(exception_, nullptr);
    kept_ = false;
  }
  if (exception) {
    std::rethrow_exception(exception);
  }
}

Behaviour::Behaviour(std::shared_ptr<const Outline> outline,
                     const std::function<nb::object()>& make,
                     std::shared_ptr<DeviceFailure> failure)
    : outline_(std::move(outline)), failure_(std::move(failure)) {
  const nb::gil_scoped_acquire interpreter;
  link_->behaviour = this;
  instance_ = make();
  instance_.attr("_device") = nb::cast(link_);
}

Behaviour::~Behaviour() {
  const nb::gil_scoped_acquire interpreter;
  link_->behaviour = nullptr;
  instance_.reset();
}

template <typename Work>
void Behaviour::call(const char* function, Work&& work) {
  const nb::gil_scoped_acquire interpreter;
  if (failed_) {
    return;
  }
  const std::thread::id outer = std::exchange(caller_, std::this_thread::get_id());
  try {
    work();
  } catch (const std::exception& error) {
    failed_ = true;
    failure_->keep();
    own_reporter().report(now_, kFailed,
                          {base::EventArgument(base::SharedText(function)),
                           base::EventArgument(base::SharedText(last_line(error.what())))});
  }
  caller_ = outer;
}

nb::object Behaviour::value(std::uint16_t index, std::uint8_t subindex) {
  const dictionary::Entry& entry = entry_of(index, subindex);
  if (dictionary::is_string(entry.type())) {
    return to_python(entry.type(), entry.bytes());
  }
  return to_python(entry.type(), bytes_of(entry.type(), entry.value()));
}

void Behaviour::set_value(std::uint16_t index, std::uint8_t subindex, nb::handle value) {
  dictionary::Entry& entry = entry_of(index, subindex);
  set(entry, to_bytes(entry, value));
}

void Behaviour::emergency(std::uint16_t code, std::uint8_t error_register, const nb::bytes& data) {
  require_called();
  const std::vector<std::byte> bytes = to_vector(data);
  std::array<std::uint8_t, 5> additional{};
  if (bytes.size() > additional.size()) {
    throw std::runtime_error(
        fmt::format("an emergency carries {} bytes of the manufacturer, not "
                    "{}",
                    additional.size(), bytes.size()));
  }
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    additional[i] = std::to_integer<std::uint8_t>(bytes[i]);
  }
  send(code, error_register, additional, now_);
}

std::string Behaviour::state() const {
  require_called();
  return std::string(network_state_text());
}

void Behaviour::connect() {
  dictionary::Dictionary& objects = own_objects();
  for (const dictionary::EntryDeclaration& each : outline_->objects) {
    if (outline_->checks) {
      objects.on_check(each.index, each.subindex,
                       dictionary::Entry::CheckHook::bind<&Behaviour::check>(*this));
    }
    if (outline_->writes) {
      objects.on_written(each.index, each.subindex,
                         dictionary::Entry::WrittenHook::bind<&Behaviour::written>(*this));
    }
    if (outline_->reads) {
      objects.on_read(each.index, each.subindex,
                      dictionary::Entry::ReadHook::bind<&Behaviour::read>(*this));
    }
  }
}

void Behaviour::start(base::SimTime now) {
  now_ = now;
  if (outline_->starts) {
    call("start", [this] { instance_.attr("start")(); });
  }
}

void Behaviour::step(base::SimTime now) {
  now_ = now;
  call("step", [this, now] { instance_.attr("step")(now.seconds()); });
}

dictionary::Verdict Behaviour::check(const dictionary::Entry& entry, std::uint64_t bits) {
  dictionary::Verdict verdict;
  call("check", [&] {
    try {
      instance_.attr("check")(entry.index(), entry.subindex(),
                              to_python(entry.type(), bytes_of(entry.type(), bits)));
    } catch (nb::python_error& error) {
      const nb::object refused = nb::module_::import_("stator._errors").attr("ObjectRefused");
      if (!error.matches(refused)) {
        throw;
      }
      verdict = dictionary::refuse(
          static_cast<dictionary::AbortCode>(
              nb::cast<std::uint32_t>(error.value().attr("abort_code"))),
          kRefused,
          {base::EventArgument(entry.index()), base::EventArgument(entry.subindex()),
           base::EventArgument(entry.shared_name()),
           base::EventArgument(base::SharedText(nb::cast<std::string>(nb::str(error.value()))))});
    }
  });
  return verdict;
}

void Behaviour::written(const dictionary::Entry& entry) {
  call("written", [&] {
    instance_.attr("written")(entry.index(), entry.subindex(),
                              value(entry.index(), entry.subindex()));
  });
}

void Behaviour::read(dictionary::Entry& entry) {
  call("read", [&] {
    const nb::object value = instance_.attr("read")(entry.index(), entry.subindex());
    if (!value.is_none()) {
      set(entry, to_bytes(entry, value));
    }
  });
}

void Behaviour::require_called() const {
  if (caller_ != std::this_thread::get_id()) {
    throw std::runtime_error(
        "objects of a device of one's own are reached this way by its own functions while they "
        "are called; elsewhere they are those of rack[NAME].objects");
  }
}

dictionary::Entry& Behaviour::entry_of(std::uint16_t index, std::uint8_t subindex) {
  require_called();
  const auto entry = own_objects().require(index, subindex);
  if (!entry) {
    throw refusal(entry.error());
  }
  return **entry;
}

void bind_own_devices(nb::module_& module) {
  nb::class_<DeviceLink>(module, "DeviceLink", "What an instance reaches its device by.")
      .def(
          "value",
          [](const DeviceLink& self, std::uint16_t index, std::uint8_t subindex) {
            return behaviour_of(self).value(index, subindex);
          },
          "index"_a, "subindex"_a = 0,
          nb::sig("def value(self, index: int, subindex: int = 0) -> bool | int | float | str | "
                  "bytes"),
          "The value of an object.")
      .def(
          "set_value",
          [](const DeviceLink& self, std::uint16_t index, std::uint8_t subindex, nb::handle value) {
            behaviour_of(self).set_value(index, subindex, value);
          },
          "index"_a, "subindex"_a, "value"_a, "Sets it, without any check.")
      .def(
          "emergency",
          [](const DeviceLink& self, std::uint16_t code, std::uint8_t error_register,
             const nb::bytes& data) { behaviour_of(self).emergency(code, error_register, data); },
          "code"_a, "error_register"_a, "data"_a, "Sends an emergency.")
      .def_prop_ro(
          "state", [](const DeviceLink& self) { return behaviour_of(self).state(); },
          "Of the network, in the standard's words.");
}

}  // namespace stator::python
