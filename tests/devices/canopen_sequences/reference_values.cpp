// The values of the reference: what may be written, what it leads to, what is stored.

#include <algorithm>

#include "devices/canopen_sequences/abort_codes.hpp"
#include "devices/canopen_sequences/reference_node.hpp"

namespace stator::tests {

namespace {

constexpr std::uint32_t kSave = 0x65766173;
constexpr std::uint32_t kLoad = 0x64616F6C;

bool is_signed(const ObjectUnderTest& object) {
  return object.low < 0;
}

std::int64_t as_number(const ObjectUnderTest& object, std::uint32_t raw) {
  return is_signed(object) ? std::int64_t{static_cast<std::int32_t>(raw)} : std::int64_t{raw};
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

std::set<std::uint32_t> ReferenceNode::judge(const ObjectUnderTest& object, std::uint32_t raw,
                                             bool& either) const {
  const std::int64_t number = as_number(object, raw);
  switch (object.rule) {
    case ObjectRule::number:
    case ObjectRule::inhibit_time: {
      std::set<std::uint32_t> aborts;
      if (number > object.high) {
        // Below 255, which stands for no node-ID where there is LSS.
        aborts = {object.index == 0x2705 && options_.lss ? kRange : kTooHigh};
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
      return {kReadOnly};
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

}  // namespace stator::tests
