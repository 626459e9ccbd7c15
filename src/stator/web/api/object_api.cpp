#include "stator/web/api/object_api.hpp"

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/dictionary/description.hpp"
#include "stator/web/api/object_value.hpp"
#include "stator/web/api/request_body.hpp"
#include "stator/web/json_text.hpp"
#include "stator/web/problem.hpp"

namespace stator::web {

namespace {

using dictionary::Entry;
using Json = nlohmann::ordered_json;

/// Entries of a dictionary read in one look at the task queue.
constexpr std::size_t kEntriesAtOnce = 16;

Json declaration_json(const Entry& entry) {
  const dictionary::EntryDescription text = describe(entry);
  Json json{{"index", text.index},     {"subindex", text.subindex},
            {"name", text.name},       {"type", text.data_type},
            {"access", text.access},   {"pdo", text.pdo_mapping},
            {"unit", text.unit},       {"minimum", text.minimum},
            {"maximum", text.maximum}, {"default", text.default_value}};
  return json;
}

Response switched_off(const DeviceRecord& device) {
  return problem(
      409, fmt::format("{} is switched off; its firmware answers when it is on", device.name));
}

class ReadEntriesJob final : public ActJob {
 public:
  ReadEntriesJob(const DeviceRecord& device, std::span<const Entry> entries, bool whole_object)
      : device_(device), entries_(entries), whole_object_(whole_object), results_(entries.size()) {}

  bool act(rack::Rack& rack, base::SimTime /*now*/) override {
    powered_ = rack.powered(device_.address);
    if (!powered_) {
      return true;
    }
    for (std::size_t i = 0; i < kEntriesAtOnce && read_ < entries_.size(); ++i, ++read_) {
      Result& result = results_[read_];
      const auto verdict = rack.read_object(device_.address, entries_[read_], result.value);
      if (!verdict) {
        result.refusal = verdict.error();
      }
    }
    return read_ == entries_.size();
  }

  [[nodiscard]] bool changes() const override { return false; }

  Response response() override {
    if (!powered_) {
      return switched_off(device_);
    }
    if (!whole_object_) {
      return results_[0].refusal ? problem(*results_[0].refusal) : json_response(entry(0));
    }
    Json all = Json::array();
    for (std::size_t i = 0; i < results_.size(); ++i) {
      all.push_back(entry(i));
    }
    return json_response({{"device", device_.name}, {"entries", all}});
  }

 private:
  struct Result {
    std::vector<std::byte> value;
    std::optional<dictionary::Refusal> refusal;
  };

  Json entry(std::size_t i) {
    Json json = declaration_json(entries_[i]);
    json["value"] =
        results_[i].refusal ? Json(nullptr) : to_json(entries_[i].type(), results_[i].value);
    return json;
  }

  const DeviceRecord& device_;
  std::span<const Entry> entries_;
  bool whole_object_;
  std::vector<Result> results_;
  std::size_t read_ = 0;
  bool powered_ = true;
};

/// Answered when an SDO would be: what 1010h stores is kept by then.
class WriteEntryJob final : public ActJob {
 public:
  WriteEntryJob(const DeviceRecord& device, const Entry& entry, std::vector<std::byte> value)
      : device_(device), entry_(entry), value_(std::move(value)) {}

  bool act(rack::Rack& rack, base::SimTime now) override {
    powered_ = rack.powered(device_.address);
    if (!powered_) {
      return true;
    }
    if (!written_) {
      written_ = true;
      time_ = now;
      const auto verdict = rack.write_object(device_.address, entry_, value_, now);
      if (!verdict) {
        refusal_ = verdict.error();
        return true;
      }
    }
    const auto completion = rack.completion_of_write(device_.address, entry_, now);
    under_way_ = !completion;
    if (completion && !*completion) {
      refusal_ = completion->error();
    }
    return true;
  }
  [[nodiscard]] bool changes() const override { return !written_; }
  [[nodiscard]] bool complete() const override { return !powered_ || !under_way_; }
  Response response() override {
    if (!powered_) {
      return switched_off(device_);
    }
    return refusal_ ? problem(*refusal_) : json_response({{"time_ns", time_.nanoseconds()}});
  }

 private:
  const DeviceRecord& device_;
  const Entry& entry_;
  std::vector<std::byte> value_;
  base::SimTime time_;
  bool powered_ = true;
  bool written_ = false;
  bool under_way_ = false;  ///< no SDO would be answered yet
  std::optional<dictionary::Refusal> refusal_;
};

std::optional<std::uint16_t> hexadecimal(const std::string& text, std::uint16_t maximum) {
  std::uint16_t number = 0;
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, number, 16);
  if (result.ec != std::errc() || result.ptr != end || number > maximum) {
    return std::nullopt;
  }
  return number;
}

Response list_objects(const DeviceRecord& device) {
  Json all = Json::array();
  for (const Entry& entry : device.objects->entries()) {
    all.push_back(declaration_json(entry));
  }
  return json_response({{"device", device.name}, {"entries", std::move(all)}});
}

Answer answer_entries(const Match& match, const Request& request, const DeviceRecord& device) {
  const auto index = hexadecimal(match.parameters[1], 0xFFFF);
  const bool one = match.parameters.size() > 2;
  const auto subindex = one ? hexadecimal(match.parameters[2], 0xFF) : std::uint16_t{0};
  if (!index || !subindex) {
    return problem(400, "index and subindex are hexadecimal numbers without \"0x\", e.g. 6041/00");
  }
  if (!one) {
    const dictionary::Object* object = device.objects->find(*index);
    if (object == nullptr) {
      return problem(device.objects->require(*index, 0).error());
    }
    return std::make_unique<ReadEntriesJob>(device, object->entries, true);
  }
  const auto entry = device.objects->require(*index, static_cast<std::uint8_t>(*subindex));
  if (!entry) {
    return problem(entry.error());
  }
  if (!match.route->writes()) {
    return std::make_unique<ReadEntriesJob>(device, std::span(*entry, 1), false);
  }
  const auto value = member_of(request, "value");
  if (const auto* wrong = std::get_if<Response>(&value)) {
    return *wrong;
  }
  auto bytes = to_bytes(**entry, std::get<Json>(value));
  if (!bytes) {
    return problem(bytes.error());
  }
  return std::make_unique<WriteEntryJob>(device, **entry, std::move(*bytes));
}

}  // namespace

Answer answer_objects(const Match& match, const Request& request, const DeviceRecord& device) {
  if (device.objects == nullptr) {
    return problem(404, fmt::format("{} has no object dictionary", device.name));
  }
  if (match.route->operation == Operation::objects) {
    return list_objects(device);
  }
  return answer_entries(match, request, device);
}

}  // namespace stator::web
