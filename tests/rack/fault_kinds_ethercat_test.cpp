// What faults of a segment and of its slaves do to a master, and that they recover.

#include <gmock/gmock.h>

#include "rack/fault_kind_effects.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"

namespace stator::rack {
namespace {

using namespace base::literals;
using namespace ethercat::register_address;
using ethercat::AlState;
using ethercat::Command;
using tests::SegmentFaultBench;

constexpr std::uint16_t kScratch = 0x1F00;  ///< process memory that nothing uses

std::optional<SegmentFaultBench::Answer> broadcast(SegmentFaultBench& bench, std::uint16_t value) {
  return bench.send(Command::bwr, 0, kScratch, value, 1_ms);
}

void ethercat_drop() {
  SegmentFaultBench bench;
  const auto fault = bench.inject("kind = 'ethercat-drop'\ndevice = 'right'\ncount = 2");
  EXPECT_FALSE(broadcast(bench, 0x44));
  EXPECT_EQ(bench.peek(0, kScratch), 0x44U) << "before the place";
  EXPECT_EQ(bench.peek(1, kScratch), 0U) << "behind it";
  EXPECT_FALSE(broadcast(bench, 0x45));
  for (std::uint16_t address = kReceiveErrors; address < kReceiveErrors + 0x0C; ++address) {
    EXPECT_EQ(bench.counter(0, address) + bench.counter(1, address), 0U) << address;
  }
  EXPECT_EQ(bench.state(fault), FaultState::done);
  EXPECT_TRUE(broadcast(bench, 0x46));
  bench.bring_to_operational();
}

void ethercat_corrupt() {
  SegmentFaultBench bench;
  const auto fault = bench.inject("kind = 'ethercat-corrupt'\ndevice = 'right'\ncount = 1");
  EXPECT_FALSE(broadcast(bench, 0x55));
  EXPECT_EQ(bench.counter(1, kReceiveErrors), 1U) << "invalid frame at port 0 of the second";
  EXPECT_EQ(bench.counter(0, kForwardedErrors + 1), 1U)
      << "forwarded error at port 1 of the first, on the way back";
  EXPECT_EQ(bench.state(fault), FaultState::done);
  bench.bring_to_operational();
}

void ethercat_delay() {
  SegmentFaultBench bench;
  bench.inject("kind = 'ethercat-delay'\ndevice = 'right'\ndelay = '3ms'\ncount = 1");
  EXPECT_FALSE(broadcast(bench, 0x66)) << "not within 1 ms";
  const std::uint8_t index = bench.index();
  EXPECT_EQ(bench.peek(0, kScratch), 0x66U);
  EXPECT_EQ(bench.peek(1, kScratch), 0U) << "it has not come there";
  const base::SimTime before = bench.now();
  const auto late = bench.receive(10_ms);
  ASSERT_TRUE(late);
  EXPECT_EQ(late->index, index);
  EXPECT_EQ(late->working_counter, 2U);
  EXPECT_EQ(bench.now() - before, 2_ms) << "3 ms after it was sent, of which 1 was waited";
  EXPECT_EQ(bench.peek(1, kScratch), 0x66U);
  bench.bring_to_operational();
}

void ethercat_duplicate() {
  SegmentFaultBench bench;
  bench.inject("kind = 'ethercat-duplicate'\ndevice = 'right'\ncount = 1");
  const auto first = broadcast(bench, 0x77);
  const auto second = bench.receive(1_ms);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->index, second->index);
  EXPECT_FALSE(bench.receive(1_ms));
  ASSERT_EQ(bench.scan(), 2U);
  ASSERT_TRUE(bench.master.start_mailbox(1));
  const auto fault = bench.inject("kind = 'ethercat-duplicate'\ndevice = 'right'");
  const auto vendor = bench.master.upload_number<std::uint32_t>(1, {0x1018, 1});
  EXPECT_TRUE(vendor) << vendor.error().text << ": a master that counts indexes copes";
  bench.clear(fault);
  bench.bring_to_operational();
}

void ethercat_reorder() {
  SegmentFaultBench bench;
  bench.inject("kind = 'ethercat-reorder'\ndevice = 'left'\ncount = 1");
  EXPECT_FALSE(bench.send(Command::bwr, 0, kScratch, 1));
  const std::uint8_t first = bench.index();
  const auto overtaker = bench.send(Command::bwr, 0, kScratch, 2);
  const auto overtaken = bench.receive(1_ms);
  ASSERT_TRUE(overtaker && overtaken);
  EXPECT_EQ(overtaker->index, bench.index());
  EXPECT_EQ(overtaken->index, first);
  EXPECT_EQ(bench.peek(1, kScratch), 1U) << "the older value has won";
  bench.bring_to_operational();
}

void mailbox_stall() {
  SegmentFaultBench bench;
  ASSERT_EQ(bench.scan(), 2U);
  ASSERT_TRUE(bench.master.start_mailbox(1));
  const auto silent = bench.inject("kind = 'mailbox-stall'\ndevice = 'right'\ncount = 1");
  const base::SimTime before = bench.now();
  const auto unanswered = bench.master.upload_number<std::uint32_t>(1, {0x1018, 1});
  ASSERT_FALSE(unanswered);
  EXPECT_EQ(unanswered.error().code, master::ErrorCode::mailbox);
  EXPECT_GE(bench.now() - before, bench.master.options().mailbox_timeout);
  EXPECT_EQ(bench.read(1, kSyncManagers + 5) & 0x08U, 0U) << "the request was taken";
  EXPECT_EQ(bench.read(1, kSyncManagers + 13) & 0x08U, 0U) << "nothing to fetch";
  EXPECT_EQ(bench.state(silent), FaultState::done);
  EXPECT_TRUE(bench.master.upload_number<std::uint32_t>(1, {0x1018, 1}));

  const auto full = bench.inject("kind = 'mailbox-stall'\ndevice = 'right'\nmode = 'full'");
  EXPECT_FALSE(bench.master.upload_number<std::uint32_t>(1, {0x1018, 1}));
  EXPECT_EQ(bench.read(1, kSyncManagers + 5) & 0x08U, 0x08U) << "the request lies there";
  EXPECT_FALSE(bench.master.upload_number<std::uint32_t>(1, {0x1018, 1}));
  bench.clear(full);
  bench.port.wait(2_ms);
  EXPECT_EQ(bench.read(1, kSyncManagers + 5) & 0x08U, 0U);
  bench.bring_to_operational();
}

void mailbox_abort() {
  SegmentFaultBench bench;
  ASSERT_EQ(bench.scan(), 2U);
  ASSERT_TRUE(bench.master.start_mailbox(1));
  const auto fault = bench.inject(
      "kind = 'mailbox-abort'\ndevice = 'right'\ncode = 0x06020000\nobject = '1018:01'\ncount = 1");
  EXPECT_TRUE(bench.master.upload_number<std::uint32_t>(1, {0x1018, 2})) << "another object";
  const auto aborted = bench.master.upload_number<std::uint32_t>(1, {0x1018, 1});
  ASSERT_FALSE(aborted);
  EXPECT_EQ(aborted.error().code, master::ErrorCode::sdo_aborted);
  EXPECT_EQ(aborted.error().detail, 0x06020000U);
  EXPECT_EQ(bench.state(fault), FaultState::done);
  EXPECT_TRUE(bench.master.upload_number<std::uint32_t>(1, {0x1018, 1}));
}

void al_error() {
  SegmentFaultBench bench;
  bench.bring_to_operational();
  const auto fault = bench.inject("kind = 'al-error'\ndevice = 'right'\ncode = 0x001A");
  const auto status = bench.master.al_status(1);
  ASSERT_TRUE(status);
  EXPECT_EQ(status->state, AlState::safe_operational);
  EXPECT_TRUE(status->error);
  EXPECT_EQ(status->code, ethercat::AlStatusCode::synchronization_error);
  const auto refused = bench.master.request_state(1, AlState::operational);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, master::ErrorCode::state_refused);
  EXPECT_EQ(refused.error().detail, 0x001AU);
  bench.clear(fault);
  EXPECT_TRUE(bench.master.request_state(1, AlState::operational));
  // Below the state it falls to, the error alone is shown.
  ASSERT_EQ(bench.scan(), 2U);
  bench.clear(bench.inject("kind = 'al-error'\ndevice = 'right'"));
  EXPECT_EQ(bench.read(1, kAlStatus), 0x11U) << "Init with error";
  EXPECT_EQ(bench.read(1, kAlStatusCode), 1U);
  bench.bring_to_operational();
}

void fall_back() {
  SegmentFaultBench bench;
  bench.bring_to_operational();
  const auto fault = bench.inject("kind = 'fall-back'\ndevice = 'right'\ncode = 0x001B");
  EXPECT_EQ(bench.state(fault), FaultState::done);
  EXPECT_EQ(bench.read(1, kAlStatus), 0x14U) << "Safe-Operational with error";
  EXPECT_EQ(bench.read(1, kAlStatusCode), 0x1BU);
  EXPECT_TRUE(bench.master.request_state(1, AlState::operational));
  bench.inject("kind = 'fall-back'\ndevice = 'right'\nstate = 'init'");
  EXPECT_EQ(bench.read(1, kAlStatus), 0x11U);
  EXPECT_TRUE(bench.master.exchange_process_data()) << "the working counter does not tell";
  EXPECT_EQ(bench.send(Command::brd, 0, kAlStatus)->value, 0x19U) << "one look at all does";
  bench.bring_to_operational();
}

void working_counter() {
  SegmentFaultBench bench;
  bench.bring_to_operational();
  const auto fault = bench.inject("kind = 'working-counter'\ndevice = 'right'\ncount = 2");
  EXPECT_EQ(bench.master.exchange_process_data().error().code, master::ErrorCode::working_counter);
  EXPECT_EQ(bench.status(fault).hits, 1U);
  EXPECT_EQ(bench.master.exchange_process_data().error().code, master::ErrorCode::working_counter);
  EXPECT_EQ(bench.state(fault), FaultState::done);
  EXPECT_TRUE(bench.master.exchange_process_data());
  const auto reads = bench.inject("kind = 'working-counter'\ndevice = 'left'\ncommands = 'brd'");
  EXPECT_EQ(bench.send(Command::brd, 0, kAlStatus)->working_counter, 1U);
  EXPECT_EQ(bench.send(Command::bwr, 0, kScratch)->working_counter, 2U);
  bench.clear(reads);
  EXPECT_EQ(bench.send(Command::brd, 0, kAlStatus)->working_counter, 2U);
}

void sii_corruption() {
  constexpr unsigned kChecksumError = 0x0800;
  constexpr unsigned kNotLoaded = 0x1000;
  SegmentFaultBench bench;
  const auto cycle_power = [&bench] {
    bench.inject("kind = 'power-off'\ndevice = 'right'\nfor = '1ms'");
    bench.port.wait(2_ms);
  };
  ASSERT_EQ(bench.scan(), 2U);
  const std::uint32_t vendor = bench.master.slaves()[1].information.identity.vendor_id;
  const auto content =
      bench.inject("kind = 'sii-corruption'\ndevice = 'right'\noffset = 16\nmask = 1");
  ASSERT_EQ(bench.scan(), 2U);
  EXPECT_EQ(bench.master.slaves()[1].information.identity.vendor_id, vendor ^ 1U)
      << "read wrong at once";
  bench.clear(content);
  const auto checksum = bench.inject("kind = 'sii-corruption'\ndevice = 'right'");
  EXPECT_EQ(bench.read(1, kSiiControl) & (kChecksumError | kNotLoaded), 0U) << "loaded before";
  cycle_power();
  EXPECT_EQ(bench.read(1, kSiiControl) & (kChecksumError | kNotLoaded),
            kChecksumError | kNotLoaded);
  EXPECT_EQ(bench.send(Command::aprd, 1, kDlStatus)->value & 1U, 0U) << "host not operational";
  EXPECT_EQ(bench.send(Command::aprd, 1, 0x1000)->working_counter, 0U) << "memory closed";
  bench.clear(checksum);
  cycle_power();
  EXPECT_EQ(bench.read(1, kSiiControl) & (kChecksumError | kNotLoaded), 0U);
  bench.bring_to_operational();
}

void clock_drift() {
  SegmentFaultBench bench(R"(
[[segment]]
[[segment.device]]
type = "tmc8670"
name = "left"
[[segment.device]]
type = "tmc8670"
name = "right"
)");
  ASSERT_EQ(bench.scan(), 2U);
  // Nobody distributes the time: what a clock gains is what its register runs away.
  const auto ahead = [&bench] {
    std::array<std::byte, 64> buffer{};
    std::array<std::byte, ethercat::kMaximumFrameLength> reply{};
    ethercat::FrameBuilder builder(buffer, {2, 0, 0, 0, 0, 1});
    for (const int position : {0, -1}) {
      builder.append(Command::aprd, 0,
                     ethercat::physical_address(static_cast<std::uint16_t>(position), kSystemTime),
                     std::size_t{8});
    }
    const auto length = bench.port.exchange(builder.finish(), reply, 1_ms);
    EXPECT_TRUE(length);
    ethercat::DatagramCursor cursor{std::span(reply).first(length ? *length : 0)};
    const auto time = [&cursor] {
      return static_cast<std::int64_t>(base::load_le<std::uint64_t>(cursor.next()->bytes()));
    };
    const std::int64_t left = time();
    return time() - left;
  };
  const auto gained = [&](base::SimDuration duration) {
    const std::int64_t before = ahead();
    bench.port.wait(duration);
    return ahead() - before;
  };
  EXPECT_EQ(gained(1_s), 0);
  const auto fault = bench.inject("kind = 'clock-drift'\ndevice = 'right'\nppb = 50000");
  EXPECT_NEAR(static_cast<double>(gained(1_s)), 50'000.0, 10.0) << "ns in a second";
  bench.clear(fault);
  EXPECT_NEAR(static_cast<double>(gained(1_s)), 0.0, 10.0);
  bench.bring_to_operational();
}

}  // namespace

FaultKindEffects ethercat_effects() {
  return {
      {"ethercat-drop", ethercat_drop},
      {"ethercat-corrupt", ethercat_corrupt},
      {"ethercat-delay", ethercat_delay},
      {"ethercat-duplicate", ethercat_duplicate},
      {"ethercat-reorder", ethercat_reorder},
      {"mailbox-stall", mailbox_stall},
      {"mailbox-abort", mailbox_abort},
      {"al-error", al_error},
      {"fall-back", fall_back},
      {"working-counter", working_counter},
      {"sii-corruption", sii_corruption},
      {"clock-drift", clock_drift},
  };
}

}  // namespace stator::rack
