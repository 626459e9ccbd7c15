// Objects of CiA 402 as an axis binds them: their widths, and where those of a second axis are.

#include "stator/drive/motion/axis_objects.hpp"

#include <array>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "drive/foc_bench.hpp"

namespace stator::drive {
namespace {

using namespace base::literals;
using dictionary::Dictionary;
using dictionary::EntryDeclaration;

/// The objects of `bench`, moved by `offset`, without `omitted`.
class Objects {
 public:
  explicit Objects(const FocBench& bench, std::uint16_t offset = 0, std::uint16_t omitted = 0) {
    for (const dictionary::Entry& entry : bench.dictionary.entries()) {
      if (entry.index() != omitted) {
        declarations_.push_back(entry.declaration());
      }
    }
    dictionary.add(declarations_, {.axis = 1, .index_offset = offset});
    dictionary.finish();
  }

 private:
  std::vector<EntryDeclaration> declarations_;

 public:
  Dictionary dictionary;
};

TEST(IntegerObjects, HoldWhatTheirTypeCanAndSaturateBeyond) {
  FocBench bench;
  IntegerObject of_16_bits(bench.dictionary, 0x6071);
  of_16_bits.set(40'000);
  EXPECT_EQ(of_16_bits.get(), 32'767);
  of_16_bits.set(-40'000);
  EXPECT_EQ(of_16_bits.get(), -32'768);
  IntegerObject without_sign(bench.dictionary, 0x6066);
  without_sign.set(65'535);
  EXPECT_EQ(bench.dictionary.find(0x6066, 0)->value(), 65'535U);
  without_sign.set(65'536);
  EXPECT_EQ(bench.dictionary.find(0x6066, 0)->value(), 65'535U);
  without_sign.set(-5);
  EXPECT_EQ(bench.dictionary.find(0x6066, 0)->value(), 0U);
}

TEST(IntegerObjects, ThatADictionaryLacksAreNamedAtOnceOrReadAsZero) {
  FocBench bench;
  EXPECT_THROW(IntegerObject(bench.dictionary, 0x6082), std::logic_error);
  IntegerObject optional = IntegerObject::optional(bench.dictionary, 0x6082);
  EXPECT_FALSE(optional.exists());
  EXPECT_EQ(optional.get(), 0);
  optional.set(5);
  EXPECT_EQ(optional.get(), 0);
}

TEST(AxisObjectsOfCia402, AreHigherBy800hForTheSecondAxis) {
  const FocBench first;
  Objects second(first, 0x800);
  AxisObjects objects(second.dictionary, 0x800);
  objects.position_actual.set(-123);
  EXPECT_EQ(second.dictionary.find(0x6864, 0)->signed_value(), -123);
  objects.torque_actual.set(45);
  EXPECT_EQ(second.dictionary.find(0x6877, 0)->signed_value(), 45);
}

TEST(AxisObjectsOfCia402, OfTorqueNeedNotBeThere) {
  const FocBench bench;
  for (const std::uint16_t torque : std::to_array<std::uint16_t>({0x6071, 0x6077, 0x60B2})) {
    Objects without(bench, 0, torque);
    EXPECT_NO_THROW(AxisObjects(without.dictionary, 0)) << std::hex << torque;
  }
}

TEST(AxisObjectsOfCia402, ThatAFocAxisShowsAreHigherBy800hForTheSecondAxisToo) {
  const FocBench first;
  Objects second(first, 0x800);
  control::foc::FocBlock block;
  FocAxis axis(second.dictionary, AxisConfiguration{.number = 1, .profile_offset = 0x800}, {},
               block);
  second.dictionary.find(0x68B8, 0)->set_value(0x0011);
  axis.tick(base::SimTime() + 1_ms);
  axis.tick(base::SimTime() + 2_ms);
  EXPECT_EQ(second.dictionary.find(0x68B9, 0)->value(), 0x0001U) << "touch probe 1 is on";
}

TEST(InterpolationPeriod, IsTheMantissaTimesAPowerOfTenAndNothingWithoutItsObject) {
  FocBench bench;
  const AxisObjects objects(bench.dictionary, 0);
  bench.dictionary.find(0x60C2, 1)->set_value(25);
  bench.dictionary.find(0x60C2, 2)->set_value(static_cast<std::uint64_t>(-4));
  EXPECT_EQ(objects.interpolation_period(), base::SimDuration(2'500'000));
  Objects without(bench, 0, 0x60C2);
  EXPECT_EQ(AxisObjects(without.dictionary, 0).interpolation_period(), base::SimDuration(0));
}

}  // namespace
}  // namespace stator::drive
