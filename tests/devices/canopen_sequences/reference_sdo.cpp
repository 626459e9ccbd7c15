// The SDO server of the reference (CiA 301 §7.2.4).

#include <algorithm>
#include <cstdio>

#include "devices/canopen_sequences/abort_codes.hpp"
#include "devices/canopen_sequences/reference_node.hpp"
#include "stator/base/byte_order.hpp"

namespace stator::tests {

namespace {

using Bytes = std::array<std::uint8_t, 8>;

std::uint8_t byte(const can::Frame& frame, std::size_t position) {
  return std::to_integer<std::uint8_t>(frame.data[position]);
}

std::uint32_t masked(std::uint32_t raw, std::size_t size) {
  return size >= 4 ? raw : raw & ((1U << 8 * size) - 1);
}

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
    return {.aborts = {kReadOnly}};
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
    return {.aborts = {kReadOnly}};
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
