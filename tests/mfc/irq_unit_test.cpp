// Flags, mask and emergency input of the interrupt unit.
#include "stator/mfc/units/irq_unit.hpp"

#include <gtest/gtest.h>

namespace stator::mfc {
namespace {

TEST(IrqUnitFlags, AreSetWhateverTheMaskIsAndGatedByIt) {
  for (unsigned i = 0; i <= 19; ++i) {
    const auto source = static_cast<IrqSource>(i);
    IrqUnit unit;
    unit.raise(source);
    EXPECT_EQ(unit.flags(), irq_bit(source));
    EXPECT_FALSE(unit.output());
    unit.write_mask(irq_bit(source));
    EXPECT_TRUE(unit.output());
    unit.write_mask(0x00FFFFFF & ~irq_bit(source));
    EXPECT_FALSE(unit.output() && !unit.emergency());
  }
}

TEST(IrqUnitFlags, AreClearedByReadingThem) {
  IrqUnit unit;
  unit.write_mask(irq_bit(IrqSource::spi_new_data));
  unit.raise(IrqSource::spi_new_data);
  unit.raise(IrqSource::pwm_a_pulse);
  EXPECT_EQ(unit.read_flags(), irq_bit(IrqSource::spi_new_data) | irq_bit(IrqSource::pwm_a_pulse));
  EXPECT_EQ(unit.read_flags(), 0U);
  EXPECT_FALSE(unit.output());
}

TEST(IrqUnitFlags, OfAShortPulseStayUntilRead) {
  IrqUnit unit;
  unit.raise(IrqSource::sd0_compare);
  EXPECT_EQ(unit.clear_sources() & irq_bit(IrqSource::sd0_compare), 0U);
  EXPECT_EQ(unit.read_flags(), irq_bit(IrqSource::sd0_compare));
  EXPECT_NE(unit.clear_sources() & irq_bit(IrqSource::sd0_compare), 0U);
}

TEST(IrqUnitMask, ReadsBackAllItsBitsAndReservedOnesDoNothing) {
  IrqUnit unit;
  unit.set_emergency_pin(true);
  unit.write_mask(0xFFFFFFFF);
  EXPECT_EQ(unit.mask(), 0x00FFFFFFU);
  EXPECT_FALSE(unit.output());
  EXPECT_EQ(unit.clear_sources(), 0x008FFFFFU);
}

TEST(EmergencyInput, IsIgnoredUnlessEnabled) {
  IrqUnit unit;  // an open pin is low
  EXPECT_FALSE(unit.emergency());
  unit.set_emergency_pin(true);
  unit.set_emergency_pin(false);
  EXPECT_FALSE(unit.emergency());
  EXPECT_EQ(unit.flags(), 0U);
}

TEST(EmergencyInput, SetsFlagAndInterruptWhileLow) {
  IrqUnit unit;
  unit.set_emergency_pin(true);
  unit.write_mask(IrqUnit::kEmergency);
  EXPECT_FALSE(unit.output());
  unit.set_emergency_pin(false);
  EXPECT_TRUE(unit.emergency());
  EXPECT_TRUE(unit.output());
}

TEST(EmergencyInput, EnabledWithTheSwitchOpenIsAnEmergencyAtOnce) {
  IrqUnit unit;
  unit.write_mask(IrqUnit::kEmergency);
  EXPECT_TRUE(unit.emergency());
}

TEST(EmergencyInput, StaysAfterThePinIsHighAndTheFlagsAreRead) {
  IrqUnit unit;
  unit.write_mask(IrqUnit::kEmergency);
  unit.set_emergency_pin(true);
  EXPECT_TRUE(unit.emergency());
  EXPECT_EQ(unit.read_flags(), IrqUnit::kEmergency);
  EXPECT_EQ(unit.read_flags(), IrqUnit::kEmergency);
  EXPECT_TRUE(unit.output());
}

TEST(EmergencyInput, IsClearedByWritingItsMaskBitToZeroAndThenOne) {
  IrqUnit unit;
  unit.write_mask(IrqUnit::kEmergency);
  unit.set_emergency_pin(true);
  unit.write_mask(IrqUnit::kEmergency);
  EXPECT_TRUE(unit.emergency()) << "written 1 again";
  unit.write_mask(0);
  EXPECT_TRUE(unit.emergency()) << "not before the second write";
  unit.write_mask(IrqUnit::kEmergency);
  EXPECT_FALSE(unit.emergency());
  EXPECT_FALSE(unit.output());
}

TEST(EmergencyInput, ComesBackIfThePinIsStillLow) {
  IrqUnit unit;
  unit.write_mask(IrqUnit::kEmergency);
  unit.write_mask(0);
  unit.write_mask(IrqUnit::kEmergency);
  EXPECT_TRUE(unit.emergency());
}

TEST(EmergencyInput, ComesByItsPinOnly) {
  IrqUnit unit;
  unit.raise(IrqSource::mfc_nes_emergency);
  EXPECT_EQ(unit.flags(), 0U);
}

}  // namespace
}  // namespace stator::mfc
