// What of EEPROM, firmware and parameters is on the disk after restarts, failures and kills.
#include "stator/rack/kept/device_storage.hpp"

#include <array>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "base/child_process.hpp"
#include "base/temporary_directory.hpp"
#include "devices/test_bus.hpp"
#include "rack/own_device.hpp"
#include "stator/base/random.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/devices/tmcm_3315/tmcm_3315.hpp"
#include "stator/ethercat/units/sii_interface.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/core/named_device.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/observe/event_log.hpp"

namespace stator::rack {
namespace {

using namespace base::literals;
using ethercat::FoeError;
using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;
using Bytes = std::vector<std::byte>;

constexpr std::uint32_t kAliasWord = 4;
constexpr unsigned kBusy = 0x8000;
constexpr unsigned kNoAcknowledge = 0x2000;
constexpr std::size_t kEepromNumber = 0;  ///< of a TMCM-3315's memories

/// The EEPROM file of a directory that another process uses, as the next start would find it.
class Copy {
 public:
  explicit Copy(const std::string& directory) {
    std::filesystem::copy(directory, folder_.path() + "/state");
    std::filesystem::remove(folder_.path() + "/state/lock");
  }
  [[nodiscard]] Bytes content() const;

 private:
  tests::TemporaryDirectory folder_;
};

/// One module with a storage, as a process has them; destroying it is the orderly end.
class Process {
 public:
  explicit Process(
      const std::string& directory, const devices::Tmcm3315Configuration& configuration = {},
      DeviceStorage::Completions completions = DeviceStorage::Completions::when_durable)
      : device_(configuration), bus_(device_), storage_(directory) {
    log_.set_device_names({"drive"});
    storage_.set_completions(completions);
    storage_.attach("drive", device_, base::EventReporter(&log_, 0));
  }

  [[nodiscard]] DeviceStorage& storage() { return storage_; }
  [[nodiscard]] product::FirmwareMemory& firmware() { return *device_.firmware(); }
  [[nodiscard]] EventLog& log() { return log_; }
  [[nodiscard]] Bytes sii() {
    const auto content = device_.controller().sii();
    return {content.begin(), content.end()};
  }
  [[nodiscard]] std::uint16_t alias_register() {
    return base::load_le<std::uint16_t>(bus_.read(0x0012, 2));
  }

  /// Waits for the disk, as a rack does in lockstep; how many completions came.
  std::size_t finish() {
    const auto completions = storage_.wait_for_completions(bus_.now());
    for (const StorageCompletion& completion : completions) {
      EXPECT_TRUE(storage_.complete(completion, bus_.now()));
    }
    return completions.size();
  }
  [[nodiscard]] unsigned sii_status() {
    return base::load_le<std::uint16_t>(bus_.read(0x0502, 2)) & 0xF800U;
  }
  [[nodiscard]] std::uint16_t kept_word(std::uint32_t word) {
    return base::load_le<std::uint16_t>(sii(), std::size_t{2} * word);
  }

  /// One word, as a master writes it, until the device is no longer busy.
  void write_sii(std::uint32_t word, std::uint16_t value) {
    order_sii(word, value);
    finish();
    bus_.pass(1_ms);
  }
  void order_sii(std::uint32_t word, std::uint16_t value) {
    Bytes registers(8);
    base::store_le(registers, 0, std::uint16_t{0x0201});
    base::store_le(registers, 2, word);
    base::store_le(registers, 6, value);
    ASSERT_TRUE(bus_.write(0x0502, registers));
  }
  void pass(base::SimDuration duration) { bus_.pass(duration); }
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

Bytes Copy::content() const {
  return Process(folder_.path() + "/state").sii();
}

class DeviceStorageTest : public testing::Test {
 protected:
  ~DeviceStorageTest() override { bring_directory_back(); }
  /// From now on nothing can be written.
  void take_directory_away() {
    for (const char* kind : kKinds) {
      std::filesystem::create_directory(path_ + "/drive." + kind + ".new");
    }
    std::filesystem::rename(path_, path_ + ".away");
    away_ = true;
  }
  void bring_directory_back() {
    if (!std::exchange(away_, false)) {
      return;
    }
    std::filesystem::rename(path_ + ".away", path_);
    for (const char* kind : kKinds) {
      std::filesystem::remove(path_ + "/drive." + kind + ".new");
    }
  }
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

 private:
  static constexpr std::array kKinds{"eeprom", "firmware", "parameters"};
  bool away_ = false;
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
  configuration.coe.station_alias = 5;
  Process process(path_, configuration);
  EXPECT_EQ(process.alias_register(), 0x1234U);
  ASSERT_EQ(process.log().count("storage-alias-overruled"), 1U);
  EXPECT_THAT(process.log().line(process.log().events().back()),
              AllOf(HasSubstr("alias 5 of the rack file"), HasSubstr("has alias 4660")));
}

TEST_F(DeviceStorageTest, EepromWord_IsBusyUntilItIsOnTheDisk) {
  Process process(path_);
  process.order_sii(0x60, 0x1234);
  process.pass(100_ms);
  EXPECT_EQ(process.sii_status(), kBusy);
  EXPECT_TRUE(process.storage().busy());
  EXPECT_EQ(process.finish(), 1U);
  EXPECT_EQ(process.sii_status(), 0U);
  EXPECT_FALSE(process.storage().busy());
  EXPECT_EQ(process.kept_word(0x60), 0x1234);
  EXPECT_EQ(Copy(path_).content(), process.sii()) << "and the file has it";
  EXPECT_EQ(process.finish(), 0U) << "it ends once";
}

TEST_F(DeviceStorageTest, EepromWordThatCannotBeKept_IsNotAcknowledgedAndTold) {
  Process process(path_);
  process.write_sii(0x60, 1);
  const Bytes before = process.sii();
  take_directory_away();
  process.write_sii(0x60, 2);
  EXPECT_EQ(process.sii_status(), kNoAcknowledge);
  EXPECT_EQ(process.sii(), before);
  ASSERT_EQ(process.log().count("storage-not-written"), 1U);
  EXPECT_THAT(process.log().line(process.log().events().back()), HasSubstr("drive.eeprom"));
  EXPECT_TRUE(process.storage().unkept().empty()) << "the master knows";
  bring_directory_back();
  EXPECT_EQ(Copy(path_).content(), before);
  process.write_sii(0x60, 3);
  EXPECT_EQ(process.sii_status(), 0U);
  EXPECT_EQ(process.kept_word(0x60), 3U);
}

TEST_F(DeviceStorageTest, FirmwareImage_IsThereAfterARestart) {
  const Bytes image(100'000, std::byte{0x5A});
  {
    Process process(path_);
    EXPECT_TRUE(process.download(image).in_progress);
    process.finish();
    const auto commit = process.firmware().commit();
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

TEST_F(DeviceStorageTest, OrderThatTheEndOfTheRunOvertakes_IsOnTheDiskAllTheSame) {
  {
    Process process(path_);
    process.download(Bytes(10, std::byte{1}));
  }
  EXPECT_EQ(Process(path_).image(), Bytes(10, std::byte{1}));
}

TEST_F(DeviceStorageTest, Download_EndsWhenItIsOnTheDisk) {
  Process process(path_);
  EXPECT_TRUE(process.download(Bytes(10, std::byte{1})).in_progress);
  EXPECT_TRUE(process.image().empty());
  process.storage().flush(base::SimTime(1_s));
  EXPECT_TRUE(exists("drive.firmware"));
  EXPECT_TRUE(process.firmware().commit().in_progress) << "the device has not heard of it";
  EXPECT_EQ(process.finish(), 1U);
  EXPECT_FALSE(process.firmware().commit().in_progress);
  EXPECT_EQ(process.image(), Bytes(10, std::byte{1}));
}

TEST_F(DeviceStorageTest, DownloadThatCannotBeKept_EndsWithDiskFullAndTheOldImageStays) {
  Process process(path_);
  process.download(Bytes(10, std::byte{1}));
  process.finish();
  take_directory_away();
  EXPECT_TRUE(process.download(Bytes(20, std::byte{2})).in_progress);
  process.finish();
  EXPECT_EQ(process.firmware().commit().error, FoeError::disk_full);
  EXPECT_EQ(process.image(), Bytes(10, std::byte{1}));
  EXPECT_EQ(process.log().count("storage-not-written"), 1U);
  EXPECT_TRUE(process.storage().unkept().empty());
  bring_directory_back();
}

TEST_F(DeviceStorageTest, OrdersThatCountAtOnce_AreTriedAgainAndMissedAtTheEnd) {
  Process process(path_, {}, DeviceStorage::Completions::at_once);
  take_directory_away();
  EXPECT_FALSE(process.download(Bytes(10, std::byte{1})).in_progress);
  EXPECT_FALSE(process.storage().busy());
  process.storage().flush(base::SimTime(1_s));
  ASSERT_EQ(process.storage().unkept().size(), 1U);
  EXPECT_THAT(process.storage().unkept().front(), HasSubstr("drive.firmware"));
  const auto told = process.log().count("storage-not-written");
  process.storage().service(base::SimTime(1_s) + DeviceStorage::kRetryTime - 1_ns);
  bring_directory_back();
  process.storage().service(base::SimTime(1_s) + DeviceStorage::kRetryTime);
  EXPECT_EQ(process.finish(), 0U) << "the device has taken it for kept long ago";
  EXPECT_TRUE(process.storage().unkept().empty());
  EXPECT_EQ(process.log().count("storage-not-written"), told);
  EXPECT_TRUE(exists("drive.firmware"));
}

TEST_F(DeviceStorageTest, RecordedFailure_IsTheDevicesAndTheFilesWhateverThisDiskDid) {
  Process process(path_, {}, DeviceStorage::Completions::recorded);
  process.order_sii(0x60, 1);
  EXPECT_TRUE(process.storage().complete({kEepromNumber, 1, true}, {}));
  process.pass(1_ms);
  const Bytes before = process.sii();
  process.order_sii(0x60, 2);
  process.storage().flush({});
  EXPECT_NE(Copy(path_).content(), before);
  EXPECT_TRUE(process.storage().complete({kEepromNumber, 2, false}, {}));
  process.pass(1_ms);
  EXPECT_EQ(process.sii_status(), kNoAcknowledge);
  EXPECT_EQ(process.sii(), before);
  process.storage().flush({});
  EXPECT_EQ(Copy(path_).content(), before);
  EXPECT_FALSE(process.storage().complete({99, 1, true}, {}));
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

// A process writes a word over and over and tells of each that the device is done with.
TEST_F(DeviceStorageTest, KilledAtAnyMoment_TheNextStartFindsWhatWasAnswered) {
  base::Random random(7);
  for (int round = 0; round < 20; ++round) {
    int announcements[2];
    ASSERT_EQ(::pipe(announcements), 0);
    tests::ChildProcess child = tests::ChildProcess::fork([&] {
      Process process(path_);
      for (std::uint16_t value = 1;; ++value) {
        process.write_sii(0x60, value);
        if (process.sii_status() != 0 ||
            ::write(announcements[1], &value, sizeof(value)) != sizeof(value)) {
          ::_exit(1);
        }
      }
    });
    ::close(announcements[1]);
    std::uint16_t answered = 0;
    for (std::uint64_t i = 0; i < 1 + random.below(5); ++i) {
      ASSERT_EQ(::read(announcements[0], &answered, sizeof(answered)), 2);
    }
    ::usleep(static_cast<useconds_t>(random.below(1000)));
    child.signal(SIGKILL);
    child.wait();
    while (::read(announcements[0], &answered, sizeof(answered)) == 2) {
    }
    ::close(announcements[0]);
    EXPECT_THAT(Process(path_).kept_word(0x60), AnyOf(answered, answered + 1));
  }
}

TEST_F(DeviceStorageTest, Rack_KeepsEachDeviceUnderItsName) {
  RackConfiguration configuration = single_device_rack("tmcm-3315", devices::products());
  auto& members = configuration.segments.front().devices;
  members.push_back(members.front());
  members[0].name = "left";
  members[1].name = "right/hand";
  configuration.state = path_;
  {
    EventLog log;
    Rack rack(configuration, log);
    ASSERT_NE(rack.storage(), nullptr);
    product::FirmwareMemory& firmware =
        *tests::own<product::EtherCatDevice>(rack.device({0, 1, NetworkKind::segment})).firmware();
    ASSERT_EQ(firmware.open_for_writing("x"), FoeError::none);
    ASSERT_EQ(firmware.append(Bytes(5, std::byte{9})), FoeError::none);
    ASSERT_TRUE(firmware.commit().in_progress);
    rack.advance(base::SimTime(1_ms));
    ASSERT_FALSE(firmware.commit().in_progress) << "time moves when it is kept";
  }
  EXPECT_TRUE(exists("right%2Fhand.firmware"));
  EventLog log;
  Rack rack(configuration, log);
  EXPECT_TRUE(tests::own<product::EtherCatDevice>(rack.device({0, 0, NetworkKind::segment}))
                  .firmware()
                  ->image()
                  .empty());
  EXPECT_EQ(tests::own<product::EtherCatDevice>(rack.device({0, 1, NetworkKind::segment}))
                .firmware()
                ->image()
                .size(),
            5U);
  EXPECT_THAT(log.line(log.events().back()), HasSubstr("right/hand: firmware image of 5 bytes"));
}

TEST_F(DeviceStorageTest, RackWithoutAStateDirectory_KeepsNothing) {
  EventLog log;
  Rack rack(single_device_rack("tmcm-3315", devices::products()), log);
  EXPECT_EQ(rack.storage(), nullptr);
}

}  // namespace
}  // namespace stator::rack
