#include "stator/tmcl/sessions/module_interface.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "stator/tmcl/command.hpp"

namespace stator::tmcl {

namespace {

using namespace base::literals;

/// What command 242 must carry to start the boot loader.
constexpr std::uint8_t kBootType = 0x81;
constexpr std::uint8_t kBootMotor = 0x92;
constexpr std::uint32_t kBootValue = 0xA3B4C5D6;
/// Clients send the nine bytes of a telegram at once; the firmware looks for them every
/// millisecond.
constexpr base::SimDuration kGap = 100_ms;

}  // namespace

ModuleInterface::ModuleInterface(ModuleIdentity identity, const BootMemory& memory,
                                 base::EventReporter reporter)
    : identity_(std::move(identity)), reporter_(reporter), receiver_(kGap), boot_loader_(memory) {}

void ModuleInterface::restart() {
  receiver_.reset();
  boot_loader_.enter();
  mode_ = Mode::firmware;
}

bool ModuleInterface::take_boot_request() {
  if (mode_ != Mode::boot_requested) {
    return false;
  }
  mode_ = Mode::boot_loader;
  return true;
}

void ModuleInterface::answer_all(base::SimTime now) {
  std::array<std::byte, 64> buffer{};
  while (const std::size_t length = port_->take(buffer)) {
    for (const std::byte byte : std::span(buffer).first(length)) {
      if (const auto telegram = receiver_.take(byte, now)) {
        answer(*telegram, now);
      }
    }
  }
}

void ModuleInterface::answer(const Telegram& telegram, base::SimTime now) {
  const Request request = decode_request(telegram);
  Reply reply{.host_address = kHostAddress,
              .module_address = kModuleAddress,
              .status = Status::wrong_checksum,
              .command = request.command,
              .value = 0};
  if (!has_right_checksum(telegram)) {
    reporter_.report(
        now, rules::kWrongChecksum,
        {identity_.line, std::to_integer<int>(telegram.back()), int{checksum(telegram)}});
  } else if (identity_.addressed && request.address != kModuleAddress) {
    reporter_.report(now, rules::kWrongAddress,
                     {identity_.line, int{request.address}, int{kModuleAddress}});
    return;
  } else if (static_cast<Command>(request.command) == Command::get_firmware_version &&
             request.type == 0) {
    send_version_text(now);
    return;
  } else if (is_never_answered(request.command)) {
    obey_silently(request, now);
    return;
  } else {
    const Answer answer = answer_to(request, now);
    reply.status = answer.status;
    reply.value = answer.value;
  }
  port_->send(encode(reply), now);
}

// The only reply without checksum: host address and eight characters.
void ModuleInterface::send_version_text(base::SimTime now) {
  const std::string& text = in_boot_loader() ? identity_.boot_loader_text : identity_.version_text;
  Telegram telegram{};
  telegram[0] = std::byte{kHostAddress};
  std::ranges::transform(text.substr(0, telegram.size() - 1), telegram.begin() + 1,
                         [](char character) { return static_cast<std::byte>(character); });
  port_->send(telegram, now);
}

void ModuleInterface::obey_silently(const Request& request, base::SimTime now) {
  if (static_cast<Command>(request.command) == Command::boot) {
    const bool has_key = request.type == kBootType && request.motor == kBootMotor &&
                         static_cast<std::uint32_t>(request.value) == kBootValue;
    if (!has_key) {
      reporter_.report(now, rules::kNoBootKey, {identity_.line});
    } else if (!in_boot_loader()) {
      reporter_.report(now, rules::kBootLoaderStarted, {identity_.line});
      mode_ = Mode::boot_requested;
    }
  } else if (!in_boot_loader()) {
    reporter_.report(now, rules::kFirmwareRuns, {identity_.line});
  } else if (!boot_loader_.erased() || boot_loader_.complete()) {
    mode_ = Mode::start_requested;
  } else {
    reporter_.report(now, rules::kNotStarted, {identity_.line});
  }
}

ModuleInterface::Answer ModuleInterface::answer_to(const Request& request, base::SimTime now) {
  if (in_boot_loader()) {
    return boot_loader_.execute(request);
  }
  if (static_cast<Command>(request.command) == Command::get_firmware_version) {
    return request.type == 1 ? Answer{Status::success, identity_.version_number}
                             : Answer{Status::wrong_type};
  }
  return execute(request, now);
}

}  // namespace stator::tmcl
