#include "stator/master/bus.hpp"

#include <algorithm>
#include <vector>

#include "stator/master/text.hpp"

namespace stator::master {

namespace {

// A port that hands out foreign frames without letting time pass must not hold the master for ever.
constexpr int kMaximumForeignFrames = 256;

}  // namespace

std::string Station::name() const {
  return "slave " + std::to_string(position) + " (station " + hexadecimal(address, 4) + ")";
}

Result<void> Bus::exchange(std::span<Datagram> datagrams, int retries) {
  for (int round = 0; round <= retries; ++round) {
    const auto answered = attempt(datagrams);
    if (!answered) {
      return base::Unexpected{answered.error()};
    }
    if (*answered) {
      return {};
    }
  }
  const auto milliseconds = options_.frame_timeout.nanoseconds() / 1'000'000;
  return fail(ErrorCode::timeout,
              "no frame came back within " + std::to_string(milliseconds) + " ms, sent " +
                  std::to_string(retries + 1) +
                  " time(s); check cable, interface and that the slaves are switched on");
}

/// True if the answer came within the frame timeout.
Result<bool> Bus::attempt(std::span<Datagram> datagrams) {
  ++index_;
  ethercat::FrameBuilder builder(frame_, options_.source_mac);
  for (const Datagram& datagram : datagrams) {
    if (!builder.append(datagram.command, index_, datagram.address, datagram.data)) {
      return fail(ErrorCode::argument, "datagrams do not fit into one Ethernet frame");
    }
  }
  std::span<const std::byte> frame = builder.finish(true);
  const base::SimTime deadline = port_.now() + options_.frame_timeout;
  for (int foreign = 0; foreign < kMaximumForeignFrames; ++foreign) {
    const auto remaining = std::max(deadline - port_.now(), base::SimDuration(0));
    const auto length = port_.exchange(frame, answer_, remaining);
    if (!length) {
      return base::Unexpected{length.error()};
    }
    if (*length == 0) {
      return false;
    }
    if (take_answer(std::span(answer_).first(std::min(*length, answer_.size())), datagrams)) {
      return true;
    }
    frame = {};
  }
  return false;
}

/// Copies data and working counters out of `frame` if it is the answer to `datagrams`. Anything
/// else (a late answer, a duplicate, another master's frame, a damaged one) is left alone.
bool Bus::take_answer(std::span<std::byte> frame, std::span<Datagram> datagrams) const {
  const auto matches = [this](const ethercat::DatagramView& view, const Datagram& datagram) {
    return view.index == index_ && view.command == datagram.command &&
           view.length == datagram.data.size();
  };
  ethercat::DatagramCursor check(frame);
  for (const Datagram& datagram : datagrams) {
    const auto view = check.next();
    if (!view || !matches(*view, datagram)) {
      return false;
    }
  }
  ethercat::DatagramCursor cursor(frame);
  for (Datagram& datagram : datagrams) {
    const auto view = cursor.next();
    std::copy_n(view->data, view->length, datagram.data.data());
    datagram.working_counter = view->working_counter;
  }
  return true;
}

Result<std::uint16_t> Bus::execute(ethercat::Command command, std::uint32_t address,
                                   std::span<std::byte> data) {
  Datagram datagram{.command = command, .address = address, .data = data};
  if (const auto done = exchange(std::span(&datagram, 1), options_.frame_retries); !done) {
    return base::Unexpected{done.error()};
  }
  return datagram.working_counter;
}

Result<void> Bus::read(const Station& station, std::uint16_t address, std::span<std::byte> out) {
  const auto counter =
      execute(ethercat::Command::fprd, ethercat::physical_address(station.address, address), out);
  if (!counter) {
    return base::Unexpected{counter.error()};
  }
  if (*counter != 1) {
    return fail(ErrorCode::working_counter,
                "reading " + hexadecimal(address, 4) + " of " + station.name() +
                    ": working counter " + std::to_string(*counter) +
                    " instead of 1; the slave is off, was replaced or restarted: scan again");
  }
  return {};
}

Result<void> Bus::write(const Station& station, std::uint16_t address,
                        std::span<const std::byte> data) {
  std::vector<std::byte> copy(data.begin(), data.end());
  const auto counter =
      execute(ethercat::Command::fpwr, ethercat::physical_address(station.address, address), copy);
  if (!counter) {
    return base::Unexpected{counter.error()};
  }
  if (*counter != 1) {
    return fail(ErrorCode::working_counter,
                "writing " + hexadecimal(address, 4) + " of " + station.name() +
                    ": working counter " + std::to_string(*counter) +
                    " instead of 1; the slave is off, was restarted or does not allow it now");
  }
  return {};
}

Result<void> Bus::broadcast(std::uint16_t address, std::span<const std::byte> data) {
  std::vector<std::byte> copy(data.begin(), data.end());
  const auto counter =
      execute(ethercat::Command::bwr, ethercat::physical_address(0, address), copy);
  return counter ? Result<void>() : Result<void>(base::Unexpected{counter.error()});
}

}  // namespace stator::master
