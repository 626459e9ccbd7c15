#include <cstdlib>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "devices/csv.hpp"
#include "source_paths.hpp"
#include "stator/bench/local_port.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/dictionary/data_type.hpp"
#include "stator/master/master.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/observe/event_log.hpp"

namespace stator::rack {
namespace {

/// Columns of tests/data/tmcm-3315/objects.csv.
enum Column : std::size_t {
  index,
  subindex,
  name,
  object_type,
  data_type,
  access,
  mapping,
  standard,
  minimum,
  maximum
};

/// A number of the table as an SDO carries it; nothing for an empty cell.
std::vector<std::byte> little_endian(const std::string& cell, std::size_t size) {
  std::vector<std::byte> bytes;
  if (cell.empty()) {
    return bytes;
  }
  const auto bits = cell.starts_with('-')
                        ? static_cast<std::uint64_t>(std::strtoll(cell.c_str(), nullptr, 0))
                        : std::strtoull(cell.c_str(), nullptr, 0);
  for (std::size_t i = 0; i < size; ++i) {
    bytes.push_back(static_cast<std::byte>(bits >> (8 * i)));
  }
  return bytes;
}

std::string access_of(std::uint16_t flags) {
  return (flags & 0x38) == 0 ? "read only" : "read write";
}

std::string mapping_of(std::uint16_t flags) {
  const bool receive = (flags & 0x40) != 0;
  const bool transmit = (flags & 0x80) != 0;
  return receive ? (transmit ? "rxtx" : "rx") : (transmit ? "tx" : "no");
}

TEST(SdoInformation, EveryEntryOfTheTmcm3315IsReportedAsTheTableHasIt) {
  const RackConfiguration configuration = single_device_rack("tmcm-3315", devices::products());
  EventLog log;
  Rack rack(configuration, log);
  bench::LocalPort port(rack, 0, configuration.cycle, configuration.step);
  master::Master master(port);
  ASSERT_TRUE(master.scan());
  ASSERT_TRUE(master.start_mailbox(0));

  std::ifstream file(STATOR_TEST_DATA "/tmcm-3315/objects.csv");
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  const auto rows = tests::parse_csv(text);
  ASSERT_EQ(rows.size(), 435U);
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const tests::CsvRow& row = rows[i];
    SCOPED_TRACE(row[index] + "h:" + row[subindex]);
    const auto entry =
        master.entry_description(0, static_cast<std::uint16_t>(std::stoul(row[index], nullptr, 16)),
                                 static_cast<std::uint8_t>(std::stoul(row[subindex], nullptr, 16)));
    ASSERT_TRUE(entry) << entry.error().text;
    const auto type = static_cast<dictionary::DataType>(entry->data_type);
    EXPECT_EQ(entry->name, row[name]);
    EXPECT_EQ(to_text(type), row[data_type]);
    EXPECT_EQ(access_of(entry->access), row[access] == "rw" ? "read write" : "read only");
    EXPECT_EQ(mapping_of(entry->access), row[mapping]);
    if (is_string(type)) {
      continue;
    }
    EXPECT_EQ(entry->bit_length, dictionary::bit_length(type));
    const std::size_t size = dictionary::byte_length(type);
    if (!row[standard].empty()) {
      EXPECT_EQ(entry->default_value, little_endian(row[standard], size));
    }
    EXPECT_EQ(entry->minimum, little_endian(row[minimum], size));
    EXPECT_EQ(entry->maximum, little_endian(row[maximum], size));
  }
}

}  // namespace
}  // namespace stator::rack
