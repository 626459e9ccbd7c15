#pragma once

#include <memory>
#include <string>

#include "stator/link/can/can_stream_link.hpp"
#include "stator/link/can/slcan_session.hpp"
#include "stator/link/system/pseudo_terminal.hpp"

namespace stator::link {

/// slcan on a pseudo-terminal: one program at a time, such as slcand, python-can or a terminal.
/// When the last one that has it open goes, however it ends, the channel closes and what it did not
/// read is discarded, so the next one finds a fresh adapter.
class SlcanPtyLink final : public CanStreamLink {
 public:
  static base::Expected<std::unique_ptr<CanLink>, LinkError> open(const std::string& path,
                                                                  bool acknowledge,
                                                                  const CanLinkOptions& options);

  [[nodiscard]] std::string usage() const override;

 private:
  SlcanPtyLink(PseudoTerminal terminal, const CanLinkOptions& options)
      : CanStreamLink(Medium::terminal, options), terminal_(std::move(terminal)) {}

  base::Expected<void, LinkError> start(bool acknowledge);
  void watch_programs();
  void on_readable(int descriptor) override;
  void on_idle() override;

  PseudoTerminal terminal_;
  /// Tells of programs that open and close the terminal (inotify).
  FileDescriptor opens_and_closes_;
  int programs_ = 0;
  bool last_has_gone_ = false;
};

}  // namespace stator::link
