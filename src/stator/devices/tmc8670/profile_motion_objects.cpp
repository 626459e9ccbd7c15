#include <array>

#include "stator/devices/tmc8670/object_groups.hpp"
#include "stator/drive/modes/homing_methods.hpp"

namespace stator::devices::tmc8670 {

namespace {

using dictionary::EntryDeclaration;
using enum dictionary::DataType;
using enum dictionary::ObjectCode;
using enum dictionary::Access;
using enum dictionary::PdoMapping;

// Targets, limits, motion profile.
constexpr auto kProfileMotion = std::to_array<EntryDeclaration>({
    entry(0x607A, 0, "Target position", variable, integer32, read_write, receive, 0,
          "position units", kProfile),
    entry(0x607C, 0, "Home offset", variable, integer32, read_write, no, 0, "position units",
          kProfile),
    titled("Software position limit", entry(0x607D, 0, "Software position limit: number of entries",
                                            array, unsigned8, read_only, no, 2, "", kProfile)),
    entry(0x607D, 1, "Software position limit: minimum", array, integer32, read_write, no,
          kLowest32, "", kProfile),
    entry(0x607D, 2, "Software position limit: maximum", array, integer32, read_write, no,
          2147483647, "", kProfile),
    entry(0x607E, 0, "Polarity", variable, unsigned8, read_write, no, 0, "", kProfile),
    entry(0x607F, 0, "Max profile velocity", variable, unsigned32, read_write, no, 4000, "rpm",
          kProfile),
    entry(0x6080, 0, "Max motor speed", variable, unsigned32, read_write, no, 4000, "rpm",
          kProfile),
    entry(0x6081, 0, "Profile velocity", variable, unsigned32, read_write, receive, 1000, "rpm",
          kProfile),
    entry(0x6083, 0, "Profile acceleration", variable, unsigned32, read_write, receive, 1000,
          "rpm/s", kProfile),
    entry(0x6084, 0, "Profile deceleration", variable, unsigned32, read_write, receive, 1000,
          "rpm/s", kProfile),
    entry(0x6085, 0, "Quick stop deceleration", variable, unsigned32, read_write, no, 5000, "rpm/s",
          kProfile),
    entry(0x6086, 0, "Motion profile type", variable, integer16, read_write, no, 0, "", kProfile),
    entry(0x6087, 0, "Torque slope", variable, unsigned32, read_write, no, 1000, "0.1 %/s",
          kProfile),
});

/// What 6098h takes: no method, or one there is.
constexpr auto kHomingCodes = [] {
  std::array<std::int64_t, drive::kHomingMethods.size() + 1> codes{};
  for (std::size_t k = 0; k < drive::kHomingMethods.size(); ++k) {
    codes[k + 1] = int{drive::kHomingMethods[k].code};
  }
  return codes;
}();

// Encoder, homing.
constexpr auto kHoming = std::to_array<EntryDeclaration>({
    titled("Position encoder resolution",
           entry(0x608F, 0, "Position encoder resolution: number of entries", array, unsigned8,
                 read_only, no, 2, "", kProfile)),
    entry(0x608F, 1, "Position encoder resolution: encoder increments", array, unsigned32,
          read_write, no, 65536, "", kProfile),
    entry(0x608F, 2, "Position encoder resolution: motor revolutions", array, unsigned32,
          read_write, no, 1, "", kProfile),
    one_of(kHomingCodes,
           entry(0x6098, 0, "Homing method", variable, integer8, read_write, no, 0, "",
                 "CiA 402 / IEC 61800-7-201; 3 reference switches H L R and index N are present "
                 "(L390; L399-L401)")),
    titled("Homing speeds", entry(0x6099, 0, "Homing speeds: number of entries", array, unsigned8,
                                  read_only, no, 2, "", kProfile)),
    entry(0x6099, 1, "Homing speeds: switch search", array, unsigned32, read_write, no, 100, "rpm",
          kProfile),
    entry(0x6099, 2, "Homing speeds: zero search", array, unsigned32, read_write, no, 10, "rpm",
          kProfile),
    entry(0x609A, 0, "Homing acceleration", variable, unsigned32, read_write, no, 1000, "rpm/s",
          kProfile),
});

// Offsets and interpolation of the cyclic modes.
constexpr auto kCyclic = std::to_array<EntryDeclaration>({
    entry(0x60B0, 0, "Position offset", variable, integer32, read_write, receive, 0,
          "position units", kProfile),
    entry(0x60B1, 0, "Velocity offset", variable, integer32, read_write, receive, 0, "rpm",
          kProfile),
    entry(0x60B2, 0, "Torque offset", variable, integer16, read_write, receive, 0, "0.1 %",
          kProfile),
    titled("Interpolation time period",
           entry(0x60C2, 0, "Interpolation time period: number of entries", record, unsigned8,
                 constant, no, 2, "", kProfile)),
    entry(0x60C2, 1, "Interpolation time period: value", record, unsigned8, read_write, no, 1, "",
          kProfile),
    entry(0x60C2, 2, "Interpolation time period: index", record, integer8, read_write, no, -3, "",
          kProfile),
    entry(0x60F4, 0, "Following error actual value", variable, integer32, read_only, transmit, 0,
          "position units", kProfile),
});

// Beyond objects_recommended.csv: what profile position and the touch probe work with.
constexpr std::string_view kBeyond =
    "CiA 402 / IEC 61800-7-201; not recommended by objects_recommended.csv";
constexpr auto kMoreProfileMotion = std::to_array<EntryDeclaration>({
    entry(0x6082, 0, "End velocity", variable, unsigned32, read_write, receive, 0, "rpm", kBeyond),
    entry(0x60F2, 0, "Positioning option code", variable, unsigned16, read_write, receive, 0, "",
          kBeyond),
});
/// 60E3h: each method of 6098h.
constexpr auto kSupportedHoming = [] {
  constexpr std::size_t kCount = drive::kHomingMethods.size();
  std::array<EntryDeclaration, kCount + 1> rows{};
  rows[0] = titled("Supported homing methods",
                   entry(0x60E3, 0, "Supported homing methods: number of entries", array, unsigned8,
                         read_only, no, std::int64_t{kCount}, "", kBeyond));
  for (std::size_t k = 0; k < kCount; ++k) {
    rows[k + 1] =
        entry(0x60E3, static_cast<std::uint8_t>(k + 1), "Supported homing methods: method", array,
              integer8, read_only, no, std::int64_t{drive::kHomingMethods[k].code}, "", kBeyond);
  }
  return rows;
}();
constexpr auto kTouchProbe = std::to_array<EntryDeclaration>({
    entry(0x60B8, 0, "Touch probe function", variable, unsigned16, read_write, receive, 0, "",
          kBeyond),
    entry(0x60B9, 0, "Touch probe status", variable, unsigned16, read_only, transmit, 0, "",
          kBeyond),
    entry(0x60BA, 0, "Touch probe 1 positive edge", variable, integer32, read_only, transmit, 0,
          "position units", kBeyond),
    entry(0x60BB, 0, "Touch probe 1 negative edge", variable, integer32, read_only, transmit, 0,
          "position units", kBeyond),
    entry(0x60BC, 0, "Touch probe 2 positive edge", variable, integer32, read_only, transmit, 0,
          "position units", kBeyond),
    entry(0x60BD, 0, "Touch probe 2 negative edge", variable, integer32, read_only, transmit, 0,
          "position units", kBeyond),
    titled("Touch probe source", entry(0x60D0, 0, "Touch probe source: number of entries", array,
                                       unsigned8, read_only, no, 2, "", kBeyond)),
    entry(0x60D0, 1, "Touch probe source: probe 1", array, integer16, read_write, no, 1, "",
          kBeyond),
    entry(0x60D0, 2, "Touch probe source: probe 2", array, integer16, read_write, no, 2, "",
          kBeyond),
    entry(0x60D1, 0, "Touch probe time stamp 1 positive edge", variable, unsigned32, read_only,
          transmit, 0, "ns", kBeyond),
    entry(0x60D2, 0, "Touch probe time stamp 1 negative edge", variable, unsigned32, read_only,
          transmit, 0, "ns", kBeyond),
    entry(0x60D3, 0, "Touch probe time stamp 2 positive edge", variable, unsigned32, read_only,
          transmit, 0, "ns", kBeyond),
    entry(0x60D4, 0, "Touch probe time stamp 2 negative edge", variable, unsigned32, read_only,
          transmit, 0, "ns", kBeyond),
});

}  // namespace

void add_profile_motion_objects(dictionary::Dictionary& dictionary) {
  dictionary.add(kProfileMotion);
  dictionary.add(kHoming);
  dictionary.add(kCyclic);
  dictionary.add(kMoreProfileMotion);
  dictionary.add(kSupportedHoming);
  dictionary.add(kTouchProbe);
}

}  // namespace stator::devices::tmc8670
