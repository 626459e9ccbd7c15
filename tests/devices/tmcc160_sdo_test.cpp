// The TMCC160 by SDO: identity, every entry, abort codes, and the worked examples of its document.
#include <fstream>
#include <functional>
#include <iterator>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "devices/csv.hpp"
#include "devices/tmcc160_module.hpp"
#include "source_paths.hpp"
#include "stator/devices/tmcc160/tmcc160.hpp"
#include "stator/dictionary/description.hpp"

namespace stator::devices {
namespace {

using tests::Tmcc160Module;
using AbortCode = dictionary::AbortCode;
constexpr AbortCode kNoError{};

TEST(Tmcc160Identity, IsWhatTheDocumentSays) {
  Tmcc160Module module;
  module.boot();
  EXPECT_EQ(module.read(0x1000), 0xFFFC0192);
  EXPECT_EQ(module.read(0x1001), 0);
  EXPECT_EQ(module.read_text(0x1008), "TMCC160");
  EXPECT_EQ(module.read_text(0x1009), "1.0");
  EXPECT_EQ(module.read_text(0x100A), "3.00");
  EXPECT_EQ(module.read(0x1018, 0), 3);
  EXPECT_EQ(module.read(0x1018, 1), 0x286);
  EXPECT_EQ(module.read(0x1018, 2), 160);
  EXPECT_EQ(module.read(0x1018, 3), 0x00030000);
  static_cast<void>(module.upload(0x1018, 4));
  EXPECT_EQ(module.abort, AbortCode::subindex_does_not_exist);
}

TEST(Tmcc160Identity, TheDeviceTypeOfCia402IsAnOption) {
  Tmcc160Configuration configuration;
  configuration.options.cia_402_device_type = true;
  Tmcc160Module module(configuration);
  module.boot();
  EXPECT_EQ(module.read(0x1000), 0x00420192);
}

TEST(Tmcc160Identity, NoIdentityObjectCanBeWritten) {
  Tmcc160Module module;
  module.boot();
  for (const std::uint16_t index : std::to_array<std::uint16_t>({0x1000, 0x1001})) {
    EXPECT_EQ(module.write(index, 0, 0), AbortCode::read_only);
  }
  for (const std::uint8_t subindex : std::to_array<std::uint8_t>({0, 1, 2, 3})) {
    EXPECT_EQ(module.write(0x1018, subindex, 0), AbortCode::read_only);
  }
}

TEST(Tmcc160Sdo, EveryEntryIsReadWithTheSizeAndValueItIsDeclaredWith) {
  Tmcc160Module module;
  module.boot();
  std::size_t read = 0;
  for (const dictionary::Entry& entry : module.device->dictionary().entries()) {
    const std::vector<std::uint8_t> bytes = module.upload(entry.index(), entry.subindex());
    SCOPED_TRACE(testing::Message() << std::hex << entry.index() << ':' << int{entry.subindex()});
    if (!entry.readable()) {
      EXPECT_EQ(module.abort, AbortCode::write_only);
      continue;
    }
    EXPECT_EQ(module.abort, kNoError);
    EXPECT_EQ(bytes.size(), entry.size());
    if (!dictionary::is_string(entry.type()) && !entry.declaration().live) {
      EXPECT_EQ(static_cast<std::uint64_t>(module.read(entry.index(), entry.subindex())),
                entry.index() == 0x6040 ? 0 : entry.default_bits());
    }
    ++read;
  }
  EXPECT_EQ(read, 216U);
}

TEST(Tmcc160Sdo, EveryParameterTakesTheValueItHas) {
  Tmcc160Module module;
  module.boot();
  std::size_t written = 0;
  for (const dictionary::Entry& entry : module.device->dictionary().entries()) {
    const bool signature = entry.declaration().unit == "signature";
    if (!entry.writable() || !entry.readable() || signature) {
      continue;
    }
    SCOPED_TRACE(testing::Message() << std::hex << entry.index() << ':' << int{entry.subindex()});
    const std::int64_t value = module.read(entry.index(), entry.subindex());
    const bool mapping = (entry.index() & 0xFD00U) == 0x1400 || entry.index() >> 8 == 0x16 ||
                         entry.index() >> 8 == 0x18 || entry.index() >> 8 == 0x1A;
    const AbortCode answer = module.write(entry.index(), entry.subindex(), value);
    if (mapping && entry.index() >> 8 != 0x14 && entry.index() >> 8 != 0x18) {
      EXPECT_EQ(answer, AbortCode::device_state) << "a mapping is fixed while its PDO is valid";
    } else {
      EXPECT_EQ(answer, kNoError);
    }
    ++written;
  }
  EXPECT_GT(written, 90U);
}

TEST(Tmcc160Sdo, AnswersWithTheStandardsAbortCodes) {
  Tmcc160Module module;
  module.boot();
  static_cast<void>(module.upload(0x1004, 0));
  EXPECT_EQ(module.abort, AbortCode::object_does_not_exist);
  static_cast<void>(module.upload(0x1010, 3));
  EXPECT_EQ(module.abort, AbortCode::subindex_does_not_exist);
  EXPECT_EQ(module.write(0x6041, 0, 0), AbortCode::read_only);
  EXPECT_EQ(module.abort_of(module.sdo({0x23, 0x60, 0x60, 0, 1, 0, 0, 0})),
            AbortCode::length_too_high);
  EXPECT_EQ(module.abort_of(module.sdo({0x2F, 0x40, 0x60, 0, 1, 0, 0, 0})),
            AbortCode::length_too_low);
  EXPECT_EQ(module.abort_of(module.sdo({0xA0, 0x00, 0x10, 0, 127, 0, 0, 0})),
            AbortCode::command_specifier_unknown)
      << "no block transfer";
  EXPECT_EQ(module.write(0x2020, 1, 90001), AbortCode::value_too_high);
  EXPECT_EQ(module.write(0x2010, 1, 1), AbortCode::value_too_low);
}

struct Step {
  std::string example, kind, expected;
  std::uint16_t index;
  std::uint8_t subindex;
  std::array<std::uint8_t, 8> request{};
  std::vector<std::uint8_t> response;
};

std::vector<std::uint8_t> bytes_of(const std::string& text) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += 3) {
    bytes.push_back(static_cast<std::uint8_t>(std::stoul(text.substr(i, 2), nullptr, 16)));
  }
  return bytes;
}

std::vector<Step> sequences() {
  std::ifstream file(STATOR_TEST_DATA "/tmcc160/example_sequences.csv");
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  std::vector<Step> steps;
  for (const tests::CsvRow& row : tests::parse_csv(text)) {
    if (row[0] == "example") {
      continue;
    }
    Step step{row[0],
              row[2],
              row[9],
              static_cast<std::uint16_t>(std::stoul(row[3], nullptr, 16)),
              static_cast<std::uint8_t>(std::stoul(row[4], nullptr, 16)),
              {},
              bytes_of(row[8])};
    std::ranges::copy(bytes_of(row[7]), step.request.begin());
    steps.push_back(step);
  }
  return steps;
}

/// The worked examples of the document, byte for byte, with what has to come of them.
class Tmcc160Examples : public testing::Test {
 protected:
  void run(
      const std::string& example, const std::function<void(int)>& after = [](int) {}) {
    int number = 0;
    for (const Step& step : sequences()) {
      if (step.example != example) {
        continue;
      }
      ++number;
      SCOPED_TRACE(example + " step " + std::to_string(number) + ": " + step.expected);
      EXPECT_EQ(module_.sdo(step.request), step.response);
      module_.wait(5);
      expect_state(step.expected);
      after(number);
    }
    EXPECT_GT(number, 0);
  }
  /// "(6041h and 006Fh) = 0027h, ..."
  void expect_state(const std::string& expected) {
    const std::string mark = "(6041h and 006Fh) = ";
    if (expected.rfind(mark, 0) == 0) {
      EXPECT_EQ(module_.state(), std::stoul(expected.substr(mark.size(), 4), nullptr, 16));
    }
    const std::string mode = "6061h = ";
    if (expected.find(mode) != std::string::npos) {
      EXPECT_EQ(module_.read(0x6061), std::stoi(expected.substr(expected.find(mode) + 8)));
    }
  }
  unsigned status() { return static_cast<unsigned>(module_.read(0x6041)); }

  Tmcc160Module module_;
};

constexpr unsigned kTargetReached = 1U << 10;
constexpr unsigned kAcknowledged = 1U << 12;
constexpr unsigned kMoving = 1U << 14;

TEST_F(Tmcc160Examples, ParametersAreStoredAndRestored) {
  module_.boot();
  run("E-01");
  run("E-02");
}

TEST_F(Tmcc160Examples, ObjectsReadAsPrinted) {
  module_.boot();
  run("E-03");
}

TEST_F(Tmcc160Examples, ProfilePositionTravelsToTheTarget) {
  module_.boot();
  run("E-04", [this](int step) {
    if (step == 6) {
      EXPECT_EQ(module_.read(0x606C), 0) << "no motion yet";
    }
    if (step == 7) {
      EXPECT_NE(status() & kAcknowledged, 0U);
      module_.wait(200);
      EXPECT_NE(status() & kMoving, 0U);
    }
  });
  EXPECT_EQ(status() & kAcknowledged, 0U);
  module_.wait(5'000);
  EXPECT_GT(module_.read(0x6064), 0) << "the motion goes on with bit 4 taken back";
  // 500000 hall steps at 24 to a revolution: 20833 revolutions of 4000 rpm at most.
  EXPECT_NE(status() & kMoving, 0U);
}

TEST_F(Tmcc160Examples, ProfilePositionComesToRestOnTheTarget) {
  module_.boot();
  ASSERT_EQ(module_.write(0x2055, 0, 7), kNoError) << "encoder steps, 4000 to a revolution";
  run("E-04");
  module_.wait(9'000);
  for (int i = 0; i < 1'000; ++i) {
    module_.wait(1);
    ASSERT_NE(status() & kTargetReached, 0U) << "it stays reached";
  }
  EXPECT_NEAR(static_cast<double>(module_.read(0x6064)), 500'000.0, 1.0);
}

TEST_F(Tmcc160Examples, ProfileVelocityTakesUpTheTargetAndStops) {
  module_.boot();
  run("E-05", [this](int step) {
    if (step == 4) {
      EXPECT_EQ(module_.read(0x606C), 0) << "not enabled yet";
    }
    if (step == 5) {
      module_.wait(1'500);
      EXPECT_NEAR(static_cast<double>(module_.read(0x606C)), 2'000.0, 60.0);
      EXPECT_NE(status() & kTargetReached, 0U);
      EXPECT_NE(status() & kMoving, 0U);
    }
  });
  module_.wait(1'500);
  EXPECT_NEAR(static_cast<double>(module_.read(0x606C)), 0.0, 5.0);
  EXPECT_EQ(status() & kMoving, 0U);
}

TEST_F(Tmcc160Examples, HomingFindsTheSwitchThatIsPressedByHand) {
  module_.boot();
  run("E-06", [this](int step) {
    if (step != 8) {
      return;
    }
    EXPECT_EQ(status() & (kTargetReached | kAcknowledged), 0U);
    module_.wait(500);
    EXPECT_LT(module_.read(0x606C), 0);
    module_.set("axis0.left_switch", 1);
    module_.wait(1'000);
    module_.set("axis0.left_switch", 0);
    module_.wait(2'000);
    EXPECT_EQ(status() & (kTargetReached | kAcknowledged), kTargetReached | kAcknowledged);
  });
  EXPECT_EQ(module_.read(0x6061), 6);
  run("E-06b");
}

TEST_F(Tmcc160Examples, CyclicTorqueDrivesTheMotor) {
  module_.boot(true);
  run("E-07", [this](int step) {
    if (step == 6) {
      EXPECT_EQ(module_.read(0x2030, 2), 1'000);
      EXPECT_NE(status() & kAcknowledged, 0U);
      module_.set("axis0.load_torque", -0.025);  // of the 31 mNm that 1 A gives
      module_.wait(50);
      EXPECT_NEAR(static_cast<double>(module_.read(0x6077)), 1'000.0, 60.0);
      EXPECT_GT(module_.read(0x606C), 50);
      module_.set("axis0.load_torque", 0.0);
    }
  });
  module_.wait(20);
  EXPECT_NEAR(static_cast<double>(module_.read(0x6077)), 0.0, 100.0);
}

TEST_F(Tmcc160Examples, ANewBitRateActsAfterItWasStoredAndTheModuleReset) {
  module_.boot();
  run("E-08");
  EXPECT_EQ(module_.read(0x2707), 1000);
  EXPECT_EQ(module_.device->bit_rate(), 1'000'000U);
  module_.nmt(129);
  EXPECT_EQ(module_.device->bit_rate(), 500'000U);
  module_.wait(110);
  EXPECT_EQ(module_.read(0x2707), 500);
}

TEST_F(Tmcc160Examples, ANewNodeIdActsAfterItWasStoredAndTheModuleReset) {
  module_.boot();
  run("E-09");
  EXPECT_EQ(module_.read(0x2708), 1);
  module_.frames.clear();
  module_.nmt(129);
  module_.wait(110);
  ASSERT_FALSE(module_.frames.empty());
  EXPECT_EQ(module_.frames.front(), can::data_frame(0x705, {0}));
  module_.node_id = 5;
  EXPECT_EQ(module_.read(0x2708), 5);
  EXPECT_EQ(module_.read(0x1014), 0x85);
  EXPECT_EQ(module_.read(0x1800, 1), 0x40000185);
}

TEST_F(Tmcc160Examples, ATransmitPdoIsRemapped) {
  module_.boot(true);
  run("E-10");
  module_.frames.clear();
  module_.wait(1'020);
  const auto sent = std::ranges::count_if(
      module_.frames, [](const can::Frame& f) { return f.identifier == 0x381 && f.length == 6; });
  EXPECT_GE(sent, 4);
  EXPECT_LE(sent, 5);
}

}  // namespace
}  // namespace stator::devices
