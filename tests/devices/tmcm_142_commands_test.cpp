// Which parameters the commands of a TMCM-142 take, laid beside the tables of its document.

#include <array>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "tmcm_142_module.hpp"

namespace stator::tests {
namespace {

using tmcl::Command;
using tmcl::Status;

// The lists of L1106-L1421, L1472-L2147, L2221-L2533 and L2570-L2880, and what A33, A48, A56 and
// A57 make of them.
constexpr std::array kSettable{0,  1,  2,  3,  4,  5,  6,  7,  12,  13,  14,  15,  16,  17, 18, 19,
                               20, 21, 22, 23, 27, 28, 29, 30, 31,  32,  33,  35,  37,  40, 42, 43,
                               47, 48, 50, 51, 52, 53, 63, 64, 128, 193, 194, 195, 212, 255};
constexpr std::array kReadOnly{8, 9, 10, 11, 25, 26, 38, 39, 41, 44, 45, 46, 129, 130, 196, 207};
constexpr int kIntegratorSum = 34;  // cleared by writing (A33), hence in neither list
constexpr std::array kConfiguration{64, 65, 66, 67, 69, 70, 71, 73, 75, 76, 77, 80, 81, 83, 84};

struct Tmcm142Commands : testing::Test {
  Tmcm142Module module;
  tmcl::HostAnswer execute(Command command, int type, int motor = 0, std::int64_t value = 0) {
    return module.execute(command, type, motor, value);
  }
};

TEST_F(Tmcm142Commands, AxisParametersAreSetReadStoredAndRestoredAsListed) {
  const std::set<int> settable(kSettable.begin(), kSettable.end());
  const std::set<int> read_only(kReadOnly.begin(), kReadOnly.end());
  for (int number = 0; number < 256; ++number) {
    const bool sum = number == kIntegratorSum;
    const bool listed = settable.contains(number);
    const bool known = listed || sum || read_only.contains(number);
    const tmcl::HostAnswer got = execute(Command::get_axis_parameter, number);
    EXPECT_EQ(got.status, known ? Status::success : Status::wrong_type) << number;
    const std::int32_t value = number == 128 ? 2 : got.value;
    EXPECT_EQ(execute(Command::set_axis_parameter, number, 0, value).status,
              listed || sum ? Status::success : Status::wrong_type)
        << number;
    EXPECT_EQ(execute(Command::store_axis_parameter, number).status,
              listed ? Status::success : Status::wrong_type)
        << number;
    EXPECT_EQ(execute(Command::restore_axis_parameter, number).status,
              listed ? Status::success : Status::wrong_type)
        << number;
    EXPECT_EQ(execute(Command::get_axis_parameter, number, 1).status,
              known ? Status::invalid_value : Status::wrong_type)
        << number;
  }
}

TEST_F(Tmcm142Commands, AxisParametersAreRefusedOutsideTheirRange) {
  for (const tmcl::ParameterDeclaration& parameter : devices::tmcm_142::axis_parameters()) {
    if (!parameter.writable) {
      continue;
    }
    for (const std::int64_t value :
         {std::int64_t{parameter.minimum} - 1, std::int64_t{parameter.maximum} + 1}) {
      if (value >= -2'147'483'648LL && value <= 2'147'483'647LL) {
        EXPECT_EQ(execute(Command::set_axis_parameter, parameter.number, 0, value).status,
                  Status::invalid_value)
            << int{parameter.number} << " = " << value;
      }
    }
  }
}

TEST_F(Tmcm142Commands, ADecimalEncoderConstantHasTenThousandths) {
  using enum devices::tmcm_142::AxisParameter;
  EXPECT_EQ(module.sap(encoder_constant, 65'535), Status::success);
  ASSERT_EQ(module.sap(encoder_mode, 1 << 13), Status::success);
  EXPECT_EQ(module.sap(encoder_constant, (5 << 16) + 9'999), Status::success);
  EXPECT_EQ(module.sap(encoder_constant, (5 << 16) + 10'000), Status::invalid_value);
  EXPECT_EQ(module.gap(encoder_constant), (5 << 16) + 9'999);
}

TEST_F(Tmcm142Commands, WritingTheIntegratorSumClearsIt) {
  using enum devices::tmcm_142::AxisParameter;
  ASSERT_EQ(module.sap(pid_i_factor, 0), Status::success);
  ASSERT_EQ(module.sap(pid_i_clipping, 32'640), Status::success);
  ASSERT_EQ(module.sap(pid_dv_clipping, 0), Status::success);
  ASSERT_EQ(module.sap(encoder_constant, 0), Status::success);
  ASSERT_EQ(module.sap(pid_mode, 1), Status::success);
  ASSERT_EQ(module.execute(Command::move_to_position, 0, 0, 20'000).status, Status::success);
  module.run(base::SimDuration(1'000'000'000));
  EXPECT_LT(module.gap(pid_error), 0);
  EXPECT_NE(module.gap(pid_i_sum), 0);
  EXPECT_EQ(module.sap(pid_i_sum, 123), Status::success);
  EXPECT_EQ(module.gap(pid_i_sum), 0);
}

TEST_F(Tmcm142Commands, GlobalParametersAreThoseOfTheTable) {
  const std::set<int> configuration(kConfiguration.begin(), kConfiguration.end());
  for (int number = 0; number < 256; ++number) {
    const bool known = configuration.contains(number);
    const bool readable = known || (number >= 128 && number <= 133 && number != 131);
    const tmcl::HostAnswer got = execute(Command::get_global_parameter, number);
    EXPECT_EQ(got.status, readable ? Status::success : Status::wrong_type) << number;
    const std::int64_t value = number == 73 ? 4'321 : got.value;
    EXPECT_EQ(execute(Command::set_global_parameter, number, 0, value).status,
              known || number == 132 ? Status::success : Status::wrong_type)
        << number;
    for (const int bank : {1, 3}) {
      EXPECT_EQ(execute(Command::get_global_parameter, number, bank).status, Status::wrong_type)
          << number << " in bank " << bank;
    }
    EXPECT_EQ(execute(Command::get_global_parameter, number, 2).status,
              number < 56 ? Status::success : Status::wrong_type)
        << number;
  }
}

TEST_F(Tmcm142Commands, GlobalParametersStartWithTheirDefaults) {
  const std::map<int, std::int32_t> defaults{{64, 0xE4}, {65, 0}, {66, 1}, {67, 0}, {69, 8},
                                             {70, 2},    {71, 1}, {73, 0}, {75, 0}, {76, 2},
                                             {77, 0},    {80, 0}, {81, 0}, {83, 0}, {84, 0}};
  for (const auto& [number, value] : defaults) {
    EXPECT_EQ(module.ggp(number), value) << number;
  }
}

TEST_F(Tmcm142Commands, OneMotorIsThere) {
  for (const int motor : {1, 2, 255}) {
    EXPECT_EQ(execute(Command::rotate_right, 0, motor, 1).status, Status::invalid_value);
    EXPECT_EQ(execute(Command::move_to_position, 0, motor, 1).status, Status::invalid_value);
    EXPECT_EQ(execute(Command::reference_search, 0, motor).status, Status::invalid_value);
  }
}

TEST_F(Tmcm142Commands, TheVersionIsThatOfTheDocument) {
  EXPECT_EQ(module.device->tmcl().description().version_text, "142V4.45");
  const tmcl::HostAnswer binary = execute(Command::get_firmware_version, 1);
  EXPECT_EQ(binary.value, module.device->tmcl().description().version_value);
}

}  // namespace
}  // namespace stator::tests
