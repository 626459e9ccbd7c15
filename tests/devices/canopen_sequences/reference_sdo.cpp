// The SDO server of the reference (CiA 301 §7.2.4), and the values that can be written.

#include <algorithm>
#include <cstdio>

#include "base/byte_order.hpp"
#include "devices/canopen_sequences/reference_node.hpp"

namespace stator::tests {

namespace {

constexpr std::uint32_t kToggle = 0x05030000;
constexpr std::uint32_t kTimeout = 0x05040000;
constexpr std::uint32_t kCommand = 0x05040001;
constexpr std::uint32_t kWriteOnlyRead = 0x06010002;
constexpr std::uint32_t kNoObject = 0x06020000;
constexpr std::uint32_t kNotMappable = 0x06040041;
constexpr std::uint32_t kPdoLength = 0x06040042;
constexpr std::uint32_t kLength = 0x06070010;
constexpr std::uint32_t kTooLong = 0x06070012;
constexpr std::uint32_t kTooShort = 0x06070013;
constexpr std::uint32_t kNoSubindex = 0x06090011;
constexpr std::uint32_t kRange = 0x06090030;
constexpr std::uint32_t kTooHigh = 0x06090031;
constexpr std::uint32_t kTooLow = 0x06090032;
constexpr std::uint32_t kCannotStore = 0x08000020;
constexpr std::uint32_t kDeviceState = 0x08000022;

constexpr std::uint32_t kSave = 0x65766173;
constexpr std::uint32_t kLoad = 0x64616F6C;

using Bytes = std::array<std::uint8_t, 8>;

std::uint8_t byte(const can::Frame& frame, std::size_t position) {
  return std::to_integer<std::uint8_t>(frame.data[position]);
}

bool is_signed(const ObjectUnderTest& object) {
  return object.low < 0;
}

std::int64_t as_number(const ObjectUnderTest& object, std::uint32_t raw) {
  return is_signed(object) ? std::int64_t{static_cast<std::int32_t>(raw)} : std::int64_t{raw};
}

std::uint32_t masked(std::uint32_t raw, std::size_t size) {
  return size >= 4 ? raw : raw & ((1U << 8 * size) - 1);
}

bool readable_only(ObjectRule rule) {
  return rule == ObjectRule::constant || rule == ObjectRule::live || rule == ObjectRule::text ||
         rule == ObjectRule::error_register;
}

bool restricted(std::uint32_t can_id) {
  return can_id <= 0x7F || (can_id >= 0x101 && can_id <= 0x180) ||
         (can_id >= 0x581 && can_id <= 0x5FF) || (can_id >= 0x601 && can_id <= 0x67F) ||
         can_id >= 0x6E0;
}

}  // namespace

std::uint32_t ReferenceNode::value(std::uint16_t index, std::uint8_t subindex) const {
  const auto found = values_.find({index, subindex});
  return found == values_.end() ? 0 : found->second;
}

void ReferenceNode::end_transfer() {
  transfer_ = Transfer::none;
  transferred_ = nullptr;
  transfer_ends_ = Time::never();
}

void ReferenceNode::hear_sdo(const can::Frame& frame, Time now) {
  if (frame.length != 8) {
    return;
  }
  const std::uint8_t command = byte(frame, 0);
  if (command == 0x80) {
    end_transfer();
    return;
  }
  requested_ = {byte(frame, 1), byte(frame, 2), byte(frame, 3)};
  const auto specifier = command >> 5;
  switch (specifier) {
    case 0:
      answer_ = download_segment(frame, now);
      break;
    case 1:
      answer_ = initiate_download(frame, now);
      break;
    case 2:
      answer_ = initiate_upload(frame);
      break;
    case 3:
      answer_ = upload_segment(frame);
      break;
    default:
      end_transfer();
      answer_ = Answer{.aborts = {kCommand}, .names_object = false};
      break;
  }
  transfer_ends_ = transfer_ == Transfer::none ? Time::never() : now + options_.sdo_timeout;
}

namespace {

/// Nothing: there is such an object.
std::set<std::uint32_t> missing(const ObjectUnderTest* object, std::uint16_t index) {
  if (object == nullptr) {
    return {kNoObject, kNoSubindex};  // not known here: either is precise
  }
  static_cast<void>(index);
  if (object->rule == ObjectRule::no_object) {
    return {kNoObject};
  }
  if (object->rule == ObjectRule::no_subindex) {
    return {kNoSubindex};
  }
  return {};
}

Bytes initiated(const can::Frame& frame, std::uint8_t command) {
  return {command, byte(frame, 1), byte(frame, 2), byte(frame, 3)};
}

void put(Bytes& bytes, std::size_t at, std::uint32_t value, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) {
    bytes[at + i] = static_cast<std::uint8_t>(value >> 8 * i);
  }
}

}  // namespace

ReferenceNode::Answer ReferenceNode::initiate_upload(const can::Frame& frame) {
  end_transfer();
  const auto index = base::load_le<std::uint16_t>(frame.data, 1);
  const ObjectUnderTest* object = find_object(index, byte(frame, 3));
  if (const auto aborts = missing(object, index); !aborts.empty()) {
    return {.aborts = aborts};
  }
  if (object->rule == ObjectRule::text) {
    transfer_ = Transfer::upload;
    transferred_ = object;
    offset_ = 0;
    toggle_ = false;
    Bytes bytes = initiated(frame, 0x41);
    put(bytes, 4, static_cast<std::uint32_t>(object->content.size()), 4);
    return {.success = bytes};
  }
  Bytes bytes = initiated(frame, static_cast<std::uint8_t>(0x43 | (4 - object->size) << 2));
  put(bytes, 4, value(object->index, object->subindex), object->size);
  Answer answer{.success = bytes};
  const bool open = object->rule == ObjectRule::live ||
                    object->rule == ObjectRule::error_register ||
                    object->rule == ObjectRule::store || object->rule == ObjectRule::restore;
  if (open) {
    answer.open_bytes = 0xF0;
  }
  if (object->rule == ObjectRule::error_register) {
    answer.on_success = [this](const can::Frame& reply) {
      std::uint8_t certain = 0;
      std::uint8_t possible = 0;
      for (const auto& [key, error] : errors_) {
        certain |= error.certain ? error.bits : 0;
        possible |= error.bits;
      }
      const std::uint8_t shown = byte(reply, 4);
      if ((shown & certain) != certain || (shown & ~possible) != 0) {
        std::string lasting;
        for (const auto& [key, error] : errors_) {
          lasting += " " + key + (error.certain ? "" : "?");
        }
        fail(Rule::error_register,
             "1001h reads " + std::to_string(shown) + " while these last:" + lasting, Time());
      }
    };
  }
  return answer;
}

ReferenceNode::Answer ReferenceNode::upload_segment(const can::Frame& frame) {
  if (transfer_ != Transfer::upload) {
    end_transfer();
    return {.aborts = {kCommand}, .names_object = false};
  }
  const bool toggle = (byte(frame, 0) & 0x10) != 0;
  if (toggle != toggle_) {
    end_transfer();
    return {.aborts = {kToggle}, .names_object = false};
  }
  const std::string_view content = transferred_->content;
  const std::size_t count = std::min<std::size_t>(7, content.size() - offset_);
  const bool last = offset_ + count == content.size();
  Bytes bytes{static_cast<std::uint8_t>((toggle ? 0x10 : 0) | (7 - count) << 1 | (last ? 1 : 0))};
  for (std::size_t i = 0; i < count; ++i) {
    bytes[1 + i] = static_cast<std::uint8_t>(content[offset_ + i]);
  }
  offset_ += count;
  toggle_ = !toggle_;
  if (last) {
    end_transfer();
  }
  return {.success = bytes};
}

ReferenceNode::Answer ReferenceNode::initiate_download(const can::Frame& frame, Time now) {
  end_transfer();
  const std::uint8_t command = byte(frame, 0);
  const auto index = base::load_le<std::uint16_t>(frame.data, 1);
  const ObjectUnderTest* object = find_object(index, byte(frame, 3));
  if (const auto aborts = missing(object, index); !aborts.empty()) {
    return {.aborts = aborts};
  }
  const bool expedited = (command & 2) != 0;
  const bool sized = (command & 1) != 0;
  const auto data = base::load_le<std::uint32_t>(frame.data, 4);
  if (expedited) {
    const std::size_t size =
        sized ? 4U - (command >> 2 & 3U) : std::min<std::size_t>(4, object->size);
    return write(*object, masked(data, size), size, initiated(frame, 0x60), now);
  }
  if (readable_only(object->rule)) {
    return {.aborts = {kWriteOnlyRead}};
  }
  if (sized && data != object->size) {
    return {.aborts = {data > object->size ? kTooLong : kTooShort, kLength}};
  }
  transfer_ = Transfer::download;
  transferred_ = object;
  announced_ = sized ? std::optional<std::size_t>(data) : std::nullopt;
  offset_ = 0;
  segments_ = 0;
  toggle_ = false;
  return {.success = initiated(frame, 0x60)};
}

ReferenceNode::Answer ReferenceNode::download_segment(const can::Frame& frame, Time now) {
  const std::uint8_t command = byte(frame, 0);
  if (transfer_ != Transfer::download) {
    end_transfer();
    return {.aborts = {kCommand}, .names_object = false};
  }
  const ObjectUnderTest& object = *transferred_;
  const bool toggle = (command & 0x10) != 0;
  if (toggle != toggle_) {
    end_transfer();
    return {.aborts = {kToggle}, .names_object = false};
  }
  const std::size_t came = 7U - (command >> 1 & 7U);
  if (offset_ + came > object.size) {
    end_transfer();
    return {.aborts = {kTooLong, kLength}, .names_object = false};
  }
  for (std::size_t i = 0; i < came; ++i) {
    segments_ |= std::uint64_t{byte(frame, 1 + i)} << 8 * (offset_ + i);
  }
  offset_ += came;
  toggle_ = !toggle_;
  const Bytes success{static_cast<std::uint8_t>(0x20 | (toggle ? 0x10 : 0))};
  if ((command & 1) == 0) {
    return {.success = success};
  }
  const std::size_t size = offset_;
  end_transfer();
  Answer answer = write(object, static_cast<std::uint32_t>(segments_), size, success, now);
  answer.names_object = false;
  return answer;
}

ReferenceNode::Answer ReferenceNode::write(const ObjectUnderTest& object, std::uint32_t raw,
                                           std::size_t size, const Bytes& success, Time now) {
  if (readable_only(object.rule)) {
    return {.aborts = {kWriteOnlyRead}};
  }
  if (size != object.size) {
    return {.aborts = {size > object.size ? kTooLong : kTooShort, kLength}};
  }
  Answer answer;
  bool either = false;
  answer.aborts = judge(object, raw, either);
  if (answer.aborts.empty() || either) {
    answer.success = success;
    answer.on_success = [this, &object, raw, now](const can::Frame&) { written(object, raw, now); };
  }
  return answer;
}

std::set<std::uint32_t> ReferenceNode::judge(const ObjectUnderTest& object, std::uint32_t raw,
                                             bool& either) const {
  const std::int64_t number = as_number(object, raw);
  switch (object.rule) {
    case ObjectRule::number:
    case ObjectRule::inhibit_time: {
      std::set<std::uint32_t> aborts;
      if (number > object.high) {
        aborts = {kTooHigh};
      } else if (number < object.low) {
        aborts = {kTooLow};
      } else if (object.rule == ObjectRule::inhibit_time &&
                 raw != value(object.index, object.subindex) &&
                 (value(object.index, 1) & kInvalid) == 0) {
        aborts = {kDeviceState};  // CiA 301 §7.5.2.37: only while the PDO does not exist
      }
      return aborts;
    }
    case ObjectRule::choice:
      return std::ranges::find(object.choices, std::int64_t{raw}) == object.choices.end()
                 ? std::set{kRange}
                 : std::set<std::uint32_t>{};
    case ObjectRule::sync_id:
    case ObjectRule::emergency_id:
    case ObjectRule::receive_pdo_id:
    case ObjectRule::transmit_pdo_id:
      return judge_cob_id(object, raw);
    case ObjectRule::mapping_count:
    case ObjectRule::mapping_entry:
      return judge_mapping(object, raw, either);
    case ObjectRule::consumer_heartbeat:
      return (raw & 0xFF000000) != 0 ? std::set{kRange} : std::set<std::uint32_t>{};
    case ObjectRule::store:
      return raw == kSave ? std::set<std::uint32_t>{} : std::set{kCannotStore};
    case ObjectRule::restore:
      return raw == kLoad ? std::set<std::uint32_t>{} : std::set{kCannotStore};
    default:
      return {kWriteOnlyRead};
  }
}

std::set<std::uint32_t> ReferenceNode::judge_cob_id(const ObjectUnderTest& object,
                                                    std::uint32_t raw) const {
  const std::uint32_t can_id = raw & 0x7FF;
  const bool is_pdo =
      object.rule == ObjectRule::receive_pdo_id || object.rule == ObjectRule::transmit_pdo_id;
  const bool bit_30 = (raw & 0x40000000) != 0;
  const bool unused = can_id == 0 && (raw & kInvalid) != 0 && object.rule != ObjectRule::sync_id;
  if ((raw & 0x3FFFF800) != 0 || bit_30 != is_pdo || (!unused && restricted(can_id))) {
    return {kRange};
  }
  const std::uint32_t before = value(object.index, object.subindex);
  if (is_pdo && ((before ^ raw) & 0x3FFFFFFF) != 0 && ((before | raw) & kInvalid) == 0) {
    return {kDeviceState};
  }
  if (object.rule == ObjectRule::sync_id && can_id_in_use(can_id)) {
    return {kRange};
  }
  return {};
}

bool ReferenceNode::can_id_in_use(std::uint32_t can_id) const {
  const auto uses = [&](std::uint16_t index, std::uint8_t subindex) {
    const std::uint32_t cob_id = value(index, subindex);
    return (cob_id & kInvalid) == 0 && (cob_id & 0x7FF) == can_id;
  };
  bool used = uses(0x1014, 0);
  for (std::uint16_t pdo = 0; pdo < kPdos; ++pdo) {
    used = used || uses(static_cast<std::uint16_t>(0x1400 + pdo), 1) ||
           uses(static_cast<std::uint16_t>(0x1800 + pdo), 1);
  }
  return used;
}

std::set<std::uint32_t> ReferenceNode::judge_mapping(const ObjectUnderTest& object,
                                                     std::uint32_t raw, bool& either) const {
  const auto communication = static_cast<std::uint16_t>(object.index - 0x200);
  const bool range_first = object.rule == ObjectRule::mapping_count && raw > 3;
  if (range_first) {
    return {kTooHigh};
  }
  if ((value(communication, 1) & kInvalid) == 0) {
    return {kDeviceState};
  }
  const auto mappable = object.index < 0x1800 ? mappable_to_receive() : mappable_to_transmit();
  const auto fits = [&](std::uint32_t entry) {
    return std::ranges::find(mappable, entry) != mappable.end();
  };
  if (object.rule == ObjectRule::mapping_entry) {
    if (value(object.index, 0) != 0) {
      return {kDeviceState};
    }
    if (raw == 0 || fits(raw)) {
      return {};
    }
    either = false;
    const bool exists = find_object(static_cast<std::uint16_t>(raw >> 16),
                                    static_cast<std::uint8_t>(raw >> 8)) != nullptr &&
                        (raw >> 16) != 0x5FFF;
    return exists ? std::set{kNotMappable, kLength} : std::set{kNoObject};
  }
  unsigned bits = 0;
  for (std::uint8_t entry = 1; entry <= raw; ++entry) {
    const std::uint32_t mapped = value(object.index, entry);
    if (!fits(mapped)) {
      return {kNoObject, kNotMappable};
    }
    bits += mapped & 0xFF;
  }
  return bits > 64 ? std::set{kPdoLength} : std::set<std::uint32_t>{};
}

void ReferenceNode::written(const ObjectUnderTest& object, std::uint32_t raw, Time now) {
  if (object.rule == ObjectRule::store || object.rule == ObjectRule::restore) {
    std::set<Stored> groups;
    if (object.index == 0x2706) {
      groups = {Stored::network};
    } else {
      if (object.subindex != 4) {
        groups = {Stored::network};
        if (options_.stores_communication) {
          groups.insert(Stored::communication);
        }
      }
      if (object.subindex != 2) {
        groups.insert(Stored::motor);
      }
    }
    store(groups, object.rule == ObjectRule::restore);
    return;
  }
  const std::uint32_t before = value(object.index, object.subindex);
  values_[{object.index, object.subindex}] = raw;
  switch (object.index) {
    case 0x1017:
      heartbeat_from_ = raw == 0 ? Time::never() : now;
      heartbeat_by_ =
          raw == 0 ? Time::never() : now + base::SimDuration(std::int64_t{raw} * 1'000'000);
      [[fallthrough]];
    case 0x100C:
    case 0x100D:
      if (value(0x1017, 0) != 0 || life_time() == base::SimDuration()) {
        life_guarded_ = false;
        life_end_ = Time::never();
        errors_.erase("life guarding");
      } else if (life_guarded_) {
        life_end_ = now + life_time();
      }
      break;
    case 0x1016:
      errors_.erase("heartbeat");
      watched_until_ = Time::never();
      break;
    case 0x1014:
      for (DueEmergency& due : due_) {
        due.must = due.must && (raw & kInvalid) == 0;
      }
      emergencies_flow_since_ = now;
      break;
    case 0x1015:
      emergencies_flow_since_ = now;
      break;
    case 0x6040:
    case 0x6060:
      stimulus_ = now;
      break;
    default:
      break;
  }
  if (object.index >= 0x1400 && object.index < 0x1C00) {
    pdo_written(object, before, now);
  }
}

void ReferenceNode::store(const std::set<Stored>& groups, bool clear) {
  for (const Stored group : groups) {
    images_.erase(group);
    if (group == Stored::network) {
      stored_since_pending_ = true;
    }
    if (clear) {
      continue;
    }
    for (const ObjectUnderTest& object : objects_under_test()) {
      if (object.stored == group) {
        const Key key{object.index, object.subindex};
        images_[group][key] = values_[key];
      }
    }
  }
}

void ReferenceNode::reset_values(bool application) {
  for (const ObjectUnderTest& object : objects_under_test()) {
    const bool communication = object.index < 0x2000;
    if (communication || application || object.stored == Stored::network) {
      const Key key{object.index, object.subindex};
      values_[key] = defaults_[key] + (object.node_id_relative ? node_id_ : 0U);
    }
  }
}

void ReferenceNode::load_values(bool application) {
  for (const auto& [group, image] : images_) {
    if (group == Stored::motor && !application) {
      continue;
    }
    for (const auto& [key, stored] : image) {
      values_[key] = stored;
    }
  }
}

void ReferenceNode::see_sdo(const can::Frame& frame, Time now) {
  if (frame.length != 8) {
    fail(Rule::sdo_answer, "an SDO answer has " + std::to_string(frame.length) + " bytes", now);
    return;
  }
  const bool aborted = byte(frame, 0) == 0x80;
  const auto code = base::load_le<std::uint32_t>(frame.data, 4);
  if (timed_out_ && aborted && code == kTimeout) {
    timed_out_ = false;
    return;
  }
  if (!answer_ || !has_sdo(now)) {
    fail(Rule::sdo_answer, "an SDO answer that nothing asks for", now);
    return;
  }
  const Answer answer = *answer_;
  answer_.reset();
  if (aborted) {
    const bool named = byte(frame, 1) == requested_[0] && byte(frame, 2) == requested_[1] &&
                       byte(frame, 3) == requested_[2];
    if (answer.names_object && !named) {
      fail(Rule::sdo_answer, "the abort names another object than the request", now);
    }
    if (!answer.aborts.contains(code)) {
      char text[128];
      std::snprintf(text, sizeof text, "abort %08X, expected was %s %08X",
                    static_cast<unsigned>(code), answer.aborts.empty() ? "success, not" : "abort",
                    answer.aborts.empty() ? 0U : static_cast<unsigned>(*answer.aborts.begin()));
      fail(Rule::sdo_abort_code, text, now);
    }
    return;
  }
  if (!answer.success) {
    char text[128];
    std::snprintf(text, sizeof text, "answered with %02X instead of abort %08X", byte(frame, 0),
                  static_cast<unsigned>(*answer.aborts.begin()));
    fail(Rule::sdo_abort_code, text, now);
    return;
  }
  for (std::size_t i = 0; i < 8; ++i) {
    if ((answer.open_bytes >> i & 1U) == 0 && byte(frame, i) != (*answer.success)[i]) {
      fail(i < 4 ? Rule::sdo_answer : Rule::value,
           "byte " + std::to_string(i) + " of the answer is " + std::to_string(byte(frame, i)) +
               ", expected was " + std::to_string((*answer.success)[i]),
           now);
      return;
    }
  }
  if (answer.on_success) {
    answer.on_success(frame);
  }
}

}  // namespace stator::tests
