#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/drive/modes/operating_mode.hpp"

namespace stator::drive {

/// What a test does with an axis through its CiA 402 objects, and the events the axis reports.
class ObjectBench : public base::EventSink {
 public:
  void on_event(const base::Event& event) override {
    sentences.push_back(base::to_sentence(event));
  }
  /// Some event's sentence contains `text`.
  [[nodiscard]] bool told(const std::string& text) const;

  /// Writes an object as an SDO does and lets the axis obey.
  void write(std::uint16_t index, std::int64_t value) { write(index, 0, value); }
  void write(std::uint16_t index, std::uint8_t subindex, std::int64_t value);
  [[nodiscard]] std::int64_t read(std::uint16_t index, std::uint8_t subindex = 0) const {
    return dictionary.find(index, subindex)->signed_value();
  }
  /// Any of these bits of the statusword, 6041h.
  [[nodiscard]] bool status(std::uint16_t bit) const {
    return (static_cast<std::uint16_t>(read(0x6041)) & bit) != 0;
  }
  /// 6081h, 6083h and 6084h, in the units of the axis.
  void set_profile(std::int64_t velocity, std::int64_t acceleration, std::int64_t deceleration);
  /// Controlword 15, then with bit 4.
  void start();

  /// Simulated time passes, and the axis with it.
  virtual void pass(base::SimDuration duration) = 0;
  /// Passes time until `done`, which is asked once per period, or for `longest`; returns whether it
  /// was done.
  template <typename Condition>
  bool pass_until(Condition done, base::SimDuration longest) {
    for (const base::SimTime end = now + longest; now < end;) {
      pass(period_);
      if (done()) {
        return true;
      }
    }
    return false;
  }

  dictionary::Dictionary dictionary;
  std::vector<std::string> sentences;
  base::SimTime now;

 protected:
  /// `period`: of the axis.
  explicit ObjectBench(base::SimDuration period) : period_(period) {}
  /// Lets the axis take what was written.
  virtual void obey() = 0;
  /// 6060h, then 6, 7, 15.
  void request_operation(ModeCode mode);

 private:
  base::SimDuration period_;
};

}  // namespace stator::drive
