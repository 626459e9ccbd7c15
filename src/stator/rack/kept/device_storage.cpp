#include "stator/rack/kept/device_storage.hpp"

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/sii/sii_image.hpp"
#include "stator/product/device/can_device.hpp"
#include "stator/product/device/ethercat_device.hpp"
#include "stator/rack/kept/board_memory.hpp"
#include "stator/rack/kept/parameter_memory.hpp"

namespace stator::rack {

namespace {

using base::EventArgument;

std::uint16_t alias_of(std::span<const std::byte> sii) {
  return base::load_le<std::uint16_t>(sii, ethercat::sii_word::kStationAlias * 2);
}

std::vector<std::byte> copy_of(std::span<const std::byte> bytes) {
  return {bytes.begin(), bytes.end()};
}

}  // namespace

/// The EEPROM of an EtherCAT slave controller. A word is an order.
class DeviceStorage::EepromMemory final : public KeptMemory, public ethercat::SiiKeeper {
 public:
  EepromMemory(DeviceStorage& storage, const std::string& name, product::EtherCatDevice& device,
               base::EventReporter reporter)
      : KeptMemory(storage, {"eeprom", name, device.description().order_code}, reporter),
        device_(device) {
    if (const auto content = read()) {
      load(*content);
    }
    controller().set_sii_keeper(this);
  }
  ~EepromMemory() override { controller().set_sii_keeper(nullptr); }

  [[nodiscard]] bool keep_sii(std::span<const std::byte> content) override {
    return order(content, ++words_);
  }
  void finish(std::uint32_t version, bool kept, base::SimTime now) override {
    if (version == words_) {
      controller().finish_sii_write(kept, now);
    }
  }
  [[nodiscard]] std::vector<std::byte> content() const override {
    return copy_of(controller().sii());
  }

 private:
  [[nodiscard]] ethercat::SlaveController& controller() const { return device_.controller(); }

  void load(std::span<const std::byte> content) {
    const std::size_t size = controller().sii().size();
    if (content.size() != size) {
      fail(fmt::format("it holds {} bytes, the EEPROM of a {} has {}", content.size(), product(),
                       size));
    }
    // Said first, since loading it may have something to tell of the content.
    reporter().report({}, rules::kEepromRestored, {base::SharedText(path())});
    controller().load_sii(content);
    const std::uint16_t configured = device_.description().station_alias;
    if (configured != 0 && configured != alias_of(content)) {
      reporter().report({}, rules::kAliasOverruled,
                        {base::SharedText(path()), int{configured}, int{alias_of(content)}});
    }
  }

  product::EtherCatDevice& device_;
  std::uint32_t words_ = 0;
};

/// The firmware image in a device's flash memory. A download is an order.
class DeviceStorage::FirmwareImage final : public KeptMemory, public product::FirmwareKeeper {
 public:
  FirmwareImage(DeviceStorage& storage, const std::string& name, const std::string& product,
                product::FirmwareMemory& firmware, base::EventReporter reporter)
      : KeptMemory(storage, {"firmware", name, product}, reporter), firmware_(firmware) {
    if (const auto image = read()) {
      if (!firmware_.restore(*image)) {
        fail(fmt::format("it holds {} bytes, {} takes at most {}", image->size(), product,
                         firmware_.capacity()));
      }
      reporter.report({}, rules::kFirmwareRestored,
                      {base::SharedText(path()), EventArgument(image->size())});
    }
    firmware_.set_keeper(this);
  }
  ~FirmwareImage() override { firmware_.set_keeper(nullptr); }

  bool keep(std::span<const std::byte> image, std::uint32_t download) override {
    return order(image, download);
  }
  void finish(std::uint32_t version, bool kept, base::SimTime /*now*/) override {
    firmware_.finish(version, kept);
  }
  [[nodiscard]] std::vector<std::byte> content() const override {
    return copy_of(firmware_.image());
  }

 private:
  product::FirmwareMemory& firmware_;
};

/// The parameters that a device stores.
class DeviceStorage::StoredParameters final : public KeptMemory, public ParameterKeeper {
 public:
  StoredParameters(DeviceStorage& storage, const std::string& name, const std::string& product,
                   product::Device& device, base::EventReporter reporter)
      : KeptMemory(storage, {"parameters", name, product}, reporter), memory_(*this) {
    if (const auto content = read()) {
      if (!memory_.restore(*content)) {
        fail("its parameter groups are cut off");
      }
      reporter.report({}, rules::kParametersRestored, {base::SharedText(path())});
    }
    device.connect_memory(memory_);
  }

  bool keep_parameters(std::vector<std::byte> content, std::uint32_t version) override {
    return order(content, version);
  }
  void finish(std::uint32_t version, bool kept, base::SimTime /*now*/) override {
    memory_.finish(version, kept);
  }
  [[nodiscard]] std::vector<std::byte> content() const override { return memory_.kept_content(); }

 private:
  ParameterMemory memory_;
};

DeviceStorage::DeviceStorage(const std::string& directory, StateDirectory::Use use)
    : use_(use), directory_(directory, use), writer_(directory_) {}

DeviceStorage::~DeviceStorage() {
  if (use_ == StateDirectory::Use::own) {
    flush(now_);
  }
}

void DeviceStorage::attach(const std::string& name, product::EtherCatDevice& device,
                           base::EventReporter reporter) {
  const std::string& product = device.description().order_code;
  if (device.stores_parameters()) {
    attach_parameters(name, product, device, reporter);
  }
  add(std::make_unique<EepromMemory>(*this, name, device, reporter));
  attach_firmware(name, product, device, reporter);
  for (const board::KeptPart& part : device.kept_parts()) {
    add(std::make_unique<BoardMemory>(*this, name, product, part, reporter));
  }
}

void DeviceStorage::attach(const std::string& name, const std::string& product,
                           product::CanDevice& device, base::EventReporter reporter) {
  attach_parameters(name, product, device, reporter);
  attach_firmware(name, product, device, reporter);
}

void DeviceStorage::attach_parameters(const std::string& name, const std::string& product,
                                      product::Device& device, base::EventReporter reporter) {
  add(std::make_unique<StoredParameters>(*this, name, product, device, reporter));
}

void DeviceStorage::attach_firmware(const std::string& name, const std::string& product,
                                    product::Device& device, base::EventReporter reporter) {
  if (product::FirmwareMemory* firmware = device.firmware()) {
    add(std::make_unique<FirmwareImage>(*this, name, product, *firmware, reporter));
  }
}

void DeviceStorage::add(std::unique_ptr<KeptMemory> memory) {
  memory->number_ = memories_.size();
  memories_.push_back(std::move(memory));
}

void DeviceStorage::note_order() {
  ++orders_;
  busy_.store(true, std::memory_order_release);
}

void DeviceStorage::take_results(base::SimTime now) {
  now_ = now;
  for (const BackgroundWriter::Result& result : writer_.take_results()) {
    KeptMemory& memory = *memories_[result.owner];
    memory.written_ = std::max(memory.written_, result.version);
    memory.kept_ = result.error.empty();
    memory.error_ = result.error;
    memory.retry_ = now + kRetryTime;
    if (!memory.kept_) {
      memory.reporter_.report(now, rules::kNotWritten, {base::SharedText(result.error)});
    }
  }
}

std::vector<StorageCompletion> DeviceStorage::take_completions(base::SimTime now) {
  take_results(now);
  std::vector<StorageCompletion> completions;
  for (const auto& memory : memories_) {
    if (memory->written_ > memory->finished_) {
      completions.push_back({memory->number_, memory->written_, memory->kept_});
    }
  }
  return completions;
}

std::vector<StorageCompletion> DeviceStorage::wait_for_completions(base::SimTime now) {
  writer_.wait();
  return take_completions(now);
}

bool DeviceStorage::complete(const StorageCompletion& completion, base::SimTime now) {
  if (completion.memory >= memories_.size()) {
    return false;
  }
  KeptMemory& memory = *memories_[completion.memory];
  memory.finished_ = std::max(memory.finished_, completion.version);
  memory.finish(completion.version, completion.kept, now);
  if (!completion.kept) {
    memory.error_.clear();  // the device has refused it
    if (completions_ == Completions::recorded && memory.ordered_ == completion.version) {
      try_again(memory);  // the recording's disk failed, but this one may have taken the file
    }
  }
  busy_.store(std::ranges::any_of(memories_,
                                  [](const auto& one) { return one->ordered_ > one->finished_; }),
              std::memory_order_release);
  return true;
}

void DeviceStorage::try_again(KeptMemory& memory) {
  memory.retry_ = base::SimTime::never();
  memory.write(memory.content(), memory.finished_);
}

void DeviceStorage::service(base::SimTime now) {
  take_results(now);
  for (const auto& memory : memories_) {
    const bool settled = memory->ordered_ == memory->finished_;
    if (settled && !memory->error_.empty() && now >= memory->retry_) {
      try_again(*memory);
    }
  }
}

void DeviceStorage::flush(base::SimTime now) {
  writer_.wait();
  take_results(now);
  for (const auto& memory : memories_) {
    if (memory->ordered_ == memory->finished_ && !memory->error_.empty()) {
      try_again(*memory);
    }
  }
  writer_.wait();
  take_results(now);
}

std::vector<std::string> DeviceStorage::unkept() const {
  std::vector<std::string> errors;
  for (const auto& memory : memories_) {
    if (!memory->error_.empty()) {
      errors.push_back(memory->error_);
    }
  }
  return errors;
}

}  // namespace stator::rack
