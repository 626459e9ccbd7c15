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

std::string to_text(const Silence& silence) {
  const std::string lasted = std::to_string(silence.duration.nanoseconds() / 1'000'000) +
                             " ms, sent " + std::to_string(silence.frames) + " time(s)";
  if (silence.late != 0) {
    return "no frame came back in time for " + lasted + ", but " + std::to_string(silence.late) +
           " came too late: the machine that runs the slaves, or this master, is too busy; give "
           "them a processor or priority of their own, or wait longer for each frame (--timeout)";
  }
  return "no frame came back for " + lasted +
         ": the link is down, the slaves are off, or the machine that runs them is too busy; check "
         "cable, interface and that the slaves are switched on, and of a virtual rack whether it "
         "tells of overruns";
}

Result<void> Bus::exchange(std::span<Datagram> datagrams, int retries) {
  const base::SimTime begin = port_.now();
  const std::uint64_t late_before = late_answers_;
  std::uint64_t sent = 0;
  bool patient = false;
  do {
    const base::SimTime before = port_.now();
    const auto answered = attempt(datagrams);
    if (!answered) {
      return base::Unexpected{answered.error()};
    }
    if (*answered) {
      return {};
    }
    ++sent;
    // Where foreign frames come so fast that no time passes, patience would have no end.
    const base::SimTime now = port_.now();
    patient = retries > 0 && now > before && now - begin < options_.patience;
  } while (patient || sent <= static_cast<std::uint64_t>(retries));
  return fail(ErrorCode::timeout, to_text(Silence{.duration = port_.now() - begin,
                                                  .frames = sent,
                                                  .late = late_answers_ - late_before}));
}

/// True if the answer came within the frame timeout.
Result<bool> Bus::attempt(std::span<Datagram> datagrams) {
  ++index_;
  unanswered_.reset(index_);
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
      break;
    }
    const auto answer = std::span(answer_).first(std::min(*length, answer_.size()));
    if (take_answer(answer, datagrams)) {
      return true;
    }
    count_if_late(answer);
    frame = {};
  }
  unanswered_.set(index_);
  return false;
}

void Bus::count_if_late(std::span<std::byte> frame) {
  const auto first = ethercat::DatagramCursor(frame).next();
  if (first && unanswered_.test(first->index)) {
    unanswered_.reset(first->index);
    ++late_answers_;
  }
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
