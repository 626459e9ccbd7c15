// Events, error counters, watchdogs: 0x0200-0x0443.

#include "stator/ethercat/registers/register_rows.hpp"

namespace stator::ethercat {

namespace {

using namespace notation;

// Registers are {address, bits, name, effect, feature, repetition}, their fields {highest bit,
// lowest bit, name, bus, host, reset, {line of the TMC8461 datasheet, of the TMC8670's}}.
constexpr RegisterRow kEventsRows[] = {
    {0x0200, 16, "ECAT Event Mask", E::event_mask},
    {15, 0, "ecat_event_mask", rw, r, 0, {3669, 1644}},
    {0x0204, 32, "AL Event Mask"},
    {31, 0, "al_event_mask", r, rw, 0xFFFF0F, {3691, 1651}},
    {0x0210, 16, "ECAT Event Request", E::event_request},
    {0, 0, "dc_latch_event", r, r, 0, {3711, 1658}},
    {1, 1, "reserved", r, r, 0, {3726, 1659}},
    {2, 2, "dl_status_event", r, r, 0, {3728, 1660}},
    {3, 3, "al_status_event", r, r, 0, {3741, 1665}},
    {4, 4, "sm0_event", r, r, 0, {3753, 1666}},
    {5, 5, "sm1_event", r, r, 0, {3753, 1667}},
    {6, 6, "sm2_event", r, r, 0, {3753, 1668}},
    {7, 7, "sm3_event", r, r, 0, {3753, 1668}},
    {8, 8, "sm4_event", r, r, 0, {3753, 1668}},
    {9, 9, "sm5_event", r, r, 0, {3753, 1668}},
    {10, 10, "sm6_event", r, r, 0, {3753, 1668}},
    {11, 11, "sm7_event", r, r, 0, {3753, 1669}},
    {15, 12, "reserved", r, r, 0, {3777, 1670}},
    {0x0220, 32, "AL Event Request", E::event_request},
    {0, 0, "al_control_event", r, r, 0, {3785, 1677}},
    {1, 1, "dc_latch_event", r, r, 0, {3797, 1678}},
    {2, 2, "dc_sync0_state", r, r, 0, {3812, 1679}},
    {3, 3, "dc_sync1_state", r, r, 0, {3818, 1680}},
    {4, 4, "sm_activation_changed", r, r, 0, {3830, 1689}},
    {5, 5, "eeprom_emulation_pending", r, r, 0, {3843, 1690}},
    {6, 6, "wd_process_data_expired", r, r, 0, {3855, 1691}},
    {7, 7, "reserved", r, r, 0, {3867, 1692}},
    {8, 8, "sm0_interrupt", r, r, 0, {3869, 1693}},
    {9, 9, "sm1_interrupt", r, r, 0, {3869, 1694}},
    {10, 10, "sm2_interrupt", r, r, 0, {3869, 1695}},
    {11, 11, "sm3_interrupt", r, r, 0, {3869, 1695}},
    {12, 12, "sm4_interrupt", r, r, 0, {3869, 1695}},
    {13, 13, "sm5_interrupt", r, r, 0, {3869, 1695}},
    {14, 14, "sm6_interrupt", r, r, 0, {3869, 1695}},
    {15, 15, "sm7_interrupt", r, r, 0, {3869, 1695}},
    {16, 16, "sm8_interrupt", r, r, 0, {3869, 1695}},
    {17, 17, "sm9_interrupt", r, r, 0, {3869, 1695}},
    {18, 18, "sm10_interrupt", r, r, 0, {3869, 1695}},
    {19, 19, "sm11_interrupt", r, r, 0, {3869, 1695}},
    {20, 20, "sm12_interrupt", r, r, 0, {3869, 1695}},
    {21, 21, "sm13_interrupt", r, r, 0, {3869, 1695}},
    {22, 22, "sm14_interrupt", r, r, 0, {3869, 1695}},
    {23, 23, "sm15_interrupt", r, r, 0, {3869, 1696}},
    {31, 24, "reserved", r, r, 0, {3896, 1697}},
    {0x0300, 16, "RX Error Counter Port #", E::clear_receive_errors, F::always, kEachPortWord},
    {7, 0, "invalid_frame_count", rw_clear, r, 0, {3907, 1710}},
    {15, 8, "rx_error_count", rw_clear, r, 0, {3916, 1711}},
    {0x0308, 8, "Forwarded RX Error Counter Port #", E::clear_receive_errors, F::always,
     kEachPortByte},
    {7, 0, "fwd_rx_error_count", rw_clear, r, 0, {3933, 1718}},
    {0x030C, 8, "ECAT Processing Unit Error Counter", E::clear_processing_unit_errors,
     F::error_counters},
    {7, 0, "epu_error_count", rw_clear, r, 0, {3952, 1729}},
    {0x030D, 8, "PDI Error Counter", E::clear_pdi_errors, F::error_counters},
    {7, 0, "pdi_error_count", rw_clear, r, 0, {3973, 1742}},
    {0x030E, 8, "PDI Error Code", E::none, F::error_counters},
    {2, 0, "spi_clocks_mod8", r, r, 0, {3998, 1752}},
    {3, 3, "busy_violation", r, r, 0, {4004, 1753}},
    {4, 4, "read_termination_missing", r, r, 0, {4006, 1754}},
    {5, 5, "continued_after_termination", r, r, 0, {4008, 1755}},
    {7, 6, "spi_cmd_2_1", r, r, 0, {4010, 1756}},
    {0x0310, 8, "Lost Link Counter Port #", E::clear_lost_links, F::lost_link_counters,
     kEachPortByte},
    {7, 0, "lost_link_count", rw_clear, r, 0, {4020, 1767}},
    {0x0400, 16, "Watchdog Divider", E::watchdog_time, F::always, kOnce, F::watchdog_setting},
    {15, 0, "wd_divider", rw, r, 0x9C2, {4038, 1780}},
    {0x0410, 16, "Watchdog Time PDI", E::watchdog_time, F::always, kOnce, F::watchdog_setting},
    {15, 0, "wd_time_pdi", rw, r, 0x3E8, {4052, 1787}},
    {0x0420, 16, "Watchdog Time Process Data", E::watchdog_time},
    {15, 0, "wd_time_pd", rw, r, 0x3E8, {4069, 1800}},
    {0x0440, 16, "Watchdog Status Process Data", E::watchdog_status},
    {0, 0, "wd_pd_status", r, rw_ack, 0, {4088, 1815}},
    {15, 1, "reserved", r, rw_ack, 0, {4102, 1816}},
    {0x0442, 8, "Watchdog Counter Process Data", E::clear_watchdog_counters},
    {7, 0, "wd_count_pd", rw_clear, r, 0, {4121, 1826}},
    {0x0443, 8, "Watchdog Counter PDI", E::clear_watchdog_counters},
    {7, 0, "wd_count_pdi", rw_clear, r, 0, {4140, 1837}},
};

}  // namespace

std::span<const RegisterDeclaration> event_registers() {
  return RegisterTable<kEventsRows>::registers();
}

}  // namespace stator::ethercat
