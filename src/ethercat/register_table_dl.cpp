// Identification, station address, write protection, reset, data link: 0x0000-0x0111.

#include "ethercat/register_rows.hpp"

namespace stator::ethercat {

namespace {

using namespace notation;

// Registers are {address, bits, name, effect, feature, repetition}, their fields {highest bit,
// lowest bit, name, bus, host, reset, {line of the TMC8461 datasheet, of the TMC8670's}}.
constexpr RegisterRow kRows[] = {
    {0x0000, 8, "Type"},
    {7, 0, "type", r, r, 0, {2409, 1263}},
    {0x0001, 8, "Revision"},
    {7, 0, "revision", r, r, 0, {2420, 1270}},
    {0x0002, 16, "Build"},
    {15, 0, "build", r, r, 0, {2431, 1277}},
    {0x0004, 8, "FMMUs supported"},
    {7, 0, "fmmu_count", r, r, 0, {2445, 1286}},
    {0x0005, 8, "SyncManagers supported"},
    {7, 0, "sm_count", r, r, 0, {2463, 1291}},
    {0x0006, 8, "RAM Size"},
    {7, 0, "ram_kbyte", r, r, 0, {2481, 1296}},
    {0x0007, 8, "Port Descriptor"},
    {1, 0, "port0", r, r, 0, {2498, 1304}},
    {3, 2, "port1", r, r, 0, {2516, 1305}},
    {7, 4, "ports2_3", r, r, 0, {2524, 1306}},
    {0x0008, 16, "ESC Features supported"},
    {0, 0, "fmmu_byte_oriented", r, r, 0, {2532, 1313}},
    {1, 1, "reserved", r, r, 0, {2540, 1314}},
    {2, 2, "dc_available", r, r, 0, {2542, 1315}},
    {3, 3, "dc_64bit", r, r, 0, {2550, 1316}},
    {4, 4, "low_jitter_ebus", r, r, 0, {2558, 1317}},
    {5, 5, "enh_link_ebus", r, r, 0, {2566, 1318}},
    {6, 6, "enh_link_mii", r, r, 0, {2574, 1319}},
    {7, 7, "separate_fcs_errors", r, r, 0, {2583, 1324}},
    {8, 8, "enh_dc_sync_activation", r, r, 0, {2595, 1325}},
    {9, 9, "lrw_not_supported", r, r, 0, {2607, 1326}},
    {10, 10, "rw_cmds_not_supported", r, r, 0, {2615, 1327}},
    {11, 11, "fixed_fmmu_sm", r, r, 0, {2623, 1328}},
    {15, 12, "reserved", r, r, 0, {2633, 1329}},
    {0x0010, 16, "Configured Station Address", E::station_address},
    {15, 0, "station_address", rw, r, 0, {2642, 1342}},
    {0x0012, 16, "Configured Station Alias", E::station_address},
    {15, 0, "station_alias", r, rw, 0, {2654, 1349}},
    {0x0020, 8, "Write Register Enable", E::unlock_registers, F::write_protection},
    {0, 0, "wr_enable", rw, r, 0, {2675, 1360}},
    {7, 1, "reserved", r, r, 0, {2689, 1361}},
    {0x0021, 8, "Write Register Protection", E::write_protection, F::write_protection},
    {0, 0, "wr_protect", rw, r, 0, {2697, 1368}},
    {7, 1, "reserved", r, r, 0, {2708, 1369}},
    {0x0030, 8, "ESC Write Enable", E::unlock_controller, F::write_protection},
    {0, 0, "esc_wr_enable", rw, r, 0, {2716, 1376}},
    {7, 1, "reserved", r, r, 0, {2730, 1377}},
    {0x0031, 8, "ESC Write Protection", E::write_protection, F::write_protection},
    {0, 0, "esc_wr_protect", rw, r, 0, {2737, 1386}},
    {7, 1, "reserved", r, r, 0, {2747, 1387}},
    {0x0040, 8, "ESC Reset ECAT", E::reset_by_bus, F::reset_registers},
    {7, 0, "reset_key (write view)", w, none, 0, {2758, 0}},
    {1, 0, "reset_progress (read view)", r, r, 0, {2766, 0}},
    {7, 2, "reserved (read view)", r, r, 0, {2774, 0}},
    {0x0041, 8, "ESC Reset PDI", E::reset_by_host, F::reset_registers},
    {7, 0, "reset_key (write view)", none, w, 0, {2784, 0}},
    {1, 0, "reset_progress (read view)", r, r, 0, {2792, 0}},
    {7, 2, "reserved (read view)", r, r, 0, {2800, 0}},
    {0x0100, 32, "ESC DL Control", E::dl_control},
    {0, 0, "forwarding_rule", rw, r, 1, {2819, 1396}},
    {1, 1, "temporary_use", rw, r, 0, {2841, 1397}},
    {7, 2, "reserved", r, r, 0, {2850, 1398}},
    {9, 8, "loop_port0", rw, r, 0, {2852, 1399}},
    {11, 10, "loop_port1", rw, r, 0, {2884, 1400}},
    {13, 12, "loop_port2", rw, r, 0, {2896, 1401}},
    {15, 14, "loop_port3", rw, r, 0, {2908, 1402}},
    {18, 16, "rx_fifo_size", rw, r, 7, {2921, 1407}},
    {19, 19, "ebus_low_jitter", rw, r, 0, {2951, 1408}},
    {21, 20, "reserved", rw, r, 0, {2957, 1409}},
    {22, 22, "ebus_remote_link_down_time", rw, r, 0, {2959, 1410}},
    {23, 23, "reserved", rw, r, 0, {2966, 1411}},
    {24, 24, "station_alias_enable", rw, r, 0, {2968, 1412}},
    {31, 25, "reserved", r, r, 0, {2978, 1413}},
    {0x0108, 16, "Physical Read/Write Offset", E::none, F::read_write_offset},
    {15, 0, "rw_offset", rw, r, 0, {2994, 1424}},
    {0x0110, 16, "ESC DL Status", E::dl_status},
    {0, 0, "eeprom_loaded_pdi_operational", r_ack, r, 0, {3009, 1433}},
    {1, 1, "pdi_watchdog_status", r_ack, r, 0, {3021, 1434}},
    {2, 2, "enhanced_link_detection", r_ack, r, 0, {3029, 1435}},
    {3, 3, "reserved", r_ack, r, 0, {3041, 1436}},
    {4, 4, "link_port0", r_ack, r, 0, {3043, 1437}},
    {5, 5, "link_port1", r_ack, r, 0, {3051, 1438}},
    {6, 6, "link_port2", r_ack, r, 0, {3059, 1439}},
    {7, 7, "link_port3", r_ack, r, 0, {3067, 1440}},
    {8, 8, "loop_port0", r_ack, r, 0, {3075, 1441}},
    {9, 9, "comm_port0", r_ack, r, 0, {3083, 1442}},
    {10, 10, "loop_port1", r_ack, r, 0, {3091, 1443}},
    {11, 11, "comm_port1", r_ack, r, 0, {3099, 1444}},
    {12, 12, "loop_port2", r_ack, r, 0, {3107, 1445}},
    {13, 13, "comm_port2", r_ack, r, 0, {3115, 1446}},
    {14, 14, "loop_port3", r_ack, r, 0, {3124, 1451}},
    {15, 15, "comm_port3", r_ack, r, 0, {3132, 1452}},
};

constexpr auto kFields = fields_of<kRows>();
constexpr auto kRegisters = registers_of<kRows, kFields>();

}  // namespace

std::span<const RegisterDeclaration> data_link_registers() {
  return kRegisters;
}

}  // namespace stator::ethercat
