#include "stator/replay/player.hpp"

#include <algorithm>
#include <bit>
#include <deque>
#include <span>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "stator/dictionary/dictionary.hpp"
#include "stator/ethercat/standard/frame.hpp"
#include "stator/product/device/device.hpp"
#include "stator/rack/file/fault_section.hpp"
#include "stator/rack/networks/can_network.hpp"
#include "stator/rack/networks/serial_line.hpp"
#include "stator/rack/observe/journal.hpp"
#include "stator/replay/session_recorder.hpp"
#include "stator/replay/step_text.hpp"

namespace stator::replay {

/// What a serial line has sent to programs, as long as it was not compared. Each line has its own:
/// they are other cables, and earlier versions had the answers of several in another order.
class Player::LineOutput {
 public:
  void take(std::span<const std::byte> bytes) { waiting_.emplace_back(bytes.begin(), bytes.end()); }
  [[nodiscard]] const std::vector<std::byte>* first() const {
    return waiting_.empty() ? nullptr : &waiting_.front();
  }
  void pop() { waiting_.pop_front(); }

 private:
  std::deque<std::vector<std::byte>> waiting_;
};

Player::Player(RecordingReader& recording, rack::Rack& rack,
               const rack::RackConfiguration& configuration)
    : recording_(recording),
      rack_(rack),
      configuration_(configuration),
      signals_(rack.signals()),
      values_(signals_.size()) {
  if (names_of(signals_) != recording.header().signal_names) {
    throw std::runtime_error(fmt::format(
        "the rack has other signals than the recorded one ({} instead of {}); the recording is of "
        "program version {}: replay it with that",
        signals_.size(), recording.header().signal_names.size(), recording.header().program));
  }
  for (const rack::BusConfiguration& bus : configuration.buses) {
    port_counts_.push_back(bus.wire ? bus.ports.size() : 0);
  }
  if (rack::DeviceStorage* storage = rack.storage(); storage != nullptr) {
    completions_before_ = storage->completions();
    storage->set_completions(recording.header().version == kOldestVersion
                                 ? rack::DeviceStorage::Completions::at_once
                                 : rack::DeviceStorage::Completions::recorded);
  }
  attach_ports();
  for (std::size_t line = 0; line < rack.line_count(); ++line) {
    lines_.push_back(std::make_unique<LineOutput>());
    rack.line(line).connect(rack::SerialLine::Output::bind<&LineOutput::take>(*lines_.back()));
  }
}

Player::~Player() {
  detach_ports();
  if (rack_.storage() != nullptr) {
    rack_.storage()->set_completions(completions_before_);
  }
  for (std::size_t line = 0; line < lines_.size(); ++line) {
    rack_.line(line).connect({});
  }
}

void Player::attach_ports() {
  ports_.resize(port_counts_.size());
  for (std::size_t bus = 0; bus < port_counts_.size(); ++bus) {
    for (std::size_t i = 0; i < port_counts_[bus]; ++i) {
      ports_[bus].push_back(std::make_unique<can::Port>());
      ports_[bus].back()->set_hears_errors(true);
      rack_.bus(bus).add(*ports_[bus].back());
    }
  }
}

void Player::detach_ports() {
  for (std::size_t bus = 0; bus < ports_.size(); ++bus) {
    for (const auto& port : ports_[bus]) {
      rack_.bus(bus).remove(*port);
    }
  }
  ports_.clear();
}

std::optional<Difference> Player::play(base::SimTime until, const std::string& mark) {
  at_mark_ = false;
  while (!difference_) {
    if (!std::exchange(step_waits_, false) && !recording_.next(step_)) {
      if (recording_.ending() == RecordingEnding::finished) {
        static_cast<void>(require_quiet_lines());
      }
      break;
    }
    if (step_.time > until) {
      step_waits_ = true;
      break;
    }
    now_ = step_.time;
    ++counts_.steps;
    do_step();
    if (step_.kind == StepKind::mark && !mark.empty() && step_.name == mark) {
      at_mark_ = true;
      break;
    }
  }
  return difference_;
}

void Player::do_step() {
  // Those that only compare may stand between a call and the bytes that came out in it: earlier
  // versions recorded them in this order when they went back.
  const bool compares = step_.kind == StepKind::bytes_leave || step_.kind == StepKind::signals ||
                        step_.kind == StepKind::frame_leaves;
  if (!compares && !require_quiet_lines()) {
    return;
  }
  const auto in = [](std::size_t index, std::size_t size) {
    if (index >= size) {
      throw std::runtime_error("the recording is of another rack: it has more networks");
    }
    return index;
  };
  switch (step_.kind) {
    case StepKind::advance:
      rack_.advance(step_.time);
      break;
    case StepKind::frame_comes:
      ++counts_.frames;
      frame_ = step_.bytes;
      exit_ = rack_.process_frame(in(step_.network, rack_.segment_count()), frame_, step_.time,
                                  step_.interface);
      break;
    case StepKind::frame_leaves:
      compare_frame();
      break;
    case StepKind::bus_events:
      rack_.handle_bus_events(in(step_.network, rack_.segment_count()), step_.time);
      break;
    case StepKind::carrier:
      rack_.set_carrier(in(step_.network, rack_.segment_count()), step_.interface, step_.up,
                        step_.time);
      break;
    case StepKind::can_frame_comes: {
      ++counts_.can_frames;
      auto& ports = ports_[in(step_.network, ports_.size())];
      static_cast<void>(rack_.put(step_.network, step_.port, *ports[in(step_.port, ports.size())],
                                  step_.can.frame));
      break;
    }
    case StepKind::can_frame_leaves:
      in(step_.port, ports_[in(step_.network, ports_.size())].size());
      compare_can_frame();
      break;
    case StepKind::ports_replaced:
      if (rack::Journal* journal = rack_.journal(); journal != nullptr) {
        journal->ports_replaced();
      }
      detach_ports();
      attach_ports();
      break;
    case StepKind::bytes_come:
      counts_.bytes += step_.bytes.size();
      rack_.put(in(step_.network, rack_.line_count()), step_.bytes, step_.time);
      break;
    case StepKind::bytes_leave:
      compare_bytes();
      break;
    case StepKind::event:
      rack_.apply(*step_.event, step_.time);
      break;
    case StepKind::release:
      in(step_.network, rack_.segment_count());
      release();
      break;
    case StepKind::fault:
      inject();
      break;
    case StepKind::fault_cleared:
      static_cast<void>(rack_.clear_faults(step_.fault, step_.time));
      break;
    case StepKind::completion:
      if (!rack_.complete(step_.completion, step_.time)) {
        throw std::runtime_error("the recording is of another rack: it keeps more in files");
      }
      break;
    case StepKind::object_read:
    case StepKind::object_written:
      access_object();
      break;
    case StepKind::signals:
      compare_signals();
      break;
    case StepKind::mark:
      if (rack::Journal* journal = rack_.journal(); journal != nullptr) {
        journal->mark(step_.name);
      }
      break;
    case StepKind::end:
      break;
  }
}

void Player::release() {
  frame_.resize(ethercat::kMaximumFrameLength);
  const auto released = rack_.release_frame(step_.network, step_.time, frame_);
  exit_ = released ? std::optional(released->exit) : std::nullopt;
  frame_.resize(released ? released->length : 0);
}

void Player::inject() {
  try {
    static_cast<void>(rack_.inject(rack::parse_fault(step_.name, configuration_), step_.time));
  } catch (const std::runtime_error& error) {
    throw std::runtime_error("the recording has a fault that this rack cannot have: " +
                             std::string(error.what()));
  }
}

void Player::differ(std::string place, std::string expected, std::string got) {
  difference_ =
      Difference{step_.number, step_.time, std::move(place), std::move(expected), std::move(got)};
}

void Player::compare_frame() {
  if (exit_ == step_.exit && (!exit_ || std::ranges::equal(frame_, step_.bytes))) {
    return;
  }
  const auto [expected, got] = explain_frames({step_.exit, step_.bytes}, {exit_, frame_});
  differ(fmt::format("EtherCAT frame {}", counts_.frames), expected, got);
}

void Player::compare_can_frame() {
  can::Port& port = *ports_[step_.network][step_.port];
  const auto got = rack_.take(step_.network, step_.port, port);
  if (got && got->frame == step_.can.frame && got->time == step_.can.time &&
      got->destroyed == step_.can.destroyed) {
    return;
  }
  differ(fmt::format("{}, port {}", rack_.bus(step_.network).name(), step_.port),
         to_text(step_.can), got ? to_text(*got) : "no frame");
}

void Player::compare_bytes() {
  if (step_.network >= lines_.size()) {
    throw std::runtime_error("the recording is of another rack: it has more networks");
  }
  LineOutput& line = *lines_[step_.network];
  if (line.first() != nullptr && *line.first() == step_.bytes) {
    line.pop();
    return;
  }
  differ(fmt::format("serial line {}", step_.network), to_hex(step_.bytes),
         line.first() == nullptr ? "nothing" : to_hex(*line.first()));
}

bool Player::require_quiet_lines() {
  for (std::size_t line = 0; line < lines_.size(); ++line) {
    if (const auto* bytes = lines_[line]->first(); bytes != nullptr) {
      differ(fmt::format("serial line {}", line), "nothing", to_hex(*bytes));
      return false;
    }
  }
  return true;
}

void Player::compare_signals() {
  for (const auto& [index, value] : step_.values) {
    if (index >= values_.size()) {
      throw std::runtime_error("the recording is of another rack: it has more signals");
    }
    values_[index] = value;
  }
  for (std::size_t i = 0; i < signals_.size(); ++i) {
    const double got = signals_[i].read();
    if (std::bit_cast<std::uint64_t>(got) != std::bit_cast<std::uint64_t>(values_[i])) {
      differ("signal " + signals_[i].name, fmt::format("{} {}", values_[i], signals_[i].unit),
             fmt::format("{} {}", got, signals_[i].unit));
      return;
    }
  }
}

void Player::access_object() {
  dictionary::Entry* entry = nullptr;
  if (exists(step_.device)) {
    const dictionary::Dictionary* objects = rack_.device(step_.device).object_dictionary();
    entry = objects != nullptr ? objects->find(step_.index, step_.subindex) : nullptr;
  }
  if (entry == nullptr) {
    throw std::runtime_error(
        fmt::format("the recording is of another rack: {:04X}h:{:02X} is not there", step_.index,
                    step_.subindex));
  }
  if (step_.kind == StepKind::object_written) {
    static_cast<void>(rack_.write_object(step_.device, *entry, step_.bytes, step_.time));
  } else {
    std::vector<std::byte> value;
    static_cast<void>(rack_.read_object(step_.device, *entry, value));
  }
}

bool Player::exists(rack::DeviceAddress device) {
  const auto all = rack_.addresses();
  return std::ranges::find(all, device) != all.end();
}

}  // namespace stator::replay
