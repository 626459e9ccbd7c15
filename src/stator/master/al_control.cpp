#include "stator/master/al_control.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "stator/master/registers.hpp"
#include "stator/master/text.hpp"

namespace stator::master {

using ethercat::AlState;
using ethercat::AlStatusCode;

namespace {

constexpr std::uint16_t kErrorAcknowledge = 0x10;  // AL control bit 4; AL status bit 4: error
constexpr std::uint16_t kStateMask = 0x0F;

/// For so long a request that is the slave's state already is tried on a locked register: a slave
/// whose host is absent never looks.
constexpr base::SimDuration kLockPatience{1'000'000'000};

/// Writes AL control until the slave takes it: the register is locked while the slave has not yet
/// looked at an earlier request.
Result<void> write_al_control(Bus& bus, const Station& station, std::uint16_t value,
                              base::SimTime deadline, const Idle& idle) {
  while (true) {
    auto written = bus.write_number<std::uint16_t>(station, registers::kAlControl, value);
    if (written || written.error().code != ErrorCode::working_counter ||
        bus.port().now() >= deadline) {
      return written;
    }
    if (auto waited = idle(); !waited) {
      return waited;
    }
  }
}

Error refusal(const Station& station, AlState wanted, const AlStatus& status) {
  const auto code = static_cast<std::uint16_t>(status.code);
  return {ErrorCode::state_refused, code,
          station.name() + " refused " + std::string(ethercat::to_text(wanted)) +
              ": AL status code " + hexadecimal(code, 4) + " " + std::string(to_text(status.code)) +
              "; it is in " + std::string(ethercat::to_text(status.state))};
}

/// Whether the slave controller itself copies AL control to AL status, as without a host. What
/// looks like an error is then the acknowledgement that was written, and goes with the next
/// request.
Result<bool> follows_by_itself(Bus& bus, const Station& station) {
  const auto configuration = bus.read_number<std::uint8_t>(station, registers::kEscConfiguration);
  if (!configuration) {
    return base::Unexpected{configuration.error()};
  }
  return (*configuration & 1U) != 0;
}

Result<void> acknowledge_error(Bus& bus, const Station& station, base::SimTime deadline,
                               const Idle& idle) {
  while (true) {
    const auto status = read_al_status(bus, station);
    if (!status) {
      return base::Unexpected{status.error()};
    }
    if (!status->error) {
      return {};
    }
    if (status->code == AlStatusCode::no_error) {
      const auto echo = follows_by_itself(bus, station);
      if (!echo || *echo) {
        return echo ? Result<void>() : Result<void>(base::Unexpected{echo.error()});
      }
    }
    if (bus.port().now() >= deadline) {
      return fail(ErrorCode::state_timeout,
                  station.name() + " keeps indicating AL status code " +
                      hexadecimal(static_cast<std::uint16_t>(status->code), 4) + " " +
                      std::string(to_text(status->code)) + " although it was acknowledged");
    }
    const auto control =
        static_cast<std::uint16_t>(static_cast<std::uint16_t>(status->state) | kErrorAcknowledge);
    if (auto written = write_al_control(bus, station, control, deadline, idle); !written) {
      return written;
    }
    if (auto waited = idle(); !waited) {
      return waited;
    }
  }
}

}  // namespace

Result<AlStatus> read_al_status(Bus& bus, const Station& station) {
  std::array<std::byte, 6> data{};
  if (const auto done = bus.read(station, registers::kAlStatus, data); !done) {
    return base::Unexpected{done.error()};
  }
  const auto status = base::load_le<std::uint16_t>(data.data());
  return AlStatus{.state = static_cast<AlState>(status & kStateMask),
                  .error = (status & kErrorAcknowledge) != 0,
                  .code = static_cast<AlStatusCode>(base::load_le<std::uint16_t>(data.data() + 4))};
}

Result<void> request_al_state(Bus& bus, const Station& station, AlState state, const Idle& idle) {
  const base::SimTime deadline = bus.port().now() + bus.options().state_timeout;
  if (auto acknowledged = acknowledge_error(bus, station, deadline, idle); !acknowledged) {
    return acknowledged;
  }
  const base::SimTime patience = std::min(deadline, bus.port().now() + kLockPatience);
  if (auto written =
          write_al_control(bus, station, static_cast<std::uint16_t>(state), patience, idle);
      !written) {
    const auto status = read_al_status(bus, station);
    if (status && status->state == state && !status->error) {
      return {};
    }
    written = write_al_control(bus, station, static_cast<std::uint16_t>(state), deadline, idle);
    if (!written) {
      return written;
    }
  }
  while (true) {
    const auto status = read_al_status(bus, station);
    if (!status) {
      return base::Unexpected{status.error()};
    }
    if (status->error) {
      return base::Unexpected{refusal(station, state, *status)};
    }
    if (status->state == state) {
      return {};
    }
    if (bus.port().now() >= deadline) {
      return fail(ErrorCode::state_timeout,
                  station.name() + " neither reached nor refused " +
                      std::string(ethercat::to_text(state)) + " within " +
                      std::to_string(bus.options().state_timeout.nanoseconds() / 1'000'000) +
                      " ms; it is in " + std::string(ethercat::to_text(status->state)));
    }
    if (auto waited = idle(); !waited) {
      return waited;
    }
  }
}

}  // namespace stator::master
