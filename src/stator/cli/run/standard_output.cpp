#include "stator/cli/run/standard_output.hpp"

#include <cerrno>
#include <string_view>
#include <system_error>

#include <sys/types.h>
#include <unistd.h>

namespace stator::cli {

namespace {

constexpr std::size_t kQueue = std::size_t{1} << 20U;

/// What finds no room is lost.
ssize_t write_to(void* output, const char* text, std::size_t length) {
  static_cast<link::BackgroundOutput*>(output)->write(std::string_view(text, length));
  return static_cast<ssize_t>(length);
}

}  // namespace

StandardOutput::StandardOutput()
    : output_(link::BackgroundOutput::onto(STDOUT_FILENO, "standard output", kQueue)),
      before_(stdout),
      stream_(
          ::fopencookie(output_.get(), "w",
                        {.read = nullptr, .write = write_to, .seek = nullptr, .close = nullptr})) {
  if (stream_ == nullptr) {
    throw std::system_error(errno, std::generic_category(), "cannot use standard output");
  }
  output_->set_when_full(link::WhenFull::drop);
  static_cast<void>(std::setvbuf(stream_, nullptr, _IOLBF, BUFSIZ));  // fails for no such mode
  // What was printed before and cannot be written is lost, as it would be at the end.
  static_cast<void>(std::fflush(before_));
  stdout = stream_;  // glibc: "normal variables which you can set just like any others"
}

StandardOutput::~StandardOutput() {
  stdout = before_;
  static_cast<void>(std::fclose(stream_));  // write_to() does not fail
}

void StandardOutput::drain(link::BackgroundOutput::Clock::time_point asked) {
  static_cast<void>(std::fflush(stream_));  // write_to() does not fail
  output_->drain(asked);
}

}  // namespace stator::cli
