#include "masters/slave_rules.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "masters/device_bus.hpp"
#include "stator/base/byte_order.hpp"

namespace stator::tests {

namespace {

using Kind = MasterAction::Kind;

constexpr unsigned kInit = 1;
constexpr unsigned kPreOperational = 2;
constexpr unsigned kSafeOperational = 4;
constexpr unsigned kOperational = 8;
constexpr unsigned kAcknowledge = 0x10;

constexpr std::uint32_t kLogical = 0x10000;
constexpr std::uint16_t kTarget = 0x607A;
/// No room for an SDO.
constexpr std::uint16_t kTooShort = 8;
constexpr base::SimDuration kFrameInterval = 10_us;
/// Firmware looks at its watchdog in a loop of its own.
constexpr base::SimDuration kLoop = 3_ms;

constexpr std::uint32_t kReadOnly = 0x06010002;
constexpr std::uint32_t kNoObject = 0x06020000;
constexpr std::uint32_t kNotNow = 0x08000022;

/// An expedited SDO; `command` says what it is.
Bytes sdo_request(unsigned command, unsigned index, unsigned subindex, std::uint32_t value = 0) {
  Bytes request = bytes({command, index & 0xFF, index >> 8, subindex});
  const Bytes data = little_endian(value, 4);
  request.insert(request.end(), data.begin(), data.end());
  return request;
}

}  // namespace

SlaveRules::SlaveRules(const MakeDevice& make) : device_(make({})) {
  segment_.append(device_->controller());
  const dictionary::Dictionary& dictionary = device_->dictionary();
  const auto mapped_bytes = [&](std::uint16_t assignment, std::optional<std::size_t>* target) {
    std::size_t bits = 0;
    const auto value = [&](std::uint16_t index, std::uint64_t subindex) {
      return dictionary.find(index, static_cast<std::uint8_t>(subindex))->value();
    };
    for (std::uint64_t pdo = 1; pdo <= value(assignment, 0); ++pdo) {
      const auto mapping = static_cast<std::uint16_t>(value(assignment, pdo));
      for (std::uint64_t entry = 1; entry <= value(mapping, 0); ++entry) {
        const std::uint64_t mapped = value(mapping, entry);
        if (target != nullptr && mapped >> 16 == kTarget) {
          *target = bits / 8;
        }
        bits += mapped & 0xFF;
      }
    }
    return bits / 8;
  };
  std::optional<std::size_t> target;
  output_bytes_ = mapped_bytes(0x1C12, &target);
  input_bytes_ = mapped_bytes(0x1C13, nullptr);
  target_offset_ = target.value();
  start_anew();
}

void SlaveRules::start_anew() {
  pass(200_ms);
  status_ = {};
  requested_.reset();
  mailboxes_right_ = false;
  channels_ = kOff;
  trigger_ = false;
  watchdog_count_ = 1000;
  waiting_.reset();
  permitted_ = {static_cast<std::uint32_t>(device_->dictionary().find(kTarget, 0)->value())};
  observe();
}

void SlaveRules::fail(std::string rule) {
  if (!broken_) {
    broken_ = fmt::format("{} [AL status {:02X}h, code {:04X}h]", std::move(rule),
                          status_.state | (status_.error ? kAcknowledge : 0U), status_.code);
  }
}

void SlaveRules::perform(const MasterAction& action) {
  switch (action.kind) {
    case Kind::request_state:
      request(action.value);
      break;
    case Kind::mailboxes:
      set_mailboxes(action.value);
      break;
    case Kind::process_data:
      set_process_data(action.value);
      break;
    case Kind::exchange:
      exchange_cycles(action.value);
      break;
    case Kind::outputs_by_address: {
      Bytes outputs(output_bytes_);
      base::store_le(outputs, target_offset_, ++token_);
      note_outputs(write(device_->description().output_offset, outputs) == 1);
      break;
    }
    case Kind::silence:
      be_silent(1_ms * action.value);
      break;
    case Kind::sync_on:
      start_sync(action.value);
      break;
    case Kind::sync_off:
      write(0x0981, bytes({0}));
      break;
    case Kind::watchdog:
      watchdog_count_ = action.value;
      write(0x0420, little_endian(action.value, 2));
      last_expiry_from_ = now_;
      break;
    case Kind::sync_type:
      write_sync_type(action.value);
      break;
    case Kind::upload:
      try_uploads();
      break;
    case Kind::download:
      try_downloads();
      break;
    case Kind::mailbox_repeat:
      repeat_answer();
      break;
    case Kind::controller_reset:
      reset_controller();
      break;
    case Kind::power_cycle:
      cycle_power();
      break;
    case Kind::bring_up:
      bring_up((action.value & 1) != 0, action.value >> 1);
      break;
  }
  observe();
}

// Frames.

void SlaveRules::pass(base::SimDuration duration) {
  now_ += duration;
  device_->advance(now_);
  segment_.advance(now_);
}

SlaveRules::Answer SlaveRules::transfer(Command command, std::uint32_t address, const Bytes& data) {
  frame_.append(command, address, data);
  pass(kFrameInterval);
  const bool returned = segment_.process(frame_.finish(), now_);
  device_->handle_bus_events(now_);
  return frame_.take_answers(returned).front();
}

SlaveRules::Answer SlaveRules::read(std::uint16_t address, std::size_t length) {
  return transfer(Command::aprd, ethercat::physical_address(0, address), zeros(length));
}

unsigned SlaveRules::write(std::uint16_t address, const Bytes& data) {
  return transfer(Command::apwr, ethercat::physical_address(0, address), data).working_counter;
}

// What the master does.

void SlaveRules::request(unsigned control) {
  observe();
  const Status before = status_;
  const std::optional<unsigned> code = expected_code(control);
  requested_ = control;
  if (write(0x0120, little_endian(control, 2)) != 1) {
    fail("AL control cannot be written, although the request before was answered");
  }
  observe();
  if (before.error && (control & kAcknowledge) == 0 && (control & 0x0F) != kInit) {
    // What ends Operational by itself may come in the same moment.
    if (!status_.error || status_.state > before.state) {
      fail("a request went through although the error was not acknowledged");
    }
  } else if (code == 0U) {
    if (status_.state != (control & 0x0F) || status_.error) {
      fail(fmt::format("AL control {:02X}h was not granted", control));
    }
  } else if (code && (status_.state != before.state || status_.code != *code)) {
    fail(fmt::format("AL control {:02X}h was not refused with {:04X}h", control, *code));
  }
}

std::optional<unsigned> SlaveRules::expected_code(unsigned control) const {
  const unsigned from = status_.state;
  const unsigned to = control & 0x0F;
  if (to == 0 || to > kOperational || (to & (to - 1)) != 0) {
    return to == 3 && (from == kInit || from == to) ? std::nullopt
           : to == 3                                ? std::optional(0x11U)
                                                    : std::optional(0x12U);
  }
  if (from == 3) {
    return std::nullopt;
  }
  if (to <= from) {
    return 0U;
  }
  if (to != from * 2) {
    return 0x11U;
  }
  if (to == kPreOperational) {
    return mailboxes_right_ ? 0U : 0x16U;
  }
  if (to == kSafeOperational && channels_ != kRight && channels_ != kWithoutTrigger) {
    return 0x1DU;
  }
  return sync_touched_ ? std::nullopt : std::optional(0U);
}

void SlaveRules::set_channel(unsigned channel, std::uint16_t start, std::size_t length,
                             std::uint8_t control) {
  Bytes registers(8);
  base::store_le(registers, 0, start);
  base::store_le(registers, 2, static_cast<std::uint16_t>(length));
  registers[4] = std::byte{control};
  registers[6] = std::byte{length != 0};
  const auto address = static_cast<std::uint16_t>(0x0800 + 8 * channel);
  write(static_cast<std::uint16_t>(address + 6), bytes({0}));
  write(address, registers);
}

void SlaveRules::set_mailboxes(std::uint32_t how) {
  const ethercat::DeviceDescription& d = device_->description();
  const auto length = [&](const ethercat::MailboxArea& area) {
    return how == kRight ? area.length : how == kWrongLength ? kTooShort : std::uint16_t{0};
  };
  mailboxes_right_ = how == kRight;
  set_channel(0, d.receive_mailbox.offset, length(d.receive_mailbox), 0x26);
  set_channel(1, d.transmit_mailbox.offset, length(d.transmit_mailbox), 0x22);
  pass(1_ms);
}

void SlaveRules::set_process_data(std::uint32_t how) {
  const ethercat::DeviceDescription& d = device_->description();
  const std::size_t wrong = how == kWrongLength ? 1 : 0;
  channels_ = how;
  set_channel(2, d.output_offset, output_bytes_ - wrong,
              how == kWithoutTrigger ? std::uint8_t{0x24} : std::uint8_t{0x64});
  set_channel(3, d.input_offset, input_bytes_ - wrong, 0x20);
  const auto outputs = static_cast<std::uint16_t>(output_bytes_);
  write(0x0600, fmmu(kLogical, outputs, d.output_offset, 2));
  write(0x0610,
        fmmu(kLogical + outputs, static_cast<std::uint16_t>(input_bytes_), d.input_offset, 1));
  pass(1_ms);
}

void SlaveRules::note_outputs(bool accepted) {
  if (!accepted) {
    return;
  }
  first_expiry_from_ = now_;
  last_expiry_from_ = now_;
  if (status_.state == kOperational) {
    permitted_.push_back(token_);
  } else if (status_.state == kSafeOperational) {
    waiting_ = token_;
  }
}

void SlaveRules::exchange() {
  Bytes image(output_bytes_ + input_bytes_);
  base::store_le(image, target_offset_, ++token_);
  const bool complete = (status_.state == kOperational || status_.state == kSafeOperational) &&
                        (channels_ == kRight || channels_ == kWithoutTrigger);
  const Answer answer = transfer(Command::lrw, kLogical, image);
  note_outputs(answer.working_counter >= 2);
  if (complete && answer.working_counter != 3) {
    fail(fmt::format("working counter {} of 3", answer.working_counter));
  }
}

void SlaveRules::exchange_cycles(std::uint32_t cycles) {
  for (std::uint32_t cycle = 0; cycle < cycles; ++cycle) {
    exchange();
    observe();
    pass(1_ms - kFrameInterval * 2);
  }
}

void SlaveRules::be_silent(base::SimDuration duration) {
  // No state may come and go unseen.
  for (const base::SimTime end = now_ + duration; now_ < end;) {
    pass(std::min(10_ms, end - now_));
    observe();
  }
}

void SlaveRules::start_sync(std::uint32_t cycle_us) {
  sync_touched_ = true;
  const std::uint64_t cycle = std::uint64_t{cycle_us} * 1000;
  const std::uint64_t system_time = number(read(0x0910, 8).data);
  write(0x0981, bytes({0}));
  write(0x0990, little_endian((system_time / cycle + 1) * cycle + 5'000'000, 8));
  write(0x09A0, little_endian(cycle, 4));
  write(0x0981, bytes({3}));
}

void SlaveRules::write_sync_type(std::uint32_t type) {
  sync_touched_ = true;
  observe();
  if (!answers_mailbox()) {
    return;
  }
  const std::optional<Bytes> answer = ask(sdo_request(0x2B, 0x1C32, 1, type));
  if (answer && (*answer)[8] == std::byte{0x60}) {
    sync_type_ = type;
  }
}

void SlaveRules::try_uploads() {
  observe();
  if (!answers_mailbox()) {
    return;
  }
  const std::optional<Bytes> answer = ask(sdo_request(0x40, 0x1018, 1));
  if (answer && (base::load_le<std::uint16_t>(*answer, 6) != 0x3000 ||
                 base::load_le<std::uint32_t>(*answer, 12) != device_->description().vendor_id)) {
    fail("1018h:01 did not answer with the vendor");
  }
  expect_abort(sdo_request(0x40, 0x5FFF, 0), kNoObject);
}

void SlaveRules::try_downloads() {
  observe();
  if (!answers_mailbox()) {
    return;
  }
  expect_abort(sdo_request(0x2B, 0x6041, 0), kReadOnly);
  if (status_.state != kPreOperational) {
    expect_abort(sdo_request(0x2F, 0x1C12, 0), kNotNow);
  }
}

void SlaveRules::expect_abort(const Bytes& sdo, std::uint32_t code) {
  const std::optional<Bytes> answer = ask(sdo);
  if (!answer) {
    return;
  }
  // ETG.1000.6 §5.6.2.7: an abort is an SDO request, whoever sends it.
  if (base::load_le<std::uint16_t>(*answer, 6) != 0x2000 || (*answer)[8] != std::byte{0x80} ||
      base::load_le<std::uint32_t>(*answer, 12) != code) {
    fail(fmt::format("{:04X}h was not refused with {:08X}h", base::load_le<std::uint16_t>(sdo, 1),
                     code));
  }
}

std::optional<SlaveRules::Bytes> SlaveRules::fetch(base::SimDuration limit) {
  const ethercat::MailboxArea area = device_->description().transmit_mailbox;
  const base::SimTime end = now_ + limit;
  while (now_ < end) {
    if ((read(0x080D, 1).data[0] & std::byte{8}) == std::byte{0}) {
      pass(100_us);
      continue;
    }
    Bytes message = read(area.offset, area.length).data;
    const bool emergency = base::load_le<std::uint16_t>(message, 6) == 0x1000;
    if (!emergency) {
      return message;
    }
  }
  return std::nullopt;
}

std::optional<SlaveRules::Bytes> SlaveRules::ask(const Bytes& sdo) {
  if (fetch(1_ms)) {
    fail("the mailbox held an answer that nobody had asked for");
    return std::nullopt;
  }
  counter_ = counter_ % 7 + 1;
  Bytes message(device_->description().receive_mailbox.length);
  base::store_le(message, 0, static_cast<std::uint16_t>(2 + sdo.size()));
  message[5] = static_cast<std::byte>(0x03 | counter_ << 4);
  base::store_le(message, 6, std::uint16_t{0x2000});
  std::ranges::copy(sdo, message.begin() + 8);
  if (write(device_->description().receive_mailbox.offset, message) != 1) {
    fail("the mailbox takes no request");
    return std::nullopt;
  }
  std::optional<Bytes> answer = fetch(50_ms);
  observe();
  if (!answer && answers_mailbox()) {
    fail("a request to the mailbox has no answer");
  }
  return answer;
}

void SlaveRules::repeat_answer() {
  observe();
  if (!answers_mailbox()) {
    return;
  }
  const std::optional<Bytes> answer = ask(sdo_request(0x40, 0x1018, 1));
  const unsigned activate = std::to_integer<unsigned>(read(0x080E, 1).data[0]) ^ 2;
  write(0x080E, bytes({activate}));
  for (int poll = 0; poll < 100; ++poll) {
    pass(100_us);
    if (((std::to_integer<unsigned>(read(0x080F, 1).data[0]) ^ activate) & 2) == 0) {
      if (fetch(5_ms) != answer) {
        fail("the answer asked for again is another one");
      }
      return;
    }
  }
  observe();
  if (answers_mailbox()) {
    fail("the request for the answer again is not acknowledged");
  }
}

void SlaveRules::reset_controller() {
  for (const unsigned key : {0x52U, 0x45U, 0x53U}) {
    write(0x0040, bytes({key}));
  }
  start_anew();
}

void SlaveRules::cycle_power() {
  segment_.set_power(0, false);
  device_->set_power(false, now_);
  pass(50_ms);
  segment_.set_power(0, true);
  device_->set_power(true, now_);
  sync_touched_ = false;
  sync_type_ = 0;
  start_anew();
}

void SlaveRules::bring_up(bool sync, std::uint32_t sync_type) {
  const bool refused_by_choice = !sync && sync_type == 0 && sync_type_ == 2;
  const auto granted = [&](unsigned control) {
    request(control);
    for (int cycle = 0; cycle < 2000 && status_.state != (control & 0x0F) && !status_.error;
         ++cycle) {
      exchange_cycles(1);
    }
    if (!refused_by_choice && (status_.state != (control & 0x0F) || status_.error)) {
      fail(fmt::format("bring-up by the book ended at AL control {:02X}h", control));
    }
    return !broken_ && status_.state == (control & 0x0F);
  };
  if (!granted(kInit | kAcknowledge)) {
    return;
  }
  write(0x0981, bytes({0}));
  watchdog_count_ = 1000;
  write(0x0420, little_endian(watchdog_count_, 2));
  set_mailboxes(kRight);
  if (!granted(kPreOperational | kAcknowledge)) {
    return;
  }
  if (sync_type != 0) {
    write_sync_type(sync_type);
  }
  set_process_data(kRight);
  if (sync) {
    start_sync(1000);
  }
  if (!granted(kSafeOperational)) {
    return;
  }
  exchange_cycles(5);
  granted(kOperational);
}

// What has to hold.

base::SimDuration SlaveRules::watchdog_time() const {
  return trigger_ ? 100_us * watchdog_count_ : base::SimDuration(0);
}

void SlaveRules::observe() {
  const Answer answer = read(0x0130, 6);
  const Status before = status_;
  const auto al_status = base::load_le<std::uint16_t>(answer.data, 0);
  status_ = {al_status & 0x0FU, (al_status & kAcknowledge) != 0,
             base::load_le<std::uint16_t>(answer.data, 4)};
  if (answer.working_counter != 1) {
    fail("the slave does not answer");
    return;
  }
  if (status_.error != (status_.code != 0)) {
    fail("AL status and AL status code do not agree");
  }
  check_change(before, status_);
  requested_.reset();
  check_watchdog();
  check_outputs();
}

void SlaveRules::check_change(const Status& before, const Status& after) {
  const unsigned target = requested_.value_or(0) & 0x0F;
  if (before.error && !after.error && !requested_) {
    fail("an error went without acknowledgement");
  }
  if (after.state == before.state) {
    return;
  }
  const bool asked_before = after.state == target;
  // A request that waits for SYNC0 is granted later.
  const bool asked_earlier =
      sync_touched_ && before.state == kSafeOperational && after.state == kOperational;
  if (!asked_before && !asked_earlier && (after.state > before.state || !after.error)) {
    fail(fmt::format("from AL state {} without request or error", before.state));
  }
  if (before.state == kOperational && after.code == 0x1B &&
      now_ < first_expiry_from_ + watchdog_time()) {
    fail("the watchdog ended Operational before its time");
  }
  if (after.state == kSafeOperational && before.state != kOperational) {
    trigger_ = channels_ == kRight;
  }
  if (after.state == kOperational) {
    last_expiry_from_ = std::max(last_expiry_from_, now_);
    if (waiting_) {
      permitted_.push_back(*waiting_);
    }
  }
  waiting_.reset();
}

void SlaveRules::check_watchdog() {
  if (status_.state == kOperational && watchdog_time() != base::SimDuration(0) &&
      now_ > last_expiry_from_ + watchdog_time() + kLoop) {
    fail("Operational goes on although the watchdog's time is over");
  }
}

void SlaveRules::check_outputs() {
  const auto value = static_cast<std::uint32_t>(device_->dictionary().find(kTarget, 0)->value());
  const auto seen = std::ranges::find(permitted_, value);
  if (seen == permitted_.end()) {
    fail(fmt::format("607Ah is {}, which was sent outside Operational or is older than the last",
                     value));
    return;
  }
  permitted_.erase(permitted_.begin(), seen);
  if (status_.state != kOperational) {
    permitted_ = {value};
  }
}

}  // namespace stator::tests
