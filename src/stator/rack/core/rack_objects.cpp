// Objects of a device's dictionary that somebody beside its network reads and writes.

#include "stator/rack/core/internal/telling.hpp"

namespace stator::rack {

namespace {

constexpr base::EventRule kObjectSet{"object-set", base::Severity::information,
                                     "object {0:x4}:{1:x2} \"{2}\" is set to {3} from outside"};
constexpr base::EventRule kTextSet{"object-set", base::Severity::information,
                                   "object {0:x4}:{1:x2} \"{2}\" is set from outside"};

}  // namespace

dictionary::Verdict Rack::read_object(DeviceAddress address, const dictionary::Entry& entry,
                                      std::vector<std::byte>& value) {
  tell(command::ReadObject{address, entry.index(), entry.subindex()});
  const dictionary::Dictionary& objects = *device(address).object_dictionary();
  if (dictionary::Verdict verdict = objects.prepare_read(entry); !verdict) {
    return verdict;
  }
  value.resize(entry.size());
  return objects.read(entry, value);
}

dictionary::Verdict Rack::write_object(DeviceAddress address, const dictionary::Entry& entry,
                                       std::span<const std::byte> value, base::SimTime now) {
  tell(command::WriteObject{address, entry.index(), entry.subindex(), value, now});
  product::Device& written = parts_->device(address);
  dictionary::Dictionary& objects = *written.object_dictionary();
  dictionary::Verdict verdict = objects.write(*objects.find(entry.index(), entry.subindex()), value,
                                              {network_state(address)});
  if (!verdict) {
    const dictionary::Refusal& refusal = verdict.error();
    if (refusal.rule != nullptr) {
      parts_->report(parts_->number_of(address), now, *refusal.rule, refusal.arguments);
    }
    return verdict;
  }
  const bool text = dictionary::is_string(entry.type());
  parts_->report(parts_->number_of(address), now, text ? kTextSet : kObjectSet,
                 {entry.index(), std::size_t{entry.subindex()}, entry.shared_name(),
                  text ? base::EventArgument() : base::EventArgument(entry.signed_value())});
  // The firmware is asked at once how far the write has come, since the time that an order takes
  // begins with the first such question.
  if (dictionary::WriteCompletion* completion = written.write_completion()) {
    static_cast<void>(completion->poll(entry, now));
  }
  written.objects_written(now);
  if (address.kind == NetworkKind::bus) {
    parts_->buses[address.network].network->touched(address.device);
  }
  return verdict;
}

std::optional<dictionary::Verdict> Rack::completion_of_write(DeviceAddress address,
                                                             const dictionary::Entry& entry,
                                                             base::SimTime now) {
  dictionary::WriteCompletion* completion = parts_->device(address).write_completion();
  return completion == nullptr ? dictionary::Verdict() : completion->poll(entry, now);
}

}  // namespace stator::rack
