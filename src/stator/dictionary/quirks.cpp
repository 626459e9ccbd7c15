#include "stator/dictionary/quirks.hpp"

#include <array>
#include <limits>

namespace stator::dictionary {

namespace {

constexpr std::int64_t kMillisecond = 1'000'000;
constexpr std::int64_t kMinute = 60'000 * kMillisecond;
constexpr std::int64_t kAny = std::numeric_limits<std::uint32_t>::max();

constexpr bool kCoe = true;
constexpr bool kCanopen = true;
constexpr bool kNo = false;

constexpr std::array kQuirks{
    QuirkDeclaration{"no-complete-access", &Quirks::no_complete_access, kCoe, kNo,
                     "Complete access is aborted with 06010000h, though the SII announces it",
                     "PDO assignment is not read, or not written, when there is no way back to "
                     "single subindices"},
    QuirkDeclaration{"no-sdo-information", &Quirks::no_sdo_information, kCoe, kNo,
                     "The SDO information service is answered by mailbox error 4, though the SII "
                     "announces it",
                     "a scan ends at this slave instead of going on without its object list"},
    QuirkDeclaration{"no-segments", &Quirks::no_segments, kCoe, kCanopen,
                     "A value that does not fit one message is aborted: CoE 06010005h, CANopen "
                     "05040001h",
                     "names (1008h) and EDS cannot be read, and bring-up stops there"},
    QuirkDeclaration{"no-block-transfer", &Quirks::no_block_transfer, kNo, kCanopen,
                     "SDO block transfer is aborted with 05040001h",
                     "firmware or EDS is not loaded by segments instead"},
    QuirkDeclaration{"size-not-indicated", &Quirks::size_not_indicated, kCoe, kCanopen,
                     "Expedited uploads do not say how many of the four bytes count",
                     "an 8-bit object is taken as 32 bits, or the answer as malformed"},
    QuirkDeclaration{"toggle-stuck", &Quirks::toggle_stuck, kCoe, kCanopen,
                     "The toggle bit of segments is 0 in every answer",
                     "the second segment is taken as a repetition of the first, for ever"},
    QuirkDeclaration{"abort-with-size", &Quirks::abort_with_size, kCoe, kCanopen,
                     "The command byte of an abort keeps the size bits of the request: 83h "
                     "instead of 80h",
                     "masters that compare the whole byte wait for an answer until their time is "
                     "over"},
    QuirkDeclaration{
        "short-sdo", &Quirks::short_sdo, kNo, kCanopen,
        "SDO requests without the bytes at their end that carry nothing are taken; "
        "CiA 301 has all eight",
        "a master that leaves them out works with this device, and no other answers it"},
    QuirkDeclaration{"slow-sdo", &Quirks::slow_sdo, kCoe, kCanopen,
                     "SDOs are answered after this time",
                     "a time-out is shorter, and the late answer is taken for that of the next "
                     "request",
                     1, kMinute, 100 * kMillisecond},
    QuirkDeclaration{"no-mailbox-repeat", &Quirks::no_mailbox_repeat, kCoe, kNo,
                     "A repeat request is neither answered nor acknowledged",
                     "after one lost frame the master waits for ever for the toggled bit"},
    QuirkDeclaration{"repeats-executed", &Quirks::repeats_executed, kCoe, kNo,
                     "A mailbox request with the counter of the last one is carried out again",
                     "retried writes act twice, retried segments end the transfer"},
    QuirkDeclaration{"mailbox-counter-zero", &Quirks::mailbox_counter_zero, kCoe, kNo,
                     "The mailbox counter of all answers is 0",
                     "masters that demand counting answers throw them away"},
    QuirkDeclaration{"one-pdo", &Quirks::one_pdo, kCoe, kCanopen,
                     "More than one PDO per direction is refused: CoE 06040042h at the count of "
                     "1C12h or 1C13h, CANopen 06090030h at the COB-ID of a further one",
                     "drives with several axes get half a configuration"},
    QuirkDeclaration{"fixed-mapping", &Quirks::fixed_mapping, kCoe, kCanopen,
                     "PDO mapping objects cannot be written: 06010002h",
                     "the mapping is taken as written, and values land in wrong objects"},
    QuirkDeclaration{"any-process-data-length", &Quirks::any_process_data_length, kCoe, kNo,
                     "Safe-Operational is granted with sync managers 2 and 3 of any length; "
                     "missing outputs read 0, inputs are cut off",
                     "a wrong configuration is found by its effects on the machine only"},
    QuirkDeclaration{"late-boot", &Quirks::late_boot, kCoe, kCanopen,
                     "The device has power only this time after the rack's start, and after each "
                     "power-on event: no link on EtherCAT, no boot-up message on CANopen before",
                     "the network is scanned once, and the device is missing for good", 1, kMinute,
                     3000 * kMillisecond},
    QuirkDeclaration{"no-boot-up-message", &Quirks::no_boot_up_message, kNo, kCanopen,
                     "The node is there without having told so",
                     "masters that wait for boot-up messages never see it"},
    QuirkDeclaration{"wrong-vendor", &Quirks::wrong_vendor, kCoe, kCanopen,
                     "This vendor-ID stands in the SII (EtherCAT) or in 1018h:01 (CANopen)",
                     "the comparison with the configuration is not made, or its result not told", 0,
                     kAny, 0},
    QuirkDeclaration{"wrong-product", &Quirks::wrong_product, kCoe, kCanopen,
                     "This product code stands in the SII or in 1018h:02", "as with wrong-vendor",
                     0, kAny, 0},
    QuirkDeclaration{"wrong-revision", &Quirks::wrong_revision, kCoe, kCanopen,
                     "This revision stands in the SII or in 1018h:03",
                     "a newer firmware of the same product is refused, or an older one accepted", 0,
                     kAny, 0xFFFF},
    QuirkDeclaration{"wrong-name", &Quirks::wrong_name, kCoe, kNo,
                     "This name stands in the SII's strings, by default 40 times the letter X",
                     "buffers for names overflow; devices are told apart by names"},
    QuirkDeclaration{"emergency-storm", &Quirks::emergency_storm, kCoe, kCanopen,
                     "So many emergencies FF77h per second are sent as soon as they can be",
                     "answers drown among emergencies, queues grow, log files fill the disk", 1,
                     10'000, 100},
};

}  // namespace

std::span<const QuirkDeclaration> quirks() {
  return kQuirks;
}

}  // namespace stator::dictionary
