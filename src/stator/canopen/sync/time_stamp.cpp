#include "stator/canopen/sync/time_stamp.hpp"

#include <array>

#include "stator/base/byte_order.hpp"
#include "stator/canopen/cob_id.hpp"

namespace stator::canopen {

namespace {

using base::SimTime;

constexpr std::uint16_t kTimeStampCobId = 0x1012;
constexpr std::uint32_t kConsume = 0x80000000;
constexpr std::uint32_t kProduce = 0x40000000;
constexpr std::uint32_t kIdentifierMask = 0x7FF;
constexpr std::uint8_t kLength = 6;
constexpr std::uint32_t kMillisecondMask = 0x0FFFFFFF;
constexpr std::int64_t kMillisecondsPerDay = 86'400'000;

constexpr base::EventRule kWrongLength{"time-length", base::Severity::refusal,
                                       "time stamp ignored: it has {0} bytes, TIME_OF_DAY has 6"};

}  // namespace

TimeStamp::TimeStamp(dictionary::Dictionary& dictionary, can::Transmitter& transmitter,
                     base::EventReporter reporter)
    : transmitter_(transmitter), reporter_(reporter), entry_(dictionary.find(kTimeStampCobId, 0)) {
  if (entry_ != nullptr) {
    dictionary.on_check(kTimeStampCobId, 0,
                        dictionary::Entry::CheckHook::bind<&TimeStamp::check>(*this));
  }
}

dictionary::Verdict TimeStamp::check(const dictionary::Entry& entry, std::uint64_t value) {
  return check_cob_id(entry, CobIdKind::time, value, {});
}

std::uint32_t TimeStamp::cob_id() const {
  return entry_ == nullptr ? 0 : static_cast<std::uint32_t>(entry_->value());
}

void TimeStamp::start(SimTime /*now*/) {
  time_.reset();
}

void TimeStamp::on_state(NmtState state, SimTime /*now*/) {
  enabled_ = state == NmtState::pre_operational || state == NmtState::operational;
}

bool TimeStamp::receive(const can::Frame& frame, SimTime now) {
  if (!enabled_ || (cob_id() & kConsume) == 0 || frame.remote ||
      frame.identifier != (cob_id() & kIdentifierMask)) {
    return false;
  }
  if (frame.length != kLength) {
    reporter_.report(now, kWrongLength, {int{frame.length}});
    return true;
  }
  time_ = TimeOfDay{.milliseconds = base::load_le<std::uint32_t>(frame.data) & kMillisecondMask,
                    .days = base::load_le<std::uint16_t>(frame.data, 4)};
  taken_at_ = now;
  return true;
}

std::optional<TimeOfDay> TimeStamp::time_of_day(SimTime now) const {
  if (!time_) {
    return std::nullopt;
  }
  const std::int64_t milliseconds =
      time_->milliseconds + (now - taken_at_).nanoseconds() / 1'000'000;
  return TimeOfDay{
      .milliseconds = static_cast<std::uint32_t>(milliseconds % kMillisecondsPerDay),
      .days = static_cast<std::uint16_t>(time_->days + milliseconds / kMillisecondsPerDay)};
}

bool TimeStamp::produce(const TimeOfDay& time, SimTime now) {
  if (!enabled_ || (cob_id() & kProduce) == 0) {
    return false;
  }
  time_ = time;
  taken_at_ = now;
  std::array<std::byte, kLength> data{};
  base::store_le(data, 0, time.milliseconds & kMillisecondMask);
  base::store_le(data, 4, time.days);
  return transmitter_.send(can::data_frame(cob_id() & kIdentifierMask, data));
}

}  // namespace stator::canopen
