#include "rack/device_storage.hpp"

#include <csignal>
#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "base/child_process.hpp"
#include "base/random.hpp"
#include "base/temporary_directory.hpp"
#include "devices/test_bus.hpp"
#include "devices/tmcm_3315/tmcm_3315.hpp"
#include "ethercat/sii_interface.hpp"
#include "rack/event_log.hpp"
#include "rack/product_catalogue.hpp"
#include "rack/rack.hpp"

namespace stator::rack {
namespace {

using namespace base::literals;
using ethercat::FoeError;
using testing::AllOf;
using testing::HasSubstr;
using Bytes = std::vector<std::byte>;

constexpr std::uint32_t kAliasWord = 4;

/// One module with a storage, as a process has them; destroying it is the orderly end.
class Process {
 public:
  explicit Process(const std::string& directory,
                   const devices::Tmcm3315Configuration& configuration = {})
      : device_(configuration), bus_(device_), storage_(directory) {
    log_.set_device_names({"drive"});
    storage_.attach("drive", device_, base::EventReporter(&log_, 0));
  }

  [[nodiscard]] DeviceStorage& storage() { return storage_; }
  [[nodiscard]] devices::FirmwareMemory& firmware() { return *device_.firmware(); }
  [[nodiscard]] EventLog& log() { return log_; }
  [[nodiscard]] Bytes sii() {
    const auto content = device_.controller().sii();
    return {content.begin(), content.end()};
  }
  [[nodiscard]] std::uint16_t alias_register() {
    return base::load_le<std::uint16_t>(bus_.read(0x0012, 2));
  }

  /// One word, as a master writes it.
  void write_sii(std::uint32_t word, std::uint16_t value) {
    Bytes registers(8);
    base::store_le(registers, 0, std::uint16_t{0x0201});
    base::store_le(registers, 2, word);
    base::store_le(registers, 6, value);
    ASSERT_TRUE(bus_.write(0x0502, registers));
    bus_.pass(1_ms);
  }
  void write_alias(std::uint16_t alias) {
    write_sii(kAliasWord, alias);
    write_sii(7, ethercat::sii_checksum(sii()));
  }
  /// A complete download; what the last packet is answered.
  ethercat::FileStore::Commit download(const Bytes& image) {
    EXPECT_EQ(firmware().open_for_writing("image"), FoeError::none);
    EXPECT_EQ(firmware().append(image), FoeError::none);
    return firmware().commit();
  }
  [[nodiscard]] Bytes image() { return {firmware().image().begin(), firmware().image().end()}; }

 private:
  EventLog log_;
  devices::Tmcm3315 device_;
  tests::TestBus bus_;
  DeviceStorage storage_;
};

class DeviceStorageTest : public testing::Test {
 protected:
  [[nodiscard]] bool exists(const std::string& name) const {
    return std::filesystem::exists(path_ + "/" + name);
  }
  void put(const std::string& name, const Bytes& bytes) {
    std::filesystem::create_directory(path_);
    std::ofstream(path_ + "/" + name, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  }
  std::string failure() {
    try {
      Process process(path_);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "started";
  }

  tests::TemporaryDirectory temporary_;
  std::string path_ = temporary_.path() + "/state";
};

TEST_F(DeviceStorageTest, WithoutFiles_TheDeviceStartsFromItsOwnAndNothingIsWritten) {
  const Bytes generated = [] {
    devices::Tmcm3315 device(devices::Tmcm3315Configuration{});
    return Bytes(device.controller().sii().begin(), device.controller().sii().end());
  }();
  {
    Process process(path_);
    EXPECT_EQ(process.sii(), generated);
    process.storage().service(base::SimTime(1_s));
  }
  EXPECT_FALSE(exists("drive.eeprom"));
  EXPECT_FALSE(exists("drive.firmware"));
}

TEST_F(DeviceStorageTest, EepromWrittenOverTheBus_IsThereAfterARestart) {
  Bytes content;
  {
    Process process(path_);
    for (std::uint32_t word = 0x60; word < 0x70; ++word) {
      process.write_sii(word, static_cast<std::uint16_t>(0xA000 + word));
    }
    content = process.sii();
  }
  Process process(path_);
  EXPECT_EQ(process.sii(), content);
  EXPECT_EQ(process.log().count("storage-eeprom-restored"), 1U);
}

TEST_F(DeviceStorageTest, AliasWrittenOverTheBus_IsInForceAfterARestart) {
  {
    Process process(path_);
    process.write_alias(0x1234);
  }
  Process process(path_);
  EXPECT_EQ(process.alias_register(), 0x1234U);
  EXPECT_EQ(process.log().count("storage-alias-overruled"), 0U);
}

TEST_F(DeviceStorageTest, AliasOfTheRackFileAgainstAKeptOne_LosesAndIsTold) {
  {
    Process process(path_);
    process.write_alias(0x1234);
  }
  devices::Tmcm3315Configuration configuration;
  configuration.station_alias = 5;
  Process process(path_, configuration);
  EXPECT_EQ(process.alias_register(), 0x1234U);
  ASSERT_EQ(process.log().count("storage-alias-overruled"), 1U);
  EXPECT_THAT(process.log().line(process.log().events().back()),
              AllOf(HasSubstr("alias 5 of the rack file"), HasSubstr("has alias 4660")));
}

TEST_F(DeviceStorageTest, EepromFile_FollowsWhenNoWordHasComeForTheQuietTime) {
  Process process(path_);
  base::SimTime now(1_s);
  for (std::uint16_t i = 0; i < 10; ++i) {
    process.write_sii(0x60 + i, i);
    process.storage().service(now);
    now += DeviceStorage::kQuietTime - 1_ns;
    process.storage().service(now);
    process.storage().wait();
    EXPECT_FALSE(exists("drive.eeprom")) << "in the middle of a series of writes";
  }
  process.storage().service(now + 1_ns);
  process.storage().wait();
  EXPECT_TRUE(exists("drive.eeprom"));
}

TEST_F(DeviceStorageTest, EepromFileThatCannotBeWritten_IsToldAndTriedAgain) {
  Process process(path_);
  std::filesystem::create_directory(path_ + "/drive.eeprom.new");
  process.write_alias(7);
  const base::SimTime start(1_s);
  process.storage().service(start);
  process.storage().service(start + DeviceStorage::kQuietTime);
  process.storage().wait();
  const base::SimTime failed = start + 200_ms;
  process.storage().service(failed);
  ASSERT_EQ(process.log().count("storage-not-written"), 1U);
  EXPECT_THAT(process.log().line(process.log().events().back()),
              HasSubstr("drive.eeprom: cannot write the file"));
  std::filesystem::remove(path_ + "/drive.eeprom.new");
  process.storage().service(failed + DeviceStorage::kRetryTime);
  process.storage().wait();
  EXPECT_TRUE(exists("drive.eeprom"));
}

TEST_F(DeviceStorageTest, FirmwareImage_IsThereAfterARestart) {
  const Bytes image(100'000, std::byte{0x5A});
  {
    Process process(path_);
    const auto commit = process.download(image);
    EXPECT_FALSE(commit.in_progress);
    EXPECT_EQ(commit.error, FoeError::none);
  }
  Process process(path_);
  EXPECT_EQ(process.image(), image);
  EXPECT_EQ(process.log().count("storage-firmware-restored"), 1U);
}

TEST_F(DeviceStorageTest, UnfinishedDownload_IsGoneAfterARestart) {
  {
    Process process(path_);
    process.download(Bytes(10, std::byte{1}));
    EXPECT_EQ(process.firmware().open_for_writing("image"), FoeError::none);
    EXPECT_EQ(process.firmware().append(Bytes(20, std::byte{2})), FoeError::none);
  }
  EXPECT_EQ(Process(path_).image(), Bytes(10, std::byte{1}));
}

TEST_F(DeviceStorageTest, ConfirmedDownload_EndsWhenItIsOnTheDisk) {
  Process process(path_);
  process.storage().confirm_writes(true);
  EXPECT_TRUE(process.download(Bytes(10, std::byte{1})).in_progress);
  EXPECT_TRUE(process.image().empty());
  process.storage().wait();
  EXPECT_TRUE(exists("drive.firmware"));
  EXPECT_TRUE(process.firmware().commit().in_progress) << "not looked at yet";
  process.storage().service(base::SimTime(1_s));
  EXPECT_FALSE(process.firmware().commit().in_progress);
  EXPECT_EQ(process.image(), Bytes(10, std::byte{1}));
}

TEST_F(DeviceStorageTest, DownloadThatCannotBeKept_EndsWithDiskFullAndTheOldImageStays) {
  Process process(path_);
  process.download(Bytes(10, std::byte{1}));
  process.storage().flush(base::SimTime(1_s));
  process.storage().confirm_writes(true);
  std::filesystem::rename(path_, path_ + ".away");
  EXPECT_TRUE(process.download(Bytes(20, std::byte{2})).in_progress);
  process.storage().wait();
  process.storage().service(base::SimTime(2_s));
  EXPECT_EQ(process.firmware().commit().error, FoeError::disk_full);
  EXPECT_EQ(process.image(), Bytes(10, std::byte{1}));
  EXPECT_EQ(process.log().count("storage-not-written"), 1U);
  std::filesystem::rename(path_ + ".away", path_);
}

TEST_F(DeviceStorageTest, DamagedFile_IsRefusedWithReasonAndRemedy) {
  Bytes file = encode("eeprom", "TMCM-3315", Bytes(2048));
  file.back() ^= std::byte{1};
  put("drive.eeprom", file);
  EXPECT_THAT(failure(), AllOf(HasSubstr("/state/drive.eeprom: device \"drive\" cannot start"),
                               HasSubstr("CRC-32"), HasSubstr("Delete it")));
}

TEST_F(DeviceStorageTest, PlainImage_IsRefusedAsForeign) {
  put("drive.eeprom", Bytes(2048));
  EXPECT_THAT(failure(), HasSubstr("no file that Stator has kept"));
}

TEST_F(DeviceStorageTest, FileOfAnotherProductOrKind_IsRefused) {
  put("drive.eeprom", encode("eeprom", "TMC8461-EVAL", Bytes(2048)));
  EXPECT_THAT(failure(), HasSubstr("the eeprom of a TMC8461-EVAL, the device is a TMCM-3315"));
  put("drive.eeprom", encode("firmware", "TMCM-3315", Bytes(2048)));
  EXPECT_THAT(failure(), HasSubstr("the firmware of a TMCM-3315"));
}

TEST_F(DeviceStorageTest, FileOfAnotherSize_IsRefused) {
  put("drive.eeprom", encode("eeprom", "TMCM-3315", Bytes(4096)));
  EXPECT_THAT(failure(), HasSubstr("holds 4096 bytes, the EEPROM of a TMCM-3315 has 2048"));
  std::filesystem::remove(path_ + "/drive.eeprom");
  put("drive.firmware",
      encode("firmware", "TMCM-3315", Bytes(devices::Tmcm3315::kFirmwareCapacity + 1)));
  EXPECT_THAT(failure(), HasSubstr("at most 2097152"));
}

// A process writes the alias over and over; whenever it is killed, the next one starts.
TEST_F(DeviceStorageTest, KilledAtAnyMoment_TheNextStartFindsACompleteEeprom) {
  base::Random random(7);
  for (int round = 0; round < 20; ++round) {
    int announcements[2];
    ASSERT_EQ(::pipe(announcements), 0);
    tests::ChildProcess child = tests::ChildProcess::fork([&] {
      Process process(path_);
      for (std::uint16_t alias = 1;; ++alias) {
        process.write_alias(alias);
        process.storage().flush(base::SimTime(1_s));
        if (::write(announcements[1], "x", 1) != 1) {
          ::_exit(1);
        }
      }
    });
    char announcement = 0;
    for (std::uint64_t i = 0; i < 1 + random.below(5); ++i) {
      ASSERT_EQ(::read(announcements[0], &announcement, 1), 1);
    }
    ::usleep(static_cast<useconds_t>(random.below(1000)));
    child.signal(SIGKILL);
    child.wait();
    ::close(announcements[0]);
    ::close(announcements[1]);
    Process process(path_);
    const Bytes content = process.sii();
    EXPECT_EQ(std::to_integer<std::uint8_t>(content[14]), ethercat::sii_checksum(content));
    EXPECT_NE(process.alias_register(), 0U);
  }
}

TEST_F(DeviceStorageTest, Rack_KeepsEachDeviceUnderItsName) {
  RackConfiguration configuration = single_device_rack("tmcm-3315");
  auto& members = configuration.segments.front().devices;
  members.push_back(members.front());
  members[0].name = "left";
  members[1].name = "right/hand";
  configuration.state = path_;
  {
    EventLog log;
    Rack rack(configuration, log);
    ASSERT_NE(rack.storage(), nullptr);
    devices::FirmwareMemory& firmware = *rack.devices(0)[1].device->firmware();
    ASSERT_EQ(firmware.open_for_writing("x"), FoeError::none);
    ASSERT_EQ(firmware.append(Bytes(5, std::byte{9})), FoeError::none);
    ASSERT_FALSE(firmware.commit().in_progress);
  }
  EXPECT_TRUE(exists("right%2Fhand.firmware"));
  EventLog log;
  Rack rack(configuration, log);
  EXPECT_TRUE(rack.devices(0)[0].device->firmware()->image().empty());
  EXPECT_EQ(rack.devices(0)[1].device->firmware()->image().size(), 5U);
  EXPECT_THAT(log.line(log.events().back()), HasSubstr("right/hand: firmware image of 5 bytes"));
}

TEST_F(DeviceStorageTest, RackWithoutAStateDirectory_KeepsNothing) {
  EventLog log;
  Rack rack(single_device_rack("tmcm-3315"), log);
  EXPECT_EQ(rack.storage(), nullptr);
}

}  // namespace
}  // namespace stator::rack
