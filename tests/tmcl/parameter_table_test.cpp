// Tables of TMCL parameters, contradictions in them, and values kept in the EEPROM.
#include "stator/tmcl/module/parameter_table.hpp"

#include <array>
#include <stdexcept>

#include <gtest/gtest.h>

#include "stator/tmcl/module/parameter_values.hpp"

namespace stator::tmcl {
namespace {

TEST(ParameterTable, FindsParametersByBankAndNumber) {
  const std::array declarations{ParameterDeclaration{.number = 66},
                                ParameterDeclaration{.number = 66, .bank = 2},
                                ParameterDeclaration{.number = 255, .bank = 3}};
  const ParameterTable table(declarations);
  EXPECT_EQ(table.find(66), &declarations[0]);
  EXPECT_EQ(table.find(2, 66), &declarations[1]);
  EXPECT_EQ(table.find(3, 255), &declarations[2]);
  EXPECT_EQ(table.index_of(*table.find(3, 255)), 2U);
  EXPECT_EQ(table.find(1, 66), nullptr);
  EXPECT_EQ(table.find(255, 66), nullptr) << "a bank that no table has";
  EXPECT_EQ(table.find(65), nullptr);
}

TEST(ParameterTable, RefusesContradictions) {
  const std::array twice{ParameterDeclaration{.number = 4}, ParameterDeclaration{.number = 4}};
  EXPECT_THROW(ParameterTable{twice}, std::logic_error);
  const std::array bank{ParameterDeclaration{.number = 4, .bank = 4}};
  EXPECT_THROW(ParameterTable{bank}, std::logic_error);
}

TEST(ParameterValues, KeptValuesThatAreOutOfRangeBecomeDefaults) {
  const std::array declarations{
      ParameterDeclaration{.number = 0, .stored = true, .minimum = 0, .maximum = 9, .initial = 5},
      ParameterDeclaration{.number = 1, .stored = true, .minimum = 0, .maximum = 9, .initial = 5}};
  ParameterValues values(declarations);
  values.load_eeprom(std::array<std::int32_t, 3>{10, 9, 1});
  values.power_on();
  EXPECT_EQ(values.get(0), 5);
  EXPECT_EQ(values.get(1), 9);
}

TEST(ParameterValues, EveryWriteToTheEepromIsCounted) {
  const std::array declarations{ParameterDeclaration{.number = 0, .stored = true}};
  ParameterValues values(declarations);
  values.set(0, 3);
  EXPECT_EQ(values.eeprom_write_count(), 0U);
  values.store(0);
  EXPECT_EQ(values.eeprom_write_count(), 1U);
  EXPECT_EQ(values.eeprom()[0], 3);
  values.restore_factory_settings();
  EXPECT_EQ(values.eeprom_write_count(), 2U);
  EXPECT_EQ(values.get(0), 3) << "RAM stays";
  values.restore(0);
  EXPECT_EQ(values.get(0), 0);
}

}  // namespace
}  // namespace stator::tmcl
