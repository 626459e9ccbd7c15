#include "stator/rack/observe/pin_trace.hpp"

#include <algorithm>
#include <chrono>
#include <set>
#include <span>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "stator/board/assembly/board.hpp"
#include "stator/mfc/block/block.hpp"
#include "stator/mfc/pins/signal.hpp"
#include "stator/settings/words.hpp"

namespace stator::rack {

namespace {

using board::Line;
using board::TraceRecord;

/// How long the writer sleeps between two looks into the queue.
constexpr std::chrono::milliseconds kWritePeriod{20};

std::uint32_t bit(Line line) {
  return std::uint32_t{1} << line;
}

/// Lines that something is wired to; without a board all.
std::uint32_t wired_lines(const board::BoardConfiguration& configuration) {
  std::uint32_t lines = 0;
  for (const board::PeripheralConfiguration& peripheral : configuration.peripherals) {
    for (const Line line : peripheral.lines) {
      lines |= line < board::kLines ? bit(line) : 0U;
    }
  }
  return lines != 0 ? lines : (std::uint32_t{1} << board::kLines) - 1;
}

Line line_of(const std::string& name) {
  for (Line line = 0; line < board::kLines; ++line) {
    if (board::line_name(line) == name) {
      return line;
    }
  }
  std::set<std::string> names;
  for (Line line = 0; line < board::kLines; ++line) {
    names.insert(board::line_name(line));
  }
  const std::string guess = settings::closest_match(name, names);
  throw std::runtime_error(fmt::format(
      "there is no pin \"{}\" to trace{}; the pins are: {}", name,
      guess.empty() ? "" : fmt::format(" (did you mean \"{}\"?)", guess), fmt::join(names, ", ")));
}

/// Lines of the converter, which changes 50 million times a second: they are traced when asked for.
std::uint32_t converter_lines(const mfc::Block& block) {
  std::uint32_t lines = 0;
  for (Line line = 0; line < board::kLines; ++line) {
    lines |= block.signal(line) == mfc::Signal::dac0 ? bit(line) : 0U;
  }
  return lines;
}

std::uint32_t traced_lines(const product::TracedPins& pins,
                           const TraceConfiguration& configuration) {
  std::uint32_t lines = 0;
  for (const std::string& pin : configuration.pins) {
    lines |= bit(line_of(pin));
  }
  return lines != 0 ? lines : wired_lines(pins.wiring) & ~converter_lines(pins.block);
}

/// The buses among `lines`, as the crossbar leads to them now.
board::DecodedLines decoded_lines(const mfc::Block& block, std::uint32_t lines) {
  board::DecodedLines decoded;
  for (Line line = 0; line < board::kLines; ++line) {
    if ((lines & bit(line)) == 0) {
      continue;
    }
    const mfc::Signal signal = block.signal(line);
    if (signal == mfc::Signal::sck) {
      decoded.spi_sck = line;
    } else if (signal == mfc::Signal::sdo) {
      decoded.spi_mosi = line;
    } else if (signal == mfc::Signal::sdi) {
      decoded.spi_miso = line;
    } else if (signal == mfc::Signal::cs0) {
      decoded.spi_cs = line;
    } else if (signal == mfc::Signal::scl) {
      decoded.i2c_scl = line;
    } else if (signal == mfc::Signal::sda) {
      decoded.i2c_sda = line;
    }
  }
  return decoded;
}

/// "MFCIO04_axis_step"; blanks and dots mean something to those who read the file.
std::array<std::string, board::kLines> line_names(const board::BoardConfiguration& configuration) {
  std::array<std::string, board::kLines> names;
  for (Line line = 0; line < board::kLines; ++line) {
    names[line] = board::line_name(line);
  }
  for (const board::PeripheralConfiguration& peripheral : configuration.peripherals) {
    for (std::size_t pin = 0; pin < peripheral.lines.size(); ++pin) {
      if (peripheral.lines[pin] < board::kLines) {
        names[peripheral.lines[pin]] +=
            fmt::format("_{}_{}", peripheral.name, peripheral.type->pins[pin].name);
      }
    }
  }
  for (std::string& name : names) {
    std::ranges::replace_if(
        name, [](char letter) { return letter == ' ' || letter == '.'; }, '_');
  }
  return names;
}

}  // namespace

PinTrace::PinTrace(const product::TracedPins& pins, const TraceConfiguration& configuration,
                   ClockKind clock)
    : waits_(clock == ClockKind::lockstep),
      trace_(traced_lines(pins, configuration),
             decoded_lines(pins.block, traced_lines(pins, configuration)), 1,
             board::LogicTrace::Sink::bind<&PinTrace::take>(*this)),
      format_(pins.name, trace_, line_names(pins.wiring)),
      queue_(configuration.queue) {
  auto output = link::BackgroundOutput::create(configuration.file,
                                               std::as_bytes(std::span(format_.header())));
  if (!output) {
    throw std::runtime_error("trace: " + output.error().text +
                             "; check the path and its permissions");
  }
  output_ = std::move(*output);
  thread_ = std::thread([this] { run(); });
  pins.board.trace(trace_);
}

PinTrace::~PinTrace() {
  output_->stop_waiting();
  finish({});
}

void PinTrace::take(std::span<const TraceRecord> records) {
  for (const TraceRecord& record : records) {
    while (waits_ && room() == 0 && !finished_) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    // Not before the queue has half emptied, so that gaps are few.
    if (lost_ != 0 && room() >= queue_.size() / 2) {
      resume(record.time);
    }
    if (finished_ || lost_ != 0 || room() == 0) {
      drop(record);
    } else {
      push(record);
    }
  }
}

void PinTrace::drop(const TraceRecord& record) {
  ++dropped_;
  if (record.kind == TraceRecord::Kind::low || record.kind == TraceRecord::Kind::high) {
    if (lost_ == 0) {
      lost_since_ = record.time;
    }
    lost_ |= bit(record.channel);
    levels_[record.channel] = record.kind == TraceRecord::Kind::high;
  }
}

// When the lost edges were is not known: each line concerned is written as unknown from its first
// lost edge on, and from now on with the level that its last lost edge left.
void PinTrace::resume(base::SimTime now) {
  for (const bool known : {false, true}) {
    for (Line line = 0; line < board::kLines; ++line) {
      if ((lost_ & bit(line)) != 0) {
        TraceRecord record;
        record.time = known ? now : lost_since_;
        record.channel = line;
        record.kind = !known          ? TraceRecord::Kind::unknown
                      : levels_[line] ? TraceRecord::Kind::high
                                      : TraceRecord::Kind::low;
        push(record);
      }
    }
  }
  lost_ = 0;
}

void PinTrace::push(const TraceRecord& record) {
  const std::size_t place = pushed_.load(std::memory_order_relaxed);
  queue_[place % queue_.size()] = record;
  pushed_.store(place + 1, std::memory_order_release);
}

void PinTrace::run() {
  std::unique_lock lock(mutex_);
  while (!ending_) {
    changed_.wait_for(lock, kWritePeriod);
    lock.unlock();
    write_waiting();
    lock.lock();
  }
}

void PinTrace::write_waiting() {
  constexpr std::size_t kPiece = 4096;
  std::size_t next = popped_.load(std::memory_order_relaxed);
  const std::size_t end = pushed_.load(std::memory_order_acquire);
  while (next != end) {
    const std::size_t length = std::min({end - next, queue_.size() - next % queue_.size(), kPiece});
    text_.clear();
    format_.append(text_, std::span(queue_).subspan(next % queue_.size(), length));
    next += length;
    popped_.store(next, std::memory_order_release);
    output_->write(text_);
    written_ += length;
  }
}

void PinTrace::finish(base::SimTime now, link::BackgroundOutput::Clock::time_point asked) {
  if (std::exchange(finished_, true)) {
    return;
  }
  trace_.flush();
  {
    const std::scoped_lock lock(mutex_);
    ending_ = true;
  }
  changed_.notify_one();
  thread_.join();
  write_waiting();
  if (lost_ != 0) {
    resume(std::max(now, lost_since_));
    write_waiting();
  }
  text_.clear();
  format_.finish(text_, now);
  output_->write(text_);
  output_->finish(asked);
}

}  // namespace stator::rack
