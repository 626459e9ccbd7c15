// Switches and push buttons: contacts that bounce.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "stator/base/random.hpp"
#include "stator/board/peripheral/peripheral.hpp"
#include "stator/board/peripheral/peripheral_types.hpp"

namespace stator::board {

namespace {

/// A contact with its pull resistor. Each change begins a time of bouncing, in which the level
/// changes at random moments; it ends with the level meant.
class Contact : public Peripheral {
 public:
  explicit Contact(const Settings& settings)
      : active_low_(settings.flag("active_low")),
        bounce_(settings.integer("bounce_time") * 1000),
        random_(static_cast<std::uint64_t>(settings.integer("seed"))) {}

  void begin(base::SimTime now) override {
    level_ = closed_ != active_low_;
    drive(now, 0, level_);
  }

  void advance(base::SimTime now) override {
    if (now >= settled_at_) {
      release(now);
      return;
    }
    level_ = !level_;
    drive(now, 0, level_);
    bounce_on(now);
  }

  std::vector<base::Signal> signals() const override {
    return {{"closed", "", base::SignalReader::bind<&Contact::closed>(*this)}};
  }

 protected:
  /// "stuck": 1: it stays open, 2: it stays closed, whatever is done to it.
  [[nodiscard]] base::Input stuck_input() {
    return {"stuck",
            "",
            0.0,
            2.0,
            base::Delegate<void(double)>::bind<&Contact::stick>(*this),
            base::InputGroup::switches};
  }
  [[nodiscard]] bool stuck() const { return stuck_ != Stuck::no; }
  /// What is done to the contact.
  void set_closed(bool closed) {
    wanted_ = closed;
    change(stuck_ == Stuck::no ? wanted_ : stuck_ == Stuck::closed);
  }
  /// Bouncing is over.
  virtual void settled(base::SimTime /*now*/) {}

 private:
  enum class Stuck : std::uint8_t { no, open, closed };

  void stick(double kind) {
    stuck_ = static_cast<Stuck>(static_cast<int>(std::floor(kind + 0.5)));
    set_closed(wanted_);
  }
  void change(bool closed) {
    if (closed == closed_) {
      return;
    }
    closed_ = closed;
    settled_at_ = now() + bounce_;
    level_ = closed_ != active_low_;
    drive(now(), 0, level_);
    if (bounce_ > base::SimDuration()) {
      bounce_on(now());
    } else {
      release(now());
    }
  }
  [[nodiscard]] double closed() const { return closed_ ? 1.0 : 0.0; }
  void bounce_on(base::SimTime now) {
    // Some ten changes within the time, never slower than a quarter of it.
    const auto shortest = std::max<std::int64_t>(bounce_.nanoseconds() / 32, 1);
    const auto spread = static_cast<std::uint64_t>(shortest) * 7;
    const base::SimDuration pause(shortest + static_cast<std::int64_t>(random_.below(spread)));
    schedule(std::min(now + pause, settled_at_));
  }
  void release(base::SimTime now) {
    level_ = closed_ != active_low_;
    drive(now, 0, level_);
    settled(now);
  }

  bool active_low_;
  base::SimDuration bounce_;
  base::Random random_;
  Stuck stuck_ = Stuck::no;
  bool wanted_ = false;
  bool closed_ = false;
  bool level_ = false;
  base::SimTime settled_at_;
};

class Switch final : public Contact {
 public:
  using Contact::Contact;
  std::vector<base::Input> inputs() override {
    return {{"closed", "", 0.0, 1.0, base::Delegate<void(double)>::bind<&Switch::set>(*this),
             base::InputGroup::switches},
            stuck_input()};
  }

 private:
  void set(double closed) { set_closed(closed >= 0.5); }
};

/// Opens by itself when it has been held for a while.
class PushButton final : public Contact {
 public:
  explicit PushButton(const Settings& settings)
      : Contact(settings), hold_(settings.integer("hold_time") * 1'000'000) {}

  void advance(base::SimTime now) override {
    if (held_ && now >= release_at_) {
      held_ = false;
      set_closed(false);
      return;
    }
    Contact::advance(now);
  }
  std::vector<base::Input> inputs() override {
    return {{"press", "", 0.0, 1.0, base::Delegate<void(double)>::bind<&PushButton::press>(*this),
             base::InputGroup::switches},
            stuck_input()};
  }

 private:
  void press(double pressed) {
    if (pressed >= 0.5 && !held_) {
      held_ = true;
      release_at_ = now() + hold_;
      set_closed(true);
      if (stuck()) {
        settled(now());  // no change of the contact ends the press
      }
    }
  }
  void settled(base::SimTime now) override {
    if (held_) {
      schedule(std::max(release_at_, now));
    }
  }

  base::SimDuration hold_;
  base::SimTime release_at_;
  bool held_ = false;
};

constexpr std::array<PinDeclaration, 1> kPins{
    {{"line", PinUse::drives, false, "the input it is wired to, with a pull resistor"}}};

constexpr ParameterDeclaration kActiveLow{"active_low", "",  0.0,
                                          1.0,          0.0, "1: the line is low while closed"};
constexpr ParameterDeclaration kBounceTime{
    "bounce_time", "us", 0.0, 1e6, 0.0, "how long the contact bounces at each change"};
constexpr ParameterDeclaration kSeed{"seed", "", 0.0, 4294967295.0, 1.0, "of the bouncing"};

constexpr std::array<ParameterDeclaration, 3> kSwitchParameters{kActiveLow, kBounceTime, kSeed};
constexpr std::array<ParameterDeclaration, 4> kButtonParameters{
    kActiveLow, kBounceTime, kSeed,
    ParameterDeclaration{"hold_time", "ms", 1.0, 1e6, 200.0, "how long a press lasts"}};

}  // namespace

constinit const PeripheralType kSwitch{"switch",
                                       "a contact that people set, bouncing on demand",
                                       kPins,
                                       kSwitchParameters,
                                       {},
                                       [](const Settings& settings) -> std::unique_ptr<Peripheral> {
                                         return std::make_unique<Switch>(settings);
                                       }};

constinit const PeripheralType kPushButton{
    "push-button",
    "a contact that opens by itself, bouncing on demand",
    kPins,
    kButtonParameters,
    {},
    [](const Settings& settings) -> std::unique_ptr<Peripheral> {
      return std::make_unique<PushButton>(settings);
    }};

}  // namespace stator::board
