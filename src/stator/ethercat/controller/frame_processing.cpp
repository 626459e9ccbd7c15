// The bus side: what a slave does with the datagrams of a frame that passes.

#include <algorithm>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/controller/slave_controller.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"

namespace stator::ethercat {

namespace {

using namespace register_address;

void add(DatagramView& datagram, unsigned count) {
  datagram.working_counter = static_cast<std::uint16_t>(datagram.working_counter + count);
}

}  // namespace

void SlaveController::process(std::span<DatagramView> datagrams, const FrameTiming& timing) {
  frame_start_ = timing.processing_unit;
  now_ = std::max(now_, frame_start_);
  if (now_ >= next_deadline_) [[unlikely]] {
    expire(now_);
  }
  if (frame_work_ != 0) [[unlikely]] {
    begin_frame_work();
  }
  if (partner_ != nullptr) [[unlikely]] {
    partner_->start_of_frame(now_);
  }
  for (DatagramView& datagram : datagrams) {
    switch (datagram.command) {
      case Command::lrd:
      case Command::lwr:
      case Command::lrw:
        if (concerns(datagram)) {
          process_logical(datagram);
        }
        break;
      default:
        process_physical(datagram);
        break;
    }
    datagram.interrupt |= interrupt_;
  }
  if (frame_work_ != 0) [[unlikely]] {
    end_frame_work(timing);
  }
  if (partner_ != nullptr) [[unlikely]] {
    partner_->end_of_frame(now_);
  }
}

void SlaveController::process_physical(DatagramView& datagram) {
  const auto at_position = [&datagram] {
    // Each slave counts the position up, so the one that sees 0 is addressed.
    const std::uint16_t position = datagram.adp();
    datagram.address = physical_address(static_cast<std::uint16_t>(position + 1), datagram.ado());
    return position == 0;
  };
  const auto at_station = [&datagram, this] {
    const std::uint16_t station = datagram.adp();
    return station == station_address_ || (alias_enabled_ && station == station_alias_);
  };
  const auto write_address = [&datagram, this] {
    const auto offset = base::load_le<std::uint16_t>(registers(), kReadWriteOffset);
    return static_cast<std::uint16_t>(datagram.ado() + offset);
  };
  switch (datagram.command) {
    case Command::aprd:
      if (at_position()) {
        read_datagram(datagram, false);
      }
      break;
    case Command::apwr:
      if (at_position()) {
        write_datagram(datagram);
      }
      break;
    case Command::aprw:
      if (at_position()) {
        exchange_datagram(datagram, false, write_address());
      }
      break;
    case Command::fprd:
      if (at_station()) {
        read_datagram(datagram, false);
      }
      break;
    case Command::fpwr:
      if (at_station()) {
        write_datagram(datagram);
      }
      break;
    case Command::fprw:
      if (at_station()) {
        exchange_datagram(datagram, false, write_address());
      }
      break;
    case Command::brd:
      static_cast<void>(at_position());
      read_datagram(datagram, true);
      break;
    case Command::bwr:
      static_cast<void>(at_position());
      write_datagram(datagram);
      break;
    case Command::brw:
      static_cast<void>(at_position());
      exchange_datagram(datagram, true, datagram.ado());
      break;
    case Command::armw:
      if (at_position()) {
        read_datagram(datagram, false);
      } else {
        write_datagram(datagram);
      }
      break;
    case Command::frmw:
      if (at_station()) {
        read_datagram(datagram, false);
      } else {
        write_datagram(datagram);
      }
      break;
    default:
      break;
  }
}

void SlaveController::read_datagram(DatagramView& datagram, bool broadcast) {
  if (!broadcast) {
    add(datagram, read_memory(Side::bus, datagram.ado(), datagram.bytes()) ? 1 : 0);
    return;
  }
  // Broadcast reads OR, so that the master sees what any slave has set.
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): too long to clear for each datagram
  std::array<std::byte, 0x800> own;
  const std::span<std::byte> bytes = std::span(own).first(datagram.length);
  std::fill(bytes.begin(), bytes.end(), std::byte{0});
  if (read_memory(Side::bus, datagram.ado(), bytes)) {
    std::transform(bytes.begin(), bytes.end(), datagram.data, datagram.data,
                   [](std::byte mine, std::byte theirs) { return mine | theirs; });
    add(datagram, 1);
  }
}

void SlaveController::write_datagram(DatagramView& datagram) {
  if (write_memory(Side::bus, datagram.ado(), datagram.bytes())) {
    add(datagram, 1);
  } else if (datagram.ado() == kAlControl && datagram.length >= 2 && !al_control_taken_) {
    report_unanswered_al_control(base::load_le<std::uint16_t>(datagram.data), true);
  }
}

void SlaveController::exchange_datagram(DatagramView& datagram, bool broadcast,
                                        std::uint16_t write_address) {
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): too long to clear for each datagram
  std::array<std::byte, 0x800> incoming;
  const std::span<std::byte> bytes = std::span(incoming).first(datagram.length);
  std::copy(datagram.bytes().begin(), datagram.bytes().end(), bytes.begin());
  read_datagram(datagram, broadcast);
  add(datagram, write_memory(Side::bus, write_address, bytes) ? 2 : 0);
}

void SlaveController::begin_frame_work() {
  if ((frame_work_ & FrameWork::kClearWriteEnables) != 0) {
    frame_work_ &= static_cast<std::uint8_t>(~FrameWork::kClearWriteEnables);
    sii_.start_of_frame();
    if (has_feature(configuration_.features, ControllerFeature::mii_management)) {
      mii_.start_of_frame();
    }
  }
}

void SlaveController::end_frame_work(const FrameTiming& timing) {
  // What stays for the next frame: the write enable to clear, a reset key under way.
  const std::uint8_t work = frame_work_;
  frame_work_ = work & FrameWork::kClearWriteEnables;
  if ((work & FrameWork::kLockRegisters) != 0) {
    registers_unlocked_ = false;
    controller_unlocked_ = false;
  }
  if ((work & FrameWork::kLatchReceiveTimes) != 0) {
    clock_unit_.latch_receive_times(timing);
  }
  if ((work & FrameWork::kCompareSystemTime) != 0) {
    take_clock_work(clock_unit_.compare(timing, now_));
  }
  if ((work & FrameWork::kTakeStartTime) != 0) {
    take_clock_work(clock_unit_.finish_start_time(now_));
  }
  if ((work & FrameWork::kApplyLoopControl) != 0) {
    apply_loop_control();
  }
  if ((work & FrameWork::kResetKey) != 0) {
    reset_sequence_.end_of_frame();
    if (reset_sequence_.complete(Side::bus)) {
      request_reset(Side::bus);
    } else if (reset_sequence_.bus_under_way()) {
      frame_work_ |= FrameWork::kResetKey;
    }
  }
}

}  // namespace stator::ethercat
