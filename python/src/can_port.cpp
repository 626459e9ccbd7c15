// A program's place on a CAN bus: stator._native.CanPort, on which stator.can is built.
#include <algorithm>
#include <any>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>

#include "bindings.hpp"
#include "session.hpp"
#include "stator/bench/local_can_port.hpp"
#include "stator/rack/core/bus_port.hpp"
#include "stator/rack/networks/can_network.hpp"
#include "values.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace stator::python {

namespace {

using SessionPointer = std::shared_ptr<Session>;
using Bytes = std::vector<std::byte>;

/// A place on a CAN bus: of a bench, or of a rack on links.
struct BusPlace final : Guest {
  std::unique_ptr<rack::BusPort> port;
  std::unique_ptr<bench::LocalCanPort> local;
  std::size_t bus = 0;
  bool came_later = false;  ///< than the moment to which the rack was brought back

  void leave() override {
    port.reset();
    local.reset();
  }
  void step_aside() override {
    if (local) {
      local->leave();
    }
  }
  /// The number of the place; nothing: it is closed.
  [[nodiscard]] std::any remember() const override {
    return local ? std::any(local->number()) : std::any();
  }
  // A port that was closed meanwhile stays so.
  void recall(const std::any& memory, bench::Bench::Past& past) override {
    if (!local) {
      return;
    }
    auto place =
        memory.has_value() ? past.take_port(bus, std::any_cast<std::size_t>(memory)) : nullptr;
    if (place) {
      local->take_over(std::move(place));
    } else {
      came_later = true;
      local.reset();
    }
  }
  [[nodiscard]] bool taken() const { return port != nullptr || local != nullptr; }
};

/// A program's place on a CAN bus of the rack.
class CanPort {
 public:
  CanPort(SessionPointer session, const std::string& bus) : session_(std::move(session)) {
    session_->held([&] {
      bus_ = require_bus(bus);
      place_->bus = bus_;
      if (session_->has_links()) {
        place_->port = std::make_unique<rack::BusPort>(session_->rack(), bus_);
      } else {
        bench::Bench& bench = session_->bench();
        place_->local = std::make_unique<bench::LocalCanPort>(bench.rack(), bus_, bench.clock());
      }
      session_->admit(place_);
    });
  }
  CanPort(const CanPort&) = delete;
  CanPort& operator=(const CanPort&) = delete;
  ~CanPort() { close(); }

  void close() {
    if (!session_->closed() && place_->taken()) {
      session_->held([this] { place_->leave(); });
    }
  }

  void send(std::uint32_t identifier, const nb::bytes& data, bool extended, bool remote,
            unsigned length) {
    const Bytes bytes = to_vector(data);
    can::Frame frame{.identifier = identifier, .extended = extended, .remote = remote};
    if (bytes.size() > can::kMaximumData || length > can::kMaximumData) {
      throw std::runtime_error(fmt::format("a frame carries at most {} bytes, not {}",
                                           can::kMaximumData,
                                           std::max<std::size_t>(bytes.size(), length)));
    }
    frame.length = static_cast<std::uint8_t>(remote ? length : bytes.size());
    std::copy(bytes.begin(), bytes.end(), frame.data.begin());
    session_->held([&] {
      require_open();
      if (place_->local) {
        send_in_lockstep(frame);
        return;
      }
      if (!place_->port->put(frame)) {
        throw std::runtime_error(
            "the bus has no room for a further frame; it is too busy, or "
            "nobody acknowledges");
      }
      session_->wake();
    });
  }

  /// In lockstep: lets cycles pass until a frame is there or `timeout` is over.
  nb::object receive_within(double timeout) {
    const base::SimDuration duration = duration_of(timeout, "timeout");
    std::optional<base::SimTime> end;
    while (true) {
      std::optional<can::TimedFrame> taken;
      const bool over = session_->held([&] {
        taken = take();
        end = end.value_or(session_->now() + duration);
        if (taken || session_->now() >= *end) {
          return true;
        }
        session_->bench().cycle();
        return false;
      });
      if (over) {
        return to_python(taken);
      }
      if (PyErr_CheckSignals() != 0) {
        throw nb::python_error();
      }
    }
  }

  /// Waits for a frame that others bring, at most for `timeout` s of the machine's time, nothing:
  /// for ever. `listens`: this thread does nothing else, and settle() waits for it.
  nb::object wait(std::optional<double> timeout, bool listens) {
    using Clock = std::chrono::steady_clock;
    constexpr std::chrono::milliseconds kSignalsAreLookedFor{50};
    const auto end = timeout ? Clock::now() + std::chrono::nanoseconds(
                                                  duration_of(*timeout, "timeout").nanoseconds())
                             : Clock::time_point::max();
    std::optional<can::TimedFrame> taken;
    while (!session_->closed()) {
      const auto left = end - Clock::now();
      const bool over = wait_until(std::min<Clock::duration>(left, kSignalsAreLookedFor), [&] {
        if (place_->came_later) {
          require_open();
        }
        if (!place_->taken()) {
          return true;
        }
        taken = take();
        if (listens) {
          note_listener(taken.has_value());
        }
        return taken.has_value();
      });
      if (PyErr_CheckSignals() != 0) {
        throw nb::python_error();
      }
      if (over || left <= Clock::duration::zero()) {
        break;
      }
    }
    return to_python(taken);
  }

  /// Waits until the thread that listens, if there is one, has handled all frames that have come,
  /// at most for `timeout` s of the machine's time.
  void settle(double timeout) {
    wait_until(std::chrono::nanoseconds(duration_of(timeout, "timeout").nanoseconds()), [this] {
      return !place_->taken() || !listener_ || *listener_ == std::this_thread::get_id() ||
             (listener_waits_ && waiting() == 0);
    });
  }

  [[nodiscard]] std::size_t waiting_frames() const {
    return session_->held([this] {
      require_open();
      return waiting();
    });
  }
  [[nodiscard]] bool open() const {
    return !session_->closed() && session_->held([this] { return place_->taken(); });
  }
  [[nodiscard]] std::string name() const {
    return session_->held([this] { return session_->configuration().buses[bus_].name; });
  }

 private:
  std::size_t require_bus(const std::string& name) {
    const auto& buses = session_->configuration().buses;
    std::set<std::string> names;
    for (std::size_t i = 0; i < buses.size(); ++i) {
      if (buses[i].wire && buses[i].name == name) {
        return i;
      }
      if (buses[i].wire) {
        names.insert(buses[i].name);
      }
    }
    throw std::runtime_error(names.empty()
                                 ? std::string("the rack has no CAN bus")
                                 : fmt::format("there is no CAN bus \"{}\"; there are: {}", name,
                                               fmt::join(names, ", ")));
  }
  [[nodiscard]] std::size_t waiting() const {
    return place_->local ? place_->local->waiting() : place_->port->waiting();
  }
  /// The oldest frame that was not taken yet.
  std::optional<can::TimedFrame> take() {
    require_open();
    return place_->local ? place_->local->receive() : place_->port->take();
  }
  static nb::object to_python(const std::optional<can::TimedFrame>& taken) {
    if (!taken) {
      return nb::none();
    }
    const can::Frame& frame = taken->frame;
    return nb::make_tuple(taken->time.seconds(), frame.identifier,
                          python::to_python(frame.payload()), frame.extended, frame.remote,
                          frame.length, taken->destroyed);
  }
  /// This thread listens, and has taken a frame or waits for one.
  void note_listener(bool has_frame) {
    listener_ = std::this_thread::get_id();
    if (std::exchange(listener_waits_, !has_frame) == has_frame) {
      session_->notify();
    }
  }
  bool wait_until(std::chrono::nanoseconds duration, const std::function<bool()>& reached) const {
    const nb::gil_scoped_release released;
    return session_->wait_until(reached, duration);
  }
  void require_open() const {
    if (!place_->taken()) {
      throw std::runtime_error(place_->came_later ? "the port was opened after the moment to which "
                                                    "the rack was brought back; open it anew"
                                                  : "the port is closed");
    }
  }
  /// A SYNC moves time by one cycle, every other frame by the rack's step.
  void send_in_lockstep(const can::Frame& frame) {
    const rack::RackConfiguration& configuration = session_->configuration();
    if (frame.identifier == rack::LockstepClock::kSyncIdentifier && !frame.extended &&
        !frame.remote && configuration.cycle > configuration.step && !session_->paced()) {
      place_->local->wait(configuration.cycle - configuration.step);
    }
    place_->local->send(frame);
  }

  SessionPointer session_;
  std::size_t bus_ = 0;
  // While the rack is held.
  std::optional<std::thread::id> listener_;
  bool listener_waits_ = false;  ///< it has handled what it took
  std::shared_ptr<BusPlace> place_ = std::make_shared<BusPlace>();
};

}  // namespace

void bind_can(nb::module_& module) {
  nb::class_<CanPort>(module, "CanPort", "A program's place on a CAN bus; see stator.can.")
      .def(nb::init<SessionPointer, const std::string&>(), "rack"_a, "bus"_a)
      .def("send", &CanPort::send, "identifier"_a, "data"_a, "extended"_a = false,
           "remote"_a = false, "length"_a = 0, "Hands a frame to the bus.")
      .def("receive_within", &CanPort::receive_within, "timeout"_a,
           nb::sig(
               "def receive_within(self, timeout: float) -> tuple[float, int, bytes, bool, bool, "
               "int, bool] | None"),
           "In lockstep: lets time pass until there is a frame, at most so many simulated seconds.")
      .def("wait", &CanPort::wait, "timeout"_a.none(), "listens"_a = false,
           nb::sig("def wait(self, timeout: float | None, listens: bool = False) -> tuple[float, "
                   "int, bytes, bool, bool, int, bool] | None"),
           "Waits for a frame that others bring, at most so many seconds of the machine's time.")
      .def("settle", &CanPort::settle, "timeout"_a,
           "Waits until the thread that listens has handled all frames that have come.")
      .def_prop_ro("name", &CanPort::name, "Of the bus.")
      .def_prop_ro("waiting", &CanPort::waiting_frames,
                   "Frames that have come and were not taken yet.")
      .def_prop_ro("open", &CanPort::open, "Whether it has its place on the bus.")
      .def("close", &CanPort::close, "Leaves the bus.");
}

}  // namespace stator::python
