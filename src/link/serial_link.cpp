#include "link/serial_link.hpp"

#include <utility>

#include "link/failure.hpp"
#include "link/pty_link.hpp"

namespace stator::link {

namespace {

constexpr std::string_view kPty = "pty:";

}  // namespace

bool is_serial_link(std::string_view text) {
  return text.starts_with(kPty) && text.size() > kPty.size();
}

base::Expected<std::unique_ptr<SerialLink>, LinkError> open_serial_link(std::string_view text) {
  if (!is_serial_link(text)) {
    return fail(LinkErrorCode::invalid_option,
                "serial line " + in_quotes(std::string(text)) + " is not understood; write " +
                    std::string(kSerialLinkForms) + ", e.g. pty:/tmp/tmcm-3315");
  }
  auto opened = PtyLink::open(std::string(text.substr(kPty.size())));
  if (!opened) {
    return base::Unexpected{opened.error()};
  }
  return std::unique_ptr<SerialLink>(std::move(*opened));
}

}  // namespace stator::link
