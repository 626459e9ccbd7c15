#include "stator/canopen/storage/parameter_storage.hpp"

#include <algorithm>
#include <utility>

namespace stator::canopen {

namespace {

using base::EventArgument;
using dictionary::AbortCode;
using dictionary::Entry;
using dictionary::Verdict;

std::array<EventArgument, 6> about(const Entry& entry, const EventArgument& a = {},
                                   const EventArgument& b = {}, const EventArgument& c = {}) {
  return {int{entry.index()}, int{entry.subindex()}, entry.shared_name(), a, b, c};
}

}  // namespace

ParameterStorage::ParameterStorage(dictionary::Dictionary& dictionary, NonVolatileMemory& memory,
                                   base::EventReporter reporter,
                                   const ParameterStorageRules& limits)
    : dictionary_(dictionary), memory_(memory), reporter_(reporter), rules_(limits) {
  for (const StorageCommand& command : rules_.commands) {
    dictionary.on_check(command.index, command.subindex,
                        Entry::CheckHook::bind<&ParameterStorage::check_signature>(*this));
    dictionary.on_written(command.index, command.subindex,
                          Entry::WrittenHook::bind<&ParameterStorage::on_written>(*this));
    dictionary.on_read(command.index, command.subindex,
                       Entry::ReadHook::bind<&ParameterStorage::show_capability>(*this));
  }
  images_.resize(rules_.groups.size());
  order_.reserve(rules_.groups.size());
  for (std::size_t i = 0; i < images_.size(); ++i) {
    encode_parameters(dictionary_, rules_.groups[i].ranges, images_[i]);
  }
}

const StorageCommand* ParameterStorage::find(const Entry& entry) const {
  const auto found = std::ranges::find_if(rules_.commands, [&entry](const StorageCommand& command) {
    return command.index == entry.index() && command.subindex == entry.subindex();
  });
  return found == rules_.commands.end() ? nullptr : &*found;
}

void ParameterStorage::show_capability(Entry& entry) {
  entry.set_value(find(entry)->reads);
}

Verdict ParameterStorage::check_signature(const Entry& entry, std::uint64_t value) {
  const bool stores = find(entry)->action == StorageCommand::Action::store;
  const std::uint32_t signature = stores ? kSaveSignature : kLoadSignature;
  if (value != signature) {
    return dictionary::refuse(AbortCode::cannot_store, rules::kStorageSignature,
                              about(entry, value, signature,
                                    stores ? base::StaticText("save") : base::StaticText("load")));
  }
  // Several orders of one write by complete access are not refused as busy: they go together.
  if (memory_.status() == NonVolatileMemory::Status::busy && !ordered_now_) {
    return dictionary::refuse(AbortCode::device_state, rules::kStorageBusy, about(entry));
  }
  return {};
}

void ParameterStorage::on_written(const Entry& entry) {
  const StorageCommand& command = *find(entry);
  order_.clear();
  for (std::size_t i = 0; i < images_.size(); ++i) {
    const ParameterGroup& group = rules_.groups[i];
    if ((command.groups >> group.number & 1U) == 0) {
      continue;
    }
    if (command.action == StorageCommand::Action::store) {
      encode_parameters(dictionary_, group.ranges, images_[i]);
      order_.push_back({group.number, images_[i]});
    } else {
      order_.push_back({group.number, {}});
    }
  }
  if (!order_.empty()) {
    memory_.store(order_);
    ordered_now_ = true;
  }
  if (ordered_) {
    ordered_(command);
  }
}

std::optional<Verdict> ParameterStorage::poll(const Entry& entry, base::SimTime now) {
  if (find(entry) == nullptr) {
    date_becomes_unknown(entry);
    return Verdict{};
  }
  const NonVolatileMemory::Status status = memory_.status();
  if (std::exchange(ordered_now_, false)) {
    const bool takes_time = status == NonVolatileMemory::Status::busy;
    earliest_ = takes_time ? now + rules_.write_time : now;
  }
  if (now < earliest_) {
    return std::nullopt;
  }
  switch (status) {
    case NonVolatileMemory::Status::busy:
      return std::nullopt;
    case NonVolatileMemory::Status::failed:
      return Verdict(
          dictionary::refuse(AbortCode::hardware_error, rules::kStorageFailed, about(entry)));
    case NonVolatileMemory::Status::ready:
      return Verdict{};
  }
  return Verdict{};
}

void ParameterStorage::date_becomes_unknown(const Entry& changed) {
  const dictionary::Object* verification = dictionary_.find(kVerifyConfiguration);
  const bool stored = std::ranges::any_of(rules_.groups, [&changed](const ParameterGroup& group) {
    return is_parameter(changed, group.ranges);
  });
  if (verification == nullptr || !stored || changed.index() == kVerifyConfiguration) {
    return;
  }
  for (Entry& entry : dictionary_.entries_of(*verification).subspan(1)) {
    entry.set_value(0);
  }
}

void ParameterStorage::load_groups(bool communication_only, base::SimTime now) {
  for (const ParameterGroup& group : rules_.groups) {
    const std::span<const std::byte> image = memory_.image(group.number);
    if (image.empty() || (communication_only && !group.communication)) {
      continue;
    }
    switch (load_parameters(dictionary_, group.ranges, image)) {
      case ImageVerdict::loaded:
        break;
      case ImageVerdict::damaged:
        reporter_.report(now, rules::kStoredParametersDamaged, {int{group.number}});
        break;
      case ImageVerdict::foreign:
        reporter_.report(now, rules::kStoredParametersForeign, {int{group.number}});
        break;
    }
  }
}

}  // namespace stator::canopen
