#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <span>
#include <string>
#include <string_view>

#include "stator/base/event_text.hpp"
#include "stator/base/sim_time.hpp"

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
  StaticText id;  ///< stable name for programs, e.g. "al-sm-length"
  Severity severity = Severity::information;
  StaticText text;
};

/// A number, a text or a list of numbers. An event may be kept and read by any thread for as long
/// as one likes: what it refers to is either constant (StaticText, StaticList) or shared with it
/// (SharedText), and nothing else can be given.
class EventArgument {
 public:
  constexpr EventArgument() = default;
  constexpr EventArgument(std::int64_t number) : value_{.number = number} {}    // NOLINT: implicit
  constexpr EventArgument(int number) : EventArgument(std::int64_t{number}) {}  // NOLINT: implicit
  constexpr EventArgument(unsigned number)                                      // NOLINT: implicit
      : EventArgument(std::int64_t{number}) {}
  constexpr EventArgument(std::size_t number)  // NOLINT: implicit
      : EventArgument(static_cast<std::int64_t>(number)) {}
  template <std::size_t N>
  consteval EventArgument(const char (&literal)[N])  // NOLINT: implicit
      : EventArgument(StaticText(literal)) {}
  template <std::size_t N>
  EventArgument(char (&changeable)[N]) = delete;
  constexpr EventArgument(StaticText text)  // NOLINT: implicit
      : kind_(Kind::text), value_{.text = {text.view().data(), text.view().size()}} {}
  constexpr EventArgument(StaticList list)  // NOLINT: implicit
      : kind_(Kind::list), value_{.list = {list.view().data(), list.view().size()}} {}
  EventArgument(const SharedText& text)  // NOLINT: implicit
      : kind_(Kind::shared_text) {
    std::construct_at(&shared(), text);
  }

  constexpr EventArgument(const EventArgument& other) : kind_(other.kind_), value_(other.value_) {
    if (kind_ == Kind::shared_text) {
      std::construct_at(&shared(), other.shared());
    }
  }
  constexpr EventArgument& operator=(const EventArgument& other) {
    if (this != &other) {
      std::destroy_at(this);
      std::construct_at(this, other);
    }
    return *this;
  }
  constexpr ~EventArgument() {
    if (kind_ == Kind::shared_text) {
      std::destroy_at(&shared());
    }
  }

  [[nodiscard]] constexpr bool is_number() const { return kind_ == Kind::number; }
  [[nodiscard]] constexpr bool is_list() const { return kind_ == Kind::list; }
  [[nodiscard]] constexpr bool is_text() const { return !is_number() && !is_list(); }
  /// 0 if it is none.
  [[nodiscard]] constexpr std::int64_t number() const { return is_number() ? value_.number : 0; }
  /// Empty if it is none, and valid as long as this.
  [[nodiscard]] constexpr std::string_view text() const {
    if (kind_ == Kind::shared_text) {
      return shared().str();
    }
    return kind_ == Kind::text ? std::string_view(value_.text.data, value_.text.size)
                               : std::string_view();
  }
  /// Empty if it is none.
  [[nodiscard]] constexpr std::span<const std::int64_t> list() const {
    return is_list() ? std::span(value_.list.data, value_.list.size)
                     : std::span<const std::int64_t>();
  }

  /// Both tell people the same.
  friend constexpr bool operator==(const EventArgument& a, const EventArgument& b) {
    return a.is_text() == b.is_text() && a.is_list() == b.is_list() && a.number() == b.number() &&
           a.text() == b.text() && std::ranges::equal(a.list(), b.list());
  }

 private:
  enum class Kind : std::uint8_t { number, text, list, shared_text };
  template <typename T>
  struct View {
    const T* data;
    std::size_t size;
  };
  // Literals become arguments in constant expressions, which a union with a member of type
  // SharedText could not be made in; so a SharedText is made in bytes when it is needed.
  union Value {
    std::int64_t number = 0;
    View<char> text;
    View<std::int64_t> list;
    alignas(SharedText) std::array<std::byte, sizeof(SharedText)> shared;
  };

  [[nodiscard]] SharedText& shared() {
    return *std::launder(reinterpret_cast<SharedText*>(&value_.shared));
  }
  [[nodiscard]] const SharedText& shared() const {
    return *std::launder(reinterpret_cast<const SharedText*>(&value_.shared));
  }

  Kind kind_ = Kind::number;
  Value value_{};
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
