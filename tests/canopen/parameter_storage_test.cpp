// Storing, restoring and loading of parameter groups, with slow, failing and damaged memories.
#include "stator/canopen/storage/parameter_storage.hpp"

#include <gtest/gtest.h>

#include "canopen/memory_double.hpp"
#include "canopen/service_bench.hpp"

namespace stator::canopen {
namespace {

using namespace base::literals;
using Status = NonVolatileMemory::Status;

constexpr std::array<ParameterRange, 1> kCommunication{{{0x1000, 0x1FFF}}};
constexpr std::array<ParameterRange, 2> kApplication{{{0x2020, 0x2024}, {0x2030, 0x2030, 2}}};
constexpr std::array<ParameterGroup, 2> kGroups{{{2, kCommunication, true}, {4, kApplication}}};
constexpr std::array<StorageCommand, 6> kCommands{{
    {0x1010, 1, StorageCommand::Action::store, 1U << 2 | 1U << 4},
    {0x1010, 2, StorageCommand::Action::store, 1U << 2},
    {0x1010, 4, StorageCommand::Action::store, 1U << 4},
    {0x1011, 1, StorageCommand::Action::restore, 1U << 2 | 1U << 4},
    {0x1011, 2, StorageCommand::Action::restore, 1U << 2},
    {0x1011, 4, StorageCommand::Action::restore, 1U << 4},
}};

struct CountingSink final : base::EventSink {
  void on_event(const base::Event& event) override { rules.push_back(event.rule->id); }
  std::vector<base::StaticText> rules;
};

/// What a device does: defaults, then what is stored.
struct Bench : test::TestDictionary {
  void reset_node() {
    dictionary.reset_values();
    storage.load({});
  }
  std::optional<dictionary::Verdict> poll(std::uint16_t index, std::uint8_t subindex,
                                          base::SimTime now = {}) {
    return storage.poll(*dictionary.find(index, subindex), now);
  }

  CountingSink sink;
  test::MemoryDouble memory;
  ParameterStorage storage{dictionary, memory, base::EventReporter(&sink, 0), {kGroups, kCommands}};
};

TEST(ParameterStorage, StoredValues_ComeBackWithTheNextReset) {
  Bench bench;
  bench.write(0x2020, 0, 77);
  bench.write(0x2024, 0, static_cast<std::uint16_t>(-300));
  bench.dictionary.find(0x2023, 0)->set_text("changed, and longer than before");
  bench.write(0x1017, 0, 500);
  EXPECT_EQ(bench.write(0x1010, 1, kSaveSignature), 0U);
  bench.write(0x2020, 0, 78);
  bench.reset_node();
  EXPECT_EQ(bench.value(0x2020), 77U);
  EXPECT_EQ(bench.dictionary.find(0x2024, 0)->signed_value(), -300);
  EXPECT_EQ(bench.dictionary.find(0x2023, 0)->text(), "changed, and longer than before");
  EXPECT_EQ(bench.value(0x1017), 500U);
  EXPECT_TRUE(bench.sink.rules.empty());
}

TEST(ParameterStorage, Group_StoresItsObjectsOnly) {
  Bench bench;
  bench.write(0x2020, 0, 77);
  bench.write(0x2030, 1, 1);
  bench.write(0x2030, 2, 1);
  bench.write(0x1017, 0, 500);
  EXPECT_EQ(bench.write(0x1010, 4, kSaveSignature), 0U);
  bench.reset_node();
  EXPECT_EQ(bench.value(0x2020), 77U);
  EXPECT_EQ(bench.value(0x2030, 1), 0U);
  EXPECT_EQ(bench.value(0x2030, 2), 1U) << "one subindex of an object";
  EXPECT_EQ(bench.value(0x1017), 0U);
  EXPECT_EQ(bench.memory.images.count(2), 0U);
}

TEST(ParameterStorage, WrongSignature_DoesNothing) {
  Bench bench;
  bench.write(0x2020, 0, 77);
  for (const std::uint32_t signature : {0x6E6F7277U, kLoadSignature, 0x73617665U, 1U, 0U}) {
    EXPECT_EQ(bench.write(0x1010, 4, signature), 0x08000020U) << signature;
  }
  EXPECT_EQ(bench.write(0x1011, 4, kSaveSignature), 0x08000020U);
  EXPECT_EQ(bench.memory.orders, 0);
}

TEST(ParameterStorage, Read_TellsThatTheGroupCanBeStored) {
  Bench bench;
  bench.write(0x1010, 4, kSaveSignature);
  EXPECT_EQ(bench.read_refusal(0x1010, 4), 0U);
  EXPECT_EQ(bench.value(0x1010, 4), 1U) << "not the signature";
}

TEST(ParameterStorage, RestoredDefaults_TakeEffectWithTheNextReset) {
  Bench bench;
  bench.write(0x2020, 0, 77);
  bench.write(0x1017, 0, 500);
  bench.write(0x1010, 1, kSaveSignature);
  EXPECT_EQ(bench.write(0x1011, 4, kLoadSignature), 0U);
  EXPECT_EQ(bench.value(0x2020), 77U) << "the running value stays";
  bench.reset_node();
  EXPECT_EQ(bench.value(0x2020), 1000U);
  EXPECT_EQ(bench.value(0x1017), 500U) << "another group";
  bench.write(0x1011, 1, kLoadSignature);
  bench.reset_node();
  bench.reset_node();
  EXPECT_EQ(bench.value(0x1017), 0U);
}

TEST(ParameterStorage, Write_IsCompleteWhenTheMemorySaysSo) {
  Bench bench;
  EXPECT_TRUE(bench.poll(0x2020, 0).has_value()) << "none of its business";
  bench.write(0x1010, 4, kSaveSignature);
  bench.memory.next_status = Status::busy;
  EXPECT_FALSE(bench.poll(0x1010, 4).has_value());
  EXPECT_FALSE(bench.poll(0x1010, 4, base::SimTime(1_s)).has_value());
  EXPECT_EQ(bench.write(0x1010, 4, kSaveSignature), 0x08000022U) << "one order at a time";
  bench.memory.next_status = Status::ready;
  const auto done = bench.poll(0x1010, 4, base::SimTime(1_s));
  ASSERT_TRUE(done.has_value());
  EXPECT_TRUE(done->has_value());
}

TEST(ParameterStorage, MemoryThatIsQuick_StillTakesItsWriteTime) {
  Bench bench;
  const base::SimTime begin(3_ms);
  bench.write(0x1010, 1, kSaveSignature);
  bench.memory.next_status = Status::busy;
  EXPECT_FALSE(bench.poll(0x1010, 1, begin).has_value());
  bench.memory.next_status = Status::ready;
  EXPECT_FALSE(bench.poll(0x1010, 1, begin + 5_ms - 1_ns).has_value());
  EXPECT_TRUE(bench.poll(0x1010, 1, begin + 5_ms).has_value());
}

TEST(ParameterStorage, MemoryThatIsNeverBusy_IsAnsweredAtOnce) {
  Bench bench;
  bench.write(0x1010, 1, kSaveSignature);
  EXPECT_TRUE(bench.poll(0x1010, 1, base::SimTime(3_ms)).has_value());
}

TEST(ParameterStorage, CommandForSeveralGroups_IsOneOrder) {
  Bench bench;
  bench.write(0x1010, 1, kSaveSignature);
  EXPECT_EQ(bench.memory.orders, 1);
  EXPECT_FALSE(bench.memory.images[2].empty());
  EXPECT_FALSE(bench.memory.images[4].empty());
  bench.write(0x1011, 1, kLoadSignature);
  EXPECT_EQ(bench.memory.orders, 2);
  EXPECT_TRUE(bench.memory.images[2].empty());
  EXPECT_TRUE(bench.memory.images[4].empty());
}

TEST(ParameterStorage, FailingMemory_IsAHardwareError) {
  Bench bench;
  bench.memory.next_status = Status::failed;
  EXPECT_EQ(bench.write(0x1010, 4, kSaveSignature), 0U);
  const auto verdict = bench.poll(0x1010, 4);
  ASSERT_TRUE(verdict.has_value());
  ASSERT_FALSE(verdict->has_value());
  EXPECT_EQ(verdict->error().code, dictionary::AbortCode::hardware_error);
}

TEST(ParameterStorage, DamagedImage_LeavesTheDefaultsAndRaisesAnEvent) {
  Bench bench;
  bench.write(0x2020, 0, 77);
  bench.write(0x1010, 4, kSaveSignature);
  const std::vector<std::byte> good = bench.memory.images[4];
  for (std::size_t position = 0; position < good.size(); ++position) {
    bench.memory.images[4] = good;
    bench.memory.images[4][position] ^= std::byte{0x10};
    bench.sink.rules.clear();
    bench.reset_node();
    EXPECT_EQ(bench.value(0x2020), 1000U) << position;
    EXPECT_EQ(bench.sink.rules, std::vector{rules::kStoredParametersDamaged.id}) << position;
  }
  for (std::size_t length = 1; length < good.size(); ++length) {
    bench.memory.images[4].assign(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(length));
    bench.reset_node();
    EXPECT_EQ(bench.value(0x2020), 1000U) << length;
  }
}

TEST(ParameterStorage, ImageOfAnotherDevice_GivesWhatBothHave) {
  Bench bench;
  bench.write(0x2020, 0, 77);
  bench.write(0x1017, 0, 500);
  bench.write(0x1010, 1, kSaveSignature);
  bench.memory.images[4] = bench.memory.images[2];
  bench.memory.images.erase(2);
  bench.reset_node();
  EXPECT_EQ(bench.value(0x1017), 0U) << "no parameter of this group";
  EXPECT_EQ(bench.sink.rules, std::vector{rules::kStoredParametersForeign.id});
}

TEST(ParameterStorage, ResetCommunication_LoadsTheCommunicationGroupOnly) {
  Bench bench;
  bench.write(0x2020, 0, 77);
  bench.write(0x1017, 0, 500);
  bench.write(0x1010, 1, kSaveSignature);
  bench.write(0x2020, 0, 78);
  bench.write(0x1017, 0, 600);
  bench.storage.load_communication({});
  EXPECT_EQ(bench.value(0x1017), 500U);
  EXPECT_EQ(bench.value(0x2020), 78U);
}

TEST(ParameterImage, WithoutASingleValueIsIntact) {
  Bench bench;
  std::vector<std::byte> image;
  encode_parameters(bench.dictionary, {}, image);
  EXPECT_EQ(load_parameters(bench.dictionary, {}, image), ImageVerdict::loaded);
  image.pop_back();
  EXPECT_EQ(load_parameters(bench.dictionary, {}, image), ImageVerdict::damaged);
}

}  // namespace
}  // namespace stator::canopen
