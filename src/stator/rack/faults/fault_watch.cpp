#include "stator/rack/faults/fault_watch.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <utility>

#include "stator/ethercat/segment/segment.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"
#include "stator/master/cia402/drive_state.hpp"
#include "stator/product/device/device.hpp"
#include "stator/rack/networks/can_network.hpp"

namespace stator::rack {

namespace {

std::string_view network_state_name(unsigned al_status) {
  switch (al_status & 0x0FU) {
    case 1:
      return "init";
    case 2:
      return "pre-operational";
    case 4:
      return "safe-operational";
    case 8:
      return "operational";
    default:
      return "";
  }
}

/// "Operation enabled" as a rack file writes it.
std::string power_state_name(master::DriveState state) {
  std::string name(master::to_text(state));
  for (char& letter : name) {
    letter = letter == ' ' ? '-' : static_cast<char>(letter | 0x20);
  }
  return name;
}

product::Signal signal_of(faults::Target& target, const Milestone& milestone) {
  for (const product::Signal& signal : target.device(milestone.device).signals()) {
    if (signal.name == milestone.signal) {
      return signal;
    }
  }
  throw std::runtime_error(target.name_of(milestone.device) + " has no signal \"" +
                           milestone.signal + "\" to wait for");
}

class NetworkStateWatch final : public FaultWatch {
 public:
  NetworkStateWatch(faults::Target& target, Milestone milestone)
      : target_(target), milestone_(std::move(milestone)) {}

  [[nodiscard]] bool reached() override {
    const DeviceAddress device = milestone_.device;
    if (!target_.powered(device)) {
      return false;
    }
    if (device.kind == NetworkKind::bus) {
      const bool operational =
          target_.network_state(device) == dictionary::NetworkState::operational;
      return milestone_.state == (operational ? "operational" : "pre-operational");
    }
    std::array<std::byte, 1> status{};
    target_.segment(device.network)
        .slave(device.device)
        .peek(ethercat::register_address::kAlStatus, status);
    return network_state_name(std::to_integer<unsigned>(status[0])) == milestone_.state;
  }

 private:
  faults::Target& target_;
  Milestone milestone_;
};

class PowerStateWatch final : public FaultWatch {
 public:
  PowerStateWatch(product::Signal statusword, std::string state)
      : statusword_(std::move(statusword)), state_(std::move(state)) {}

  [[nodiscard]] bool reached() override {
    const auto state = master::drive_state(static_cast<std::uint16_t>(statusword_.read()));
    return state && power_state_name(*state) == state_;
  }

 private:
  product::Signal statusword_;
  std::string state_;
};

/// A signal passes a value, in either direction.
class CrossingWatch final : public FaultWatch {
 public:
  CrossingWatch(product::Signal signal, double value) : signal_(std::move(signal)), value_(value) {}

  [[nodiscard]] bool reached() override {
    const bool above = signal_.read() >= value_;
    const bool crossed = above_ && *above_ != above;
    above_ = above;
    return crossed;
  }

 private:
  product::Signal signal_;
  double value_;
  std::optional<bool> above_{};
};

/// Steps of mailbox transfers.
class MailboxWatch final : public FaultWatch {
 public:
  explicit MailboxWatch(Milestone milestone) : milestone_(std::move(milestone)) {}

  [[nodiscard]] bool reached() override { return reached_; }
  void see(const MailboxStep& step) override {
    using enum Milestone::Kind;
    const auto& wanted = milestone_.object;
    if (wanted &&
        !(step.object && wanted->matches(step.object->index, step.object->subindex.value_or(0)))) {
      return;
    }
    if (milestone_.kind == segment) {
      reached_ = reached_ || step.segment == milestone_.count;
      return;
    }
    if (milestone_.kind == sdo && step.segment != 0) {
      return;
    }
    reached_ = reached_ || ++seen_ == milestone_.count;
  }

 private:
  Milestone milestone_;
  std::uint64_t seen_ = 0;
  bool reached_ = false;
};

}  // namespace

/// Counts healthy cycles in a row on behalf of the watches of one segment.
class FaultWatches::SegmentTap final : public ethercat::FrameObserver {
 public:
  explicit SegmentTap(ethercat::Segment& segment) : segment_(segment) { segment_.observe(this); }
  ~SegmentTap() override { segment_.observe(nullptr); }

  void frame_passed(std::span<const ethercat::DatagramView> datagrams, bool answered,
                    base::SimTime /*arrival*/) override {
    const auto logical =
        std::ranges::find_if(datagrams, [](const ethercat::DatagramView& datagram) {
          return ethercat::is_logical(datagram.command);
        });
    if (logical == datagrams.end() || !cycles_.opens({logical->command, logical->address})) {
      return;
    }
    const bool counted = std::ranges::all_of(datagrams, [](const ethercat::DatagramView& datagram) {
      return !ethercat::is_logical(datagram.command) || datagram.working_counter != 0;
    });
    ++cycle_;
    healthy_ = answered && counted;
  }

  [[nodiscard]] std::uint64_t cycle() const { return cycle_; }
  [[nodiscard]] bool healthy() const { return healthy_; }

 private:
  ethercat::Segment& segment_;
  CycleRecognition cycles_;
  std::uint64_t cycle_ = 0;
  bool healthy_ = false;
};

class FaultWatches::BusTap {
 public:
  explicit BusTap(CanNetwork& network) : network_(network) {
    network_.observe(base::Delegate<void(const can::TraceEntry&)>::bind<&BusTap::see>(*this));
  }
  ~BusTap() { network_.observe({}); }
  BusTap(const BusTap&) = delete;
  BusTap& operator=(const BusTap&) = delete;

  /// Frames with the identifier that have passed since the first call for that identifier.
  [[nodiscard]] std::uint64_t passed(std::uint32_t identifier) { return counts_[identifier]; }

 private:
  void see(const can::TraceEntry& entry) {
    const auto count = counts_.find(entry.frame.identifier);
    if (entry.kind == can::TraceEntry::Kind::frame && count != counts_.end()) {
      ++count->second;
    }
  }

  CanNetwork& network_;
  std::map<std::uint32_t, std::uint64_t> counts_;
};

class FaultWatches::CycleWatch final : public FaultWatch {
 public:
  CycleWatch(SegmentTap& tap, std::unique_ptr<FaultWatch> operational, std::uint64_t count)
      : tap_(tap), operational_(std::move(operational)), count_(count), seen_(tap.cycle()) {}

  // Asked after each frame, so no cycle is missed.
  [[nodiscard]] bool reached() override {
    if (tap_.cycle() == seen_) {
      return false;
    }
    seen_ = tap_.cycle();
    healthy_ = tap_.healthy() && operational_->reached() ? healthy_ + 1 : 0;
    return healthy_ >= count_;
  }

 private:
  SegmentTap& tap_;
  std::unique_ptr<FaultWatch> operational_;
  std::uint64_t count_;
  std::uint64_t seen_;
  std::uint64_t healthy_ = 0;
};

class FaultWatches::FrameWatch final : public FaultWatch {
 public:
  FrameWatch(BusTap& tap, std::uint32_t identifier, std::uint64_t count)
      : tap_(tap), identifier_(identifier), target_(tap.passed(identifier) + count) {}

  [[nodiscard]] bool reached() override { return tap_.passed(identifier_) >= target_; }

 private:
  BusTap& tap_;
  std::uint32_t identifier_;
  std::uint64_t target_;
};

FaultWatches::FaultWatches(faults::Target& target) : target_(target) {}

FaultWatches::~FaultWatches() = default;

void FaultWatches::rest() {
  segments_.clear();
  buses_.clear();
}

std::unique_ptr<FaultWatch> FaultWatches::make(const Milestone& milestone) {
  using enum Milestone::Kind;
  const std::size_t network = milestone.device.network;
  const bool on_bus = milestone.device.kind == NetworkKind::bus;
  switch (milestone.kind) {
    case cycles:
    case frame: {
      if (on_bus) {
        auto& tap = buses_[network];
        if (tap == nullptr) {
          tap = std::make_unique<BusTap>(target_.bus(network));
        }
        return std::make_unique<FrameWatch>(
            *tap, milestone.kind == cycles ? LockstepClock::kSyncIdentifier : milestone.identifier,
            milestone.count);
      }
      auto& tap = segments_[network];
      if (tap == nullptr) {
        tap = std::make_unique<SegmentTap>(target_.segment(network));
      }
      Milestone operational = milestone;
      operational.state = "operational";
      return std::make_unique<CycleWatch>(
          *tap, std::make_unique<NetworkStateWatch>(target_, operational), milestone.count);
    }
    case message:
    case sdo:
    case segment:
      return std::make_unique<MailboxWatch>(milestone);
    case network_state:
      return std::make_unique<NetworkStateWatch>(target_, milestone);
    case power_state:
      return std::make_unique<PowerStateWatch>(signal_of(target_, milestone), milestone.state);
    case signal:
      return std::make_unique<CrossingWatch>(signal_of(target_, milestone), milestone.value);
  }
  throw std::runtime_error("a milestone without watch");
}

}  // namespace stator::rack
