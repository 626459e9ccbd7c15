// FMMUs and sync managers: 0x0600-0x087F.

#include "stator/ethercat/registers/register_rows.hpp"

namespace stator::ethercat {

namespace {

using namespace notation;

// Registers are {address, bits, name, effect, feature, repetition}, their fields {highest bit,
// lowest bit, name, bus, host, reset, {line of the TMC8461 datasheet, of the TMC8670's}}.
constexpr RegisterRow kFmmuSmRows[] = {
    {0x0600, 32, "FMMU# Logical Start Address", E::fmmu, F::always, kEachFmmu},
    {31, 0, "log_start", rw, r, 0, {4809, 2065}},
    {0x0604, 16, "FMMU# Length", E::fmmu, F::always, kEachFmmu},
    {15, 0, "length", rw, r, 0, {4821, 2072}},
    {0x0606, 8, "FMMU# Logical Start Bit", E::fmmu, F::always, kEachFmmu},
    {2, 0, "log_start_bit", rw, r, 0, {4834, 2083}},
    {7, 3, "reserved", r, r, 0, {4842, 2084}},
    {0x0607, 8, "FMMU# Logical Stop Bit", E::fmmu, F::always, kEachFmmu},
    {2, 0, "log_stop_bit", rw, r, 0, {4850, 2089}},
    {7, 3, "reserved", r, r, 0, {4858, 2090}},
    {0x0608, 16, "FMMU# Physical Start Address", E::fmmu, F::always, kEachFmmu},
    {15, 0, "phys_start", rw, r, 0, {4866, 2095}},
    {0x060A, 8, "FMMU# Physical Start Bit", E::fmmu, F::always, kEachFmmu},
    {2, 0, "phys_start_bit", rw, r, 0, {4878, 2100}},
    {7, 3, "reserved", r, r, 0, {4886, 2101}},
    {0x060B, 8, "FMMU# Type", E::fmmu, F::always, kEachFmmu},
    {0, 0, "use_read", rw, r, 0, {4893, 2108}},
    {1, 1, "use_write", rw, r, 0, {4899, 2109}},
    {7, 2, "reserved", r, r, 0, {4905, 2110}},
    {0x060C, 8, "FMMU# Activate", E::fmmu, F::always, kEachFmmu},
    {0, 0, "active", rw, r, 0, {4913, 2117}},
    {7, 1, "reserved", r, r, 0, {4923, 2118}},
    {0x060D, 24, "FMMU# Reserved", E::none, F::always, kEachFmmu},
    {23, 0, "reserved", r, r, 0, {4931, 2125}},
    {0x0800, 16, "SM# Physical Start Address", E::sync_manager, F::always, kEachSyncManager},
    {15, 0, "phys_start", rw_if, r, 0, {4966, 2151}},
    {0x0802, 16, "SM# Length", E::sync_manager, F::always, kEachSyncManager},
    {15, 0, "length", rw_if, r, 0, {4980, 2160}},
    {0x0804, 8, "SM# Control", E::sync_manager, F::always, kEachSyncManager},
    {1, 0, "op_mode", rw_if, r, 0, {4997, 2171}},
    {3, 2, "direction", rw_if, r, 0, {5009, 2172}},
    {4, 4, "irq_ecat", rw_if, r, 0, {5021, 2173}},
    {5, 5, "irq_pdi", rw_if, r, 0, {5029, 2174}},
    {6, 6, "wd_trigger_enable", rw, r, 0, {5037, 2175}},
    {7, 7, "reserved", r, r, 0, {5045, 2176}},
    {0x0805, 8, "SM# Status", E::none, F::always, kEachSyncManager},
    {0, 0, "irq_write", r, r, 0, {5055, 2185}},
    {1, 1, "irq_read", r, r, 0, {5071, 2186}},
    {2, 2, "reserved", r, r, 0, {5088, 2191}},
    {3, 3, "mailbox_full", r, r, 0, {5090, 2192}},
    {5, 4, "last_buffer", r, r, 3, {5100, 2193}},
    {6, 6, "read_buffer_open", r, r, 0, {5116, 2194}},
    {7, 7, "write_buffer_open", r, r, 0, {5118, 2195}},
    {0x0806, 8, "SM# Activate", E::sync_manager_activate, F::always, kEachSyncManager},
    {0, 0, "enable", rw, rw_ack, 0, {5126, 2202}},
    {1, 1, "repeat_request", rw, r, 0, {5142, 2203}},
    {5, 2, "reserved", r, rw_ack, 0, {5152, 2204}},
    {6, 6, "latch_event_ecat", rw, rw_ack, 0, {5158, 2205}},
    {7, 7, "latch_event_pdi", rw, rw_ack, 0, {5172, 2206}},
    {0x0807, 8, "SM# PDI Control", E::sync_manager_host_control, F::always, kEachSyncManager},
    {0, 0, "deactivate", r, rw, 0, {5200, 2221}},
    {1, 1, "repeat_ack", r, rw, 0, {5222, 2222}},
    {7, 2, "reserved", r, r, 0, {5232, 2223}},
};

}  // namespace

std::span<const RegisterDeclaration> fmmu_and_sync_manager_registers() {
  return RegisterTable<kFmmuSmRows>::registers();
}

}  // namespace stator::ethercat
