// Application layer, LEDs, configuration of the host interface: 0x0120-0x0153.

#include "stator/ethercat/registers/register_rows.hpp"

namespace stator::ethercat {

namespace {

using namespace notation;

// Registers are {address, bits, name, effect, feature, repetition}, their fields {highest bit,
// lowest bit, name, bus, host, reset, {line of the TMC8461 datasheet, of the TMC8670's}}.
constexpr RegisterRow kAlRows[] = {
    {0x0120, 16, "AL Control", E::al_control},
    {3, 0, "request_state", rw_if, rw_ack, 1, {3196, 1489}},
    {4, 4, "error_ind_ack", rw_if, rw_ack, 0, {3214, 1490}},
    {5, 5, "device_identification_request", rw_if, rw_ack, 0, {3224, 1491}},
    {15, 6, "reserved", rw_if, rw_ack, 0, {3234, 1492}},
    {0x0130, 16, "AL Status", E::al_status},
    {3, 0, "actual_state", r_ack, rw_if, 1, {3267, 1513}},
    {4, 4, "error_ind", r_ack, rw_if, 0, {3281, 1514}},
    {5, 5, "device_identification_valid", r_ack, rw_if, 0, {3293, 1515}},
    {15, 6, "reserved", r_ack, rw_if, 0, {3301, 1516}},
    {0x0134, 16, "AL Status Code"},
    {15, 0, "al_status_code", r, rw, 0, {3314, 1529}},
    {0x0138, 8, "RUN LED Override", E::led_override, F::led_override},
    {3, 0, "led_code", rw, rw, 0, {3321, 1538}},
    {4, 4, "enable_override", rw, rw, 0, {3331, 1539}},
    {7, 5, "reserved", rw, rw, 0, {3339, 1540}},
    {0x0139, 8, "ERR LED Override", E::led_override, F::led_override},
    {3, 0, "led_code", rw, rw, 0, {3351, 1551}},
    {4, 4, "enable_override", rw, rw, 0, {3361, 1552}},
    {7, 5, "reserved", rw, rw, 0, {3369, 1553}},
    {0x0140, 8, "PDI Control"},
    {7, 0, "pdi_type", r, r, 0, {3381, 1568}},
    {0x0141, 8, "ESC Configuration"},
    {0, 0, "device_emulation", r, r, 0, {3408, 1575}},
    {1, 1, "enh_link_all_ports", r, r, 0, {3418, 1576}},
    {2, 2, "dc_sync_out_enable", r, r, 0, {3426, 1577}},
    {3, 3, "dc_latch_in_enable", r, r, 0, {3432, 1578}},
    {4, 4, "enh_link_port0", r, r, 0, {3438, 1579}},
    {5, 5, "enh_link_port1", r, r, 0, {3444, 1580}},
    {6, 6, "enh_link_port2", r, r, 0, {3450, 1581}},
    {7, 7, "enh_link_port3", r, r, 0, {3456, 1582}},
    {0x014E, 16, "PDI Information", E::none, F::pdi_information},
    {0, 0, "pdi_fn_ack_by_write", r, r, 0, {3467, 1591}},
    {1, 1, "pdi_configured", r, r, 0, {3475, 1592}},
    {2, 2, "pdi_active", r, r, 0, {3483, 1593}},
    {3, 3, "pdi_config_invalid", r, r, 0, {3491, 1594}},
    {7, 4, "reserved", r, r, 0, {3499, 1595}},
    {15, 8, "reserved", r, r, 0, {2168, 1588}},
    {0x0150, 8, "PDI SPI Slave Configuration"},
    {1, 0, "spi_mode", r, r, 0, {3509, 1606}},
    {3, 2, "spi_irq_driver", r, r, 0, {3529, 1607}},
    {4, 4, "spi_sel_polarity", r, r, 0, {3541, 1608}},
    {5, 5, "data_out_sample_mode", r, r, 0, {3549, 1609}},
    {7, 6, "reserved", r, r, 0, {3561, 1610}},
    {0x0151, 8, "SYNC/LATCH PDI Configuration"},
    {1, 0, "sync0_driver", r, r, 0, {3569, 1617}},
    {2, 2, "sync0_latch0_select", r, r, 0, {3583, 1618}},
    {3, 3, "sync0_map_al_event", r, r, 0, {3593, 1619}},
    {5, 4, "sync1_driver", r, r, 0, {3617, 1624}},
    {6, 6, "sync1_latch1_select", r, r, 0, {3631, 1625}},
    {7, 7, "sync1_map_al_event", r, r, 0, {3641, 1626}},
    {0x0152, 16, "Extended PDI SPI Slave Configuration"},
    {15, 0, "reserved", r, r, 0, {3658, 1633}},
};

}  // namespace

std::span<const RegisterDeclaration> application_layer_registers() {
  return RegisterTable<kAlRows>::registers();
}

}  // namespace stator::ethercat
