#include "stator/rack/faults/surroundings_effect.hpp"

#include <algorithm>
#include <utility>

#include "stator/rack/faults/surroundings_faults.hpp"

namespace stator::rack {

namespace {

using base::SimTime;

class SurroundingsEffect final : public FaultEffect {
 public:
  SurroundingsEffect(faults::Target& target, const FaultConfiguration& fault)
      : target_(target),
        device_(*fault.target.device),
        momentary_(fault.kind->momentary),
        settings_(settings_of(fault, target.inputs(device_))),
        over_(fault.values.find<base::SimDuration>("over").value_or(base::SimDuration())) {}

  void begin(SimTime now) override {
    begun_ = now;
    for (const FaultSetting& setting : settings_) {
      if (!setting.ramped || over_ <= base::SimDuration()) {
        set(setting.input, setting.value, true, now);
      }
    }
    if (over_ > base::SimDuration()) {
      step(now);
    }
  }
  void end(SimTime now) override {
    next_ = SimTime::never();
    if (momentary_) {
      return;  // there is nothing to take back
    }
    std::for_each(settings_.rbegin(), settings_.rend(), [&](const FaultSetting& setting) {
      target_.release(InputEvent{device_, setting.input, 0.0}, this, now);
    });
  }
  [[nodiscard]] SimTime next_step() const override { return next_; }
  void step(SimTime now) override {
    constexpr base::SimDuration kStep(1'000'000);
    const base::SimDuration passed = now - begun_;
    const bool whole = passed >= over_;
    const double share = whole ? 1.0 : passed.seconds() / over_.seconds();
    for (const FaultSetting& setting : settings_) {
      if (setting.ramped) {
        set(setting.input, share * setting.value, whole || now == begun_, now);
      }
    }
    next_ = whole ? SimTime::never() : std::min(now + kStep, begun_ + over_);
  }

 private:
  void set(const std::string& input, double value, bool logged, SimTime now) {
    const InputEvent event{device_, input, value, logged};
    if (momentary_) {
      target_.apply(event, now);
    } else {
      target_.hold(event, this, now);
    }
  }

  faults::Target& target_;
  DeviceAddress device_;
  bool momentary_;
  std::vector<FaultSetting> settings_;
  base::SimDuration over_;
  SimTime begun_;
  SimTime next_ = SimTime::never();
};

}  // namespace

MadeEffect surroundings_effect(const FaultSite& site, const FaultConfiguration& fault) {
  return std::make_unique<SurroundingsEffect>(site.target, fault);
}

}  // namespace stator::rack
