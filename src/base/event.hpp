#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "base/sim_time.hpp"

namespace stator::base {

/// How much a person wants to know about an event.
enum class Severity : std::uint8_t {
  information,  ///< something happened as commanded: a state change, a reset
  refusal,      ///< a request was answered with an error; the event says why and what to do
  warning,      ///< works, but probably not as meant
  fault,        ///< the device protects itself: emergency, watchdog, fault reaction
};

/// One kind of event, declared as a constant next to the code that raises it.
///
/// `text` is one sentence with the rule, what was expected, what came and the remedy. Placeholders
/// name the arguments by position: `{0}` decimal, text or list, `{0:x4}` hexadecimal with at least
/// four digits and the field's h suffix ("6040h"), `{0:d3}` thousandths with a point ("1.500").
struct EventRule {
  std::string_view id;  ///< stable name for programs, e.g. "al-sm-length"
  Severity severity;
  std::string_view text;
};

/// A number, or a text or list of numbers that lives as long as the device that raises the event (a
/// state's name, an object's legal values); a reader that keeps events longer keeps their sentences
/// instead.
class EventArgument {
 public:
  constexpr EventArgument() = default;
  constexpr EventArgument(std::int64_t number) : number_(number) {}  // NOLINT: implicit
  constexpr EventArgument(std::string_view text) : text_(text) {}    // NOLINT: implicit
  constexpr EventArgument(const char* text) : text_(text) {}         // NOLINT: implicit
  constexpr EventArgument(int number) : number_(number) {}           // NOLINT: implicit
  constexpr EventArgument(unsigned number) : number_(number) {}      // NOLINT: implicit
  constexpr EventArgument(std::size_t number)                        // NOLINT: implicit
      : number_(static_cast<std::int64_t>(number)) {}

  constexpr EventArgument(std::span<const std::int64_t> list)  // NOLINT: implicit
      : number_(static_cast<std::int64_t>(list.size())), list_(list.data()) {}

  [[nodiscard]] constexpr bool is_list() const { return list_ != nullptr; }
  [[nodiscard]] constexpr std::span<const std::int64_t> list() const {
    return {list_, is_list() ? static_cast<std::size_t>(number_) : 0};
  }
  [[nodiscard]] constexpr bool is_text() const { return text_.data() != nullptr; }
  [[nodiscard]] constexpr std::int64_t number() const { return number_; }
  [[nodiscard]] constexpr std::string_view text() const { return text_; }

 private:
  std::int64_t number_ = 0;  ///< of a list, how many it has
  std::string_view text_{};
  const std::int64_t* list_ = nullptr;
};

/// What happened, as data: raising one costs a copy and no allocation; words are made by the
/// reader.
struct Event {
  SimTime time;
  const EventRule* rule = nullptr;
  std::uint16_t device = 0;  ///< position of the device in its rack, 0 = first
  std::array<EventArgument, 6> arguments{};
};

/// Where events go. The rack's sink logs them and keeps the newest for the dashboard.
class EventSink {
 public:
  EventSink() = default;
  EventSink(const EventSink&) = delete;
  EventSink& operator=(const EventSink&) = delete;
  virtual ~EventSink() = default;

  /// Takes one event; must not throw and must not call back into the device that raised it.
  virtual void on_event(const Event& event) = 0;
};

/// What a device raises its events through: knows the sink and the device's place in the rack.
/// A reporter without a sink drops what it gets, so that parts can be used on their own.
class EventReporter {
 public:
  constexpr EventReporter() = default;
  constexpr EventReporter(EventSink* sink, std::uint16_t device) : sink_(sink), device_(device) {}

  void report(SimTime time, const EventRule& rule,
              const std::array<EventArgument, 6>& arguments = {}) const {
    if (sink_ != nullptr) {
      sink_->on_event(Event{time, &rule, device_, arguments});
    }
  }

 private:
  EventSink* sink_ = nullptr;
  std::uint16_t device_ = 0;
};

/// The sentence of `event` with its arguments filled in. A placeholder that names no argument stays
/// as it is, so that a mistake in a rule is seen and not hidden.
[[nodiscard]] std::string to_sentence(const Event& event);

}  // namespace stator::base
