// EEPROM interface, MII management, parameter RAM: 0x0500-0x05FF.

#include "stator/ethercat/registers/register_rows.hpp"

namespace stator::ethercat {

namespace {

using namespace notation;

// Registers are {address, bits, name, effect, feature, repetition}, their fields {highest bit,
// lowest bit, name, bus, host, reset, {line of the TMC8461 datasheet, of the TMC8670's}}.
constexpr RegisterRow kSiiMiiRows[] = {
    {0x0500, 8, "EEPROM Configuration", E::sii_access, F::sii_host_access},
    {0, 0, "offer_to_pdi", rw, r, 0, {4181, 1860}},
    {1, 1, "force_ecat_access", rw, r, 0, {4189, 1861}},
    {7, 2, "reserved", rw, r, 0, {4196, 1862}},
    {0x0501, 8, "EEPROM PDI Access State", E::sii_access, F::sii_host_access},
    {0, 0, "pdi_access", r, rw_if, 0, {4204, 1869}},
    {7, 1, "reserved", r, r, 0, {4214, 1870}},
    {0x0502, 16, "EEPROM Control/Status", E::sii_interface},
    {0, 0, "write_enable", rw_if, r, 0, {4223, 1883}},
    {4, 1, "reserved", r, r, 0, {4233, 1884}},
    {5, 5, "eeprom_emulation", r, r, 0, {4235, 1885}},
    {6, 6, "read_8_bytes", r, r, 0, {4243, 1886}},
    {7, 7, "two_address_bytes", r, r, 0, {4251, 1887}},
    {10, 8, "command", rw_if, rw_if, 0, {4261, 1888}},
    {11, 11, "checksum_error", r, r, 0, {4293, 1889}},
    {12, 12, "not_loaded", r, r, 0, {4301, 1890}},
    {13, 13, "error_ack_cmd", r, r, 0, {4313, 1891}},
    {14, 14, "error_write_enable", r, r, 0, {4330, 1896}},
    {15, 15, "busy", r, r, 0, {4338, 1897}},
    {0x0504, 32, "EEPROM Address", E::sii_interface},
    {31, 0, "eeprom_word_address", rw_if, rw_if, 0, {4373, 1911}},
    {0x0508, 64, "EEPROM Data", E::sii_interface},
    {15, 0, "data_low", rw_if, rw_if, 0, {4402, 1922}},
    {63, 16, "data_high", r, r, 0, {4412, 1923}},
    {0x0510, 16, "MII Management Control/Status", E::mii_interface, F::mii_management},
    {0, 0, "write_enable", rw_if, r, 0, {4501, 1950}},
    {1, 1, "pdi_control_possible", r, r, 0, {4511, 1951}},
    {2, 2, "mi_link_detection", r, r, 0, {4520, 1952}},
    {7, 3, "phy_address_port0", r, r, 0, {4529, 1953}},
    {9, 8, "command", rw_if, rw_if, 0, {4531, 1954}},
    {12, 10, "reserved", r, r, 0, {4551, 1955}},
    {13, 13, "read_error", rw_start, rw_start, 0, {4554, 1960}},
    {14, 14, "command_error", r, r, 0, {4566, 1961}},
    {15, 15, "busy", r, r, 0, {4580, 1962}},
    {0x0512, 8, "PHY Address", E::mii_interface, F::mii_management},
    {4, 0, "phy_address", rw_if, rw_if, 0, {4604, 1973}},
    {6, 5, "reserved", r, r, 0, {4606, 1974}},
    {7, 7, "show_port_address", rw_if, rw_if, 0, {4608, 1975}},
    {0x0513, 8, "PHY Register Address", E::mii_interface, F::mii_management},
    {4, 0, "phy_reg", rw_if, rw_if, 0, {4628, 1986}},
    {7, 5, "reserved", rw_if, rw_if, 0, {4634, 1987}},
    {0x0514, 16, "PHY Data", E::mii_interface, F::mii_management},
    {15, 0, "phy_data", rw_if, rw_if, 0, {4646, 1996}},
    {0x0516, 8, "MII Management ECAT Access State", E::mii_access, F::mii_management},
    {0, 0, "ecat_exclusive", rw_if, r, 0, {4658, 2005}},
    {7, 1, "reserved", r, r, 0, {4670, 2006}},
    {0x0517, 8, "MII Management PDI Access State", E::mii_access, F::mii_management},
    {0, 0, "pdi_access", r, rw_if, 0, {4679, 2017}},
    {1, 1, "force_pdi_release", rw, r, 0, {4687, 2018}},
    {7, 2, "reserved", r, r, 0, {4694, 2019}},
    {0x0518, 8, "PHY Port Status Port #", E::mii_port_status, F::mii_link_detection, kEachPortByte},
    {0, 0, "phy_link", r, r, 0, {4702, 2026}},
    {1, 1, "link_100_fd", r, r, 0, {4708, 2027}},
    {2, 2, "link_status_error", r, r, 0, {4716, 2028}},
    {3, 3, "read_error", rw_clear, rw_clear, 0, {4724, 2029}},
    {4, 4, "link_partner_error", r, r, 0, {4742, 2030}},
    {5, 5, "phy_config_updated", rw_clear, rw_clear, 0, {4748, 2031}},
    {7, 6, "reserved", r, r, 0, {4766, 2032}},
    {0x0580, 784, "ESC Parameter RAM - MFC IO configuration", E::parameter_ram, F::parameter_ram},
    {783, 0, "mfc_config_vector", rw, rw, 0, {4431, 0}},
    {0x05E2, 240, "ESC Parameter RAM - rest", E::parameter_ram, F::parameter_ram},
    {239, 0, "parameter_ram_unused", rw, rw, 0, {2247, 0}},
};

}  // namespace

std::span<const RegisterDeclaration> sii_and_mii_registers() {
  return RegisterTable<kSiiMiiRows>::registers();
}

}  // namespace stator::ethercat
