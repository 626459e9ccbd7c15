// Cost of the frame path: one cyclic LRW frame sequence over a line of drives with 30 bytes of
// outputs and 30 bytes of inputs each, and the other datagrams of a cycle. "per_slave_datagram" is
// nanoseconds for one slave to deal with one datagram, whether it concerns the slave or not;
// "of_limit" is that in parts of the limit, 50 ns. The frames are made once and sent again and
// again, as their making is the master's work.

#include <array>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/segment/segment.hpp"

namespace {

using namespace stator;
using namespace stator::ethercat;

constexpr std::size_t kOutputs = 30;
constexpr std::size_t kInputs = 30;
constexpr std::size_t kPerSlave = kOutputs + kInputs;
constexpr std::size_t kSlavesPerFrame = kMaximumDatagramData / kPerSlave;
constexpr double kLimit = 50e-9;  // s per slave and datagram
constexpr MacAddress kMaster{0x02, 0, 0, 0, 0, 1};

std::vector<std::byte> minimal_sii() {
  std::vector<std::byte> image(128);
  image[14] = std::byte{sii_checksum(image)};
  return image;
}

/// A line of drives, configured by frames as a master does it.
class Line {
 public:
  explicit Line(std::size_t slaves, bool mailbox_status) {
    for (std::size_t i = 0; i < slaves; ++i) {
      slaves_.push_back(std::make_unique<SlaveController>(SlaveControllerConfiguration{}));
      slaves_.back()->load_sii(minimal_sii());
      segment_.append(*slaves_.back());
    }
    for (std::size_t i = 0; i < slaves; ++i) {
      const auto logical = static_cast<std::uint32_t>(0x10000 + kPerSlave * i);
      const auto position = static_cast<std::uint16_t>(i);
      set_sync_manager(position, 2, 0x1100, kOutputs, 0x64);
      set_sync_manager(position, 3, 0x1400, kInputs, 0x20);
      set_fmmu(position, 0, logical, kOutputs, 0x1100, 2);
      set_fmmu(position, 1, logical + kOutputs, kInputs, 0x1400, 1);
      if (mailbox_status) {
        set_fmmu(position, 2, 0x1000000 + static_cast<std::uint32_t>(i), 1, 0x080D, 1);
      }
    }
    make_frames();
  }

  /// All process data once; number of datagrams sent.
  std::size_t cycle() {
    for (const std::span<std::byte> frame : frames_) {
      benchmark::DoNotOptimize(segment_.process(frame, now_));
      now_ += base::SimDuration(1000);
    }
    return frames_.size();
  }
  /// Sum of the working counters of the last cycle, which started from 0 in each frame.
  std::size_t fresh_cycle() {
    std::size_t sum = 0;
    for (const std::span<std::byte> frame : frames_) {
      base::store_le(frame, frame.size() - kWorkingCounterLength, std::uint16_t{0});
    }
    cycle();
    for (const std::span<std::byte> frame : frames_) {
      sum += base::load_le<std::uint16_t>(frame, frame.size() - kWorkingCounterLength);
    }
    return sum;
  }

 private:
  void make_frames() {
    buffers_.resize((slaves_.size() + kSlavesPerFrame - 1) / kSlavesPerFrame);
    for (std::size_t i = 0; i < buffers_.size(); ++i) {
      const std::size_t first = i * kSlavesPerFrame;
      const std::size_t count = std::min(kSlavesPerFrame, slaves_.size() - first);
      FrameBuilder builder(buffers_[i], kMaster);
      builder.append(Command::lrw, 0, static_cast<std::uint32_t>(0x10000 + kPerSlave * first),
                     count * kPerSlave);
      frames_.push_back(builder.finish());
    }
  }
  void write(std::uint16_t position, std::uint16_t address, std::span<const std::byte> data) {
    FrameBuilder builder(buffer_, kMaster);
    builder.append(Command::apwr, 0, physical_address(auto_increment_address(position), address),
                   data);
    static_cast<void>(segment_.process(builder.finish(), now_));
  }
  void set_sync_manager(std::uint16_t position, unsigned channel, std::uint16_t start,
                        std::uint16_t length, std::uint8_t control) {
    std::array<std::byte, 8> registers{};
    base::store_le(registers.data(), start);
    base::store_le(registers.data() + 2, length);
    registers[4] = std::byte{control};
    registers[6] = std::byte{1};
    write(position, static_cast<std::uint16_t>(0x0800 + 8 * channel), registers);
  }
  void set_fmmu(std::uint16_t position, unsigned unit, std::uint32_t logical, std::uint16_t length,
                std::uint16_t physical, std::uint8_t type) {
    std::array<std::byte, 16> registers{};
    base::store_le(registers.data(), logical);
    base::store_le(registers.data() + 4, length);
    registers[7] = std::byte{7};
    base::store_le(registers.data() + 8, physical);
    registers[11] = std::byte{type};
    registers[12] = std::byte{1};
    write(position, static_cast<std::uint16_t>(0x0600 + 16 * unit), registers);
  }

  std::vector<std::unique_ptr<SlaveController>> slaves_;
  Segment segment_;
  std::array<std::byte, kMaximumFrameLength> buffer_{};
  base::SimTime now_;
  std::vector<std::array<std::byte, kMaximumFrameLength>> buffers_;
  std::vector<std::span<std::byte>> frames_;
};

using benchmark::Counter;

/// `passes`: how often a datagram went through a slave.
void report(benchmark::State& state, double passes) {
  state.counters["per_slave_datagram"] = Counter(passes, Counter::kIsRate | Counter::kInvert);
  state.counters["of_limit"] = Counter(passes * kLimit, Counter::kIsRate | Counter::kInvert);
}

void run(benchmark::State& state, bool mailbox_status) {
  const auto slaves = static_cast<std::size_t>(state.range(0));
  Line line(slaves, mailbox_status);
  if (line.fresh_cycle() != 3 * slaves) {
    state.SkipWithError("working counter is not 3 per slave");
    return;
  }
  std::size_t datagrams = 0;
  for (auto _ : state) {
    datagrams += line.cycle();
  }
  const auto passes = static_cast<double>(datagrams * slaves);
  const auto exchanges = static_cast<double>(state.iterations()) * static_cast<double>(slaves);
  report(state, passes);
  state.counters["per_slave_cycle"] = Counter(exchanges, Counter::kIsRate | Counter::kInvert);
}

void lrw(benchmark::State& state) {
  run(state, false);
}
void lrw_with_mailbox_status(benchmark::State& state) {
  run(state, true);
}

/// Slaves in a line that have a station address (0x1001 on) and nothing else.
struct AddressedLine {
  explicit AddressedLine(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      slaves.push_back(std::make_unique<SlaveController>(SlaveControllerConfiguration{}));
      slaves.back()->load_sii(minimal_sii());
      segment.append(*slaves.back());
    }
    for (std::size_t i = 0; i < count; ++i) {
      FrameBuilder builder(buffer, kMaster);
      const auto position = auto_increment_address(static_cast<std::uint16_t>(i));
      base::store_le(*builder.append(Command::apwr, 0, physical_address(position, 0x0010), 2), 0,
                     station(i));
      static_cast<void>(segment.process(builder.finish(), now));
    }
  }
  static std::uint16_t station(std::size_t position) {
    return static_cast<std::uint16_t>(0x1001 + position);
  }
  std::vector<std::unique_ptr<SlaveController>> slaves;
  Segment segment;
  std::array<std::byte, kMaximumFrameLength> buffer{};
  base::SimTime now;
};

/// One datagram, sent every millisecond to a line of slaves of which `answers` count it.
void cyclic_datagram(benchmark::State& state, AddressedLine& line, Command command,
                     std::uint32_t address, std::size_t length, std::size_t answers) {
  FrameBuilder builder(line.buffer, kMaster);
  builder.append(command, 0, address, length);
  const std::span<std::byte> frame = builder.finish();
  static_cast<void>(line.segment.process(frame, line.now));
  if (base::load_le<std::uint16_t>(frame, frame.size() - kWorkingCounterLength) != answers) {
    state.SkipWithError("not everybody answers");
    return;
  }
  for (auto _ : state) {
    line.now += base::SimDuration(1'000'000);
    benchmark::DoNotOptimize(line.segment.process(frame, line.now));
  }
  report(state, static_cast<double>(state.iterations()) * static_cast<double>(line.slaves.size()));
}

/// A datagram that concerns one slave only: the others must wave it through.
void fprd_of_the_last_slave(benchmark::State& state) {
  AddressedLine line(static_cast<std::size_t>(state.range(0)));
  const std::uint16_t last = AddressedLine::station(line.slaves.size() - 1);
  cyclic_datagram(state, line, Command::fprd, physical_address(last, 0x0130), 2, 1);
}

/// The first slave's system time goes to all others, which compare it with theirs: what a master
/// with distributed clocks sends in each cycle.
void frmw_system_time(benchmark::State& state) {
  AddressedLine line(static_cast<std::size_t>(state.range(0)));
  const std::uint32_t address = physical_address(AddressedLine::station(0), 0x0910);
  cyclic_datagram(state, line, Command::frmw, address, 8, line.slaves.size());
}

/// The AL status of all slaves: what a master sends in each cycle to notice one that left.
void brd_al_status(benchmark::State& state) {
  AddressedLine line(static_cast<std::size_t>(state.range(0)));
  cyclic_datagram(state, line, Command::brd, physical_address(0, 0x0130), 2, line.slaves.size());
}

/// A controller as each device of a rack needs one: construction and power-on.
void construct_controller(benchmark::State& state) {
  for (auto _ : state) {
    benchmark::DoNotOptimize(std::make_unique<SlaveController>(SlaveControllerConfiguration{}));
  }
}

/// Slaves in a ring, without configuration.
struct Ring {
  explicit Ring(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      slaves.push_back(std::make_unique<SlaveController>(SlaveControllerConfiguration{}));
      segment.append(*slaves.back());
    }
    segment.connect(MasterInterface::secondary, SlavePort{count - 1, 1});
  }
  std::vector<std::unique_ptr<SlaveController>> slaves;
  Segment segment;
  std::array<std::byte, kMaximumFrameLength> buffer{};
};

/// A frame that no slave processes: what is left is the fixed cost of a frame.
void other_way_round_a_ring(benchmark::State& state) {
  Ring ring(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) {
    FrameBuilder builder(ring.buffer, kMaster);
    builder.append(Command::lrw, 0, 0x10000, std::size_t{60});
    benchmark::DoNotOptimize(
        ring.segment.process(builder.finish(), base::SimTime(), MasterInterface::secondary));
  }
}

/// A cable breaks or heals, and both ways are worked out anew; per slave.
void plan_after_a_change(benchmark::State& state) {
  const auto slaves = static_cast<std::size_t>(state.range(0));
  Ring ring(slaves);
  bool intact = false;
  for (auto _ : state) {
    ring.segment.set_link(slaves / 2, std::exchange(intact, !intact));
    benchmark::DoNotOptimize(ring.segment.round_trip(60));
  }
  const auto planned = static_cast<double>(state.iterations()) * static_cast<double>(slaves);
  state.counters["per_slave"] =
      benchmark::Counter(planned, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

}  // namespace

BENCHMARK(lrw)->Arg(1)->Arg(10)->Arg(24)->Arg(50)->Arg(100)->Arg(500);
BENCHMARK(lrw_with_mailbox_status)->Arg(1)->Arg(10)->Arg(50)->Arg(100)->Arg(500);
BENCHMARK(fprd_of_the_last_slave)->Arg(1)->Arg(10)->Arg(50)->Arg(100)->Arg(500);
BENCHMARK(frmw_system_time)->Arg(1)->Arg(50)->Arg(500);
BENCHMARK(brd_al_status)->Arg(1)->Arg(50)->Arg(500);
BENCHMARK(construct_controller);
BENCHMARK(other_way_round_a_ring)->Arg(1)->Arg(50)->Arg(500);
BENCHMARK(plan_after_a_change)->Arg(1)->Arg(10)->Arg(50)->Arg(100)->Arg(500);
