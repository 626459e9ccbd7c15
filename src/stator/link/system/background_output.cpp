#include "stator/link/system/background_output.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/stat.h>
#include <unistd.h>

#include "stator/link/system/failure.hpp"
#include "stator/link/system/file_descriptor.hpp"

namespace stator::link {

namespace {

using std::chrono::milliseconds;

/// What comes within this time after something was written goes out in one piece.
constexpr milliseconds kGathering{5};
/// How often a FIFO is looked at for a reader.
constexpr milliseconds kReaderPeriod{20};
/// How often a thread that waits for room or for the end looks again.
constexpr milliseconds kLook{1};
/// How long to wait for the end of the thread once it has nothing to write.
constexpr milliseconds kLeaving{100};
constexpr std::size_t kPiece = std::size_t{64} << 10U;
/// A pipe that can be written takes as much without waiting (POSIX: PIPE_BUF).
constexpr std::size_t kPieceOfPipe = 4096;

LinkError file_error(const std::string& name, const char* what, int error) {
  return {LinkErrorCode::file, std::string("cannot ") + what + " " + in_quotes(name) + ": " +
                                   std::generic_category().message(error)};
}

}  // namespace

/// What both threads use. Places in the queue are counted from the beginning of the output.
struct BackgroundOutput::Shared {
  explicit Shared(std::size_t capacity)
      : size(capacity),
        queue(std::make_unique_for_overwrite<std::byte[]>(capacity)),
        call(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {}

  const std::size_t size;
  const std::unique_ptr<std::byte[]> queue;
  const FileDescriptor call;  ///< wakes the thread

  FileDescriptor file;
  std::string fifo;            ///< to be opened when a reader comes
  bool others_use_it = false;  ///< so O_NONBLOCK, which all its users share, must not be set
  std::size_t piece = kPiece;
  std::uint64_t written_before = 0;

  std::atomic<std::size_t> pushed{0};
  std::atomic<std::size_t> popped{0};
  std::atomic<Clock::rep> sign_of_life{0};
  std::atomic<bool> asleep{false};  ///< the thread waits for bytes
  std::atomic<bool> ending{false};
  std::atomic<bool> left{false};  ///< nobody waits for the thread any more
  std::atomic<bool> ended{false};
  std::atomic<int> error{0};

  void wake() const {
    const std::uint64_t one = 1;
    static_cast<void>(::write(call.get(), &one, sizeof one));
  }
  [[nodiscard]] std::size_t waiting() const {
    return pushed.load(std::memory_order_acquire) - popped.load(std::memory_order_acquire);
  }
  /// Nothing was taken for kPatience, and for as long after `since`.
  [[nodiscard]] bool stalled(Clock::time_point since) const {
    const Clock::time_point alive{Clock::duration(sign_of_life)};
    return Clock::now() - std::max(alive, since) > kPatience;
  }

  void run();
  void sleep();
  void open_for_reader();
  void write_piece();
  void wait_until_writable();
  /// Until somebody calls or `limit` has passed (negative: never).
  void wait_for_call(int limit) const;
};

void BackgroundOutput::Shared::run() {
  while (error == 0 && !left) {
    if (waiting() == 0) {
      if (ending) {
        break;
      }
      sleep();
    } else if (!file.is_open()) {
      open_for_reader();
    } else {
      write_piece();
      if (waiting() == 0 && !ending) {
        wait_for_call(static_cast<int>(kGathering.count()));
      }
    }
  }
  file = FileDescriptor();
  ended = true;
}

// Both sides write their own flag before they look at the other's, in one order for all threads.
void BackgroundOutput::Shared::sleep() {
  asleep = true;
  if (pushed == popped && !ending) {
    wait_for_call(-1);
  }
  asleep = false;
}

void BackgroundOutput::Shared::open_for_reader() {
  file = FileDescriptor(::open(fifo.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK));
  if (file.is_open()) {
    return;
  }
  if (errno != ENXIO && errno != EINTR) {
    error = errno;
    return;
  }
  wait_for_call(static_cast<int>(kReaderPeriod.count()));
}

void BackgroundOutput::Shared::write_piece() {
  if (others_use_it) {
    wait_until_writable();
    if (left) {
      return;
    }
  }
  const std::size_t from = popped % size;
  const std::size_t length = std::min({waiting(), size - from, piece});
  const ssize_t written = ::write(file.get(), queue.get() + from, length);
  if (written > 0) {
    popped.fetch_add(static_cast<std::size_t>(written), std::memory_order_release);
    sign_of_life = Clock::now().time_since_epoch().count();
  } else if (written < 0 && errno == EAGAIN) {
    wait_until_writable();
  } else if (written < 0 && errno != EINTR) {
    error = errno;
  }
}

void BackgroundOutput::Shared::wait_until_writable() {
  while (!left) {
    std::array<pollfd, 2> both{{{.fd = file.get(), .events = POLLOUT, .revents = 0},
                                {.fd = call.get(), .events = POLLIN, .revents = 0}}};
    if (::poll(both.data(), both.size(), -1) < 0) {
      continue;
    }
    if (both[1].revents != 0) {
      wait_for_call(0);
    }
    if (both[0].revents != 0) {
      return;
    }
  }
}

void BackgroundOutput::Shared::wait_for_call(int limit) const {
  pollfd calls{.fd = call.get(), .events = POLLIN, .revents = 0};
  std::uint64_t count = 0;
  if (::poll(&calls, 1, limit) > 0) {
    static_cast<void>(::read(call.get(), &count, sizeof count));
  }
}

base::Expected<std::unique_ptr<BackgroundOutput>, LinkError> BackgroundOutput::create(
    const std::string& path, std::span<const std::byte> head, std::size_t capacity) {
  auto shared = std::make_shared<Shared>(capacity);
  if (!shared->call.is_open()) {
    return base::Unexpected{file_error(path, "write", errno)};
  }
  struct stat existing {};
  if (::stat(path.c_str(), &existing) == 0 && S_ISFIFO(existing.st_mode)) {
    if (::access(path.c_str(), W_OK) != 0) {
      return base::Unexpected{file_error(path, "write", errno)};
    }
    shared->fifo = path;
  } else {
    shared->file = FileDescriptor(
        ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NONBLOCK, 0666));
    if (!shared->file.is_open()) {
      return base::Unexpected{file_error(path, "create", errno)};
    }
  }
  while (shared->file.is_open() && !head.empty()) {
    const ssize_t written = ::write(shared->file.get(), head.data(), head.size());
    if (written < 0 && errno == EAGAIN) {
      break;
    }
    if (written < 0 && errno != EINTR) {
      return base::Unexpected{file_error(path, "write", errno)};
    }
    head = head.subspan(static_cast<std::size_t>(std::max<ssize_t>(written, 0)));
    shared->written_before += static_cast<std::size_t>(std::max<ssize_t>(written, 0));
  }
  auto output = std::unique_ptr<BackgroundOutput>(new BackgroundOutput(path, std::move(shared)));
  if (!head.empty() && output->write(head)) {
    output->records_ = 0;  // it is none
  }
  return output;
}

std::unique_ptr<BackgroundOutput> BackgroundOutput::onto(int descriptor, std::string name,
                                                         std::size_t capacity) {
  auto shared = std::make_shared<Shared>(capacity);
  shared->file = FileDescriptor(::fcntl(descriptor, F_DUPFD_CLOEXEC, 0));
  shared->others_use_it = true;
  struct stat kind {};
  if (!shared->file.is_open() || !shared->call.is_open()) {
    shared->error = errno;
  } else if (::fstat(descriptor, &kind) == 0 && !S_ISREG(kind.st_mode)) {
    shared->piece = kPieceOfPipe;
  }
  return std::unique_ptr<BackgroundOutput>(
      new BackgroundOutput(std::move(name), std::move(shared)));
}

// Signals are for other threads, and SIGPIPE for none: a reader that goes is an error of write().
BackgroundOutput::BackgroundOutput(std::string name, std::shared_ptr<Shared> shared)
    : name_(std::move(name)), shared_(std::move(shared)) {
  sigset_t all{};
  sigset_t before{};
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_BLOCK, &all, &before);
  thread_ = std::thread([shared = shared_] { shared->run(); });
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

BackgroundOutput::~BackgroundOutput() {
  stop_waiting();
  finish();
}

std::size_t BackgroundOutput::room() const {
  return shared_->size - shared_->waiting();
}

bool BackgroundOutput::write(std::span<const std::byte> first, std::span<const std::byte> second) {
  const std::size_t size = first.size() + second.size();
  if (shared_->error != 0 || !thread_.joinable() || !make_room(size)) {
    lost_.fetch_add(1, std::memory_order_relaxed);
    return false;
  }
  const std::size_t at = shared_->pushed.load(std::memory_order_relaxed);
  put(first, at);
  put(second, at + first.size());
  shared_->pushed = at + size;
  records_.fetch_add(1, std::memory_order_relaxed);
  if (shared_->asleep && shared_->asleep.exchange(false)) {
    shared_->wake();
  }
  return true;
}

bool BackgroundOutput::make_room(std::size_t size) {
  if (size > shared_->size) {
    return false;
  }
  if (when_full_ == WhenFull::drop) {
    losing_ = room() < (losing_ ? std::max(size, shared_->size / 2) : size);
    return !losing_;
  }
  while (room() < size) {
    const Clock::rep stopped = stopped_;
    if (shared_->error != 0 ||
        (stopped != 0 && shared_->stalled(Clock::time_point(Clock::duration(stopped))))) {
      return false;
    }
    std::this_thread::sleep_for(kLook);
  }
  return true;
}

void BackgroundOutput::put(std::span<const std::byte> bytes, std::size_t at) {
  const std::size_t from = at % shared_->size;
  const std::size_t until_end = std::min(bytes.size(), shared_->size - from);
  std::copy_n(bytes.data(), until_end, shared_->queue.get() + from);
  std::copy_n(bytes.data() + until_end, bytes.size() - until_end, shared_->queue.get());
}

bool BackgroundOutput::drain(Clock::time_point asked, milliseconds longest) {
  while (shared_->waiting() != 0 && shared_->error == 0) {
    if (gives_up(asked, longest)) {
      return false;
    }
    shared_->wake();
    std::this_thread::sleep_for(kLook);
  }
  return shared_->error == 0;
}

bool BackgroundOutput::gives_up(Clock::time_point asked, milliseconds longest) {
  if (when_full_ == WhenFull::wait && stopped_ == 0) {
    return false;
  }
  const std::size_t taken = shared_->popped;
  if (stuck_at_ != taken && (shared_->stalled(asked) || Clock::now() - asked > longest)) {
    stuck_at_ = taken;
  }
  return stuck_at_ == taken;
}

void BackgroundOutput::finish(Clock::time_point asked, milliseconds longest) {
  if (!thread_.joinable()) {
    return;
  }
  shared_->left = !drain(asked, longest);
  shared_->ending = true;
  const Clock::time_point begin = Clock::now();
  while (!shared_->ended && Clock::now() - begin < kLeaving) {
    shared_->wake();
    std::this_thread::sleep_for(kLook);
  }
  if (shared_->ended) {
    thread_.join();
  } else {
    shared_->left = true;
    thread_.detach();
  }
}

void BackgroundOutput::stop_waiting() {
  Clock::rep never = 0;
  stopped_.compare_exchange_strong(never, Clock::now().time_since_epoch().count());
}

std::uint64_t BackgroundOutput::bytes() const {
  return shared_->written_before + shared_->popped.load(std::memory_order_relaxed);
}

std::size_t BackgroundOutput::waiting() const {
  return shared_->waiting();
}

std::optional<LinkError> BackgroundOutput::error() const {
  const int error = shared_->error;
  return error == 0 ? std::nullopt : std::optional(file_error(name_, "write", error));
}

bool BackgroundOutput::reader_has_gone() const {
  return shared_->error == EPIPE;
}

bool BackgroundOutput::in_trouble() const {
  return lost() != 0 || shared_->error != 0;
}

bool BackgroundOutput::complete() const {
  const bool cut = shared_->left && waiting() != 0;
  return reader_has_gone() || (shared_->error == 0 && lost() == 0 && !cut);
}

std::string BackgroundOutput::what_is_missing(const std::string& records) const {
  if (reader_has_gone()) {
    return {};
  }
  if (const auto failed = error()) {
    return failed->text + "; what came after " + std::to_string(bytes()) + " bytes is missing";
  }
  std::string text;
  if (lost() != 0) {
    text = std::to_string(lost()) + " of " + std::to_string(lost() + records_) + " " + records +
           " are missing, because they were not taken in time";
  }
  if (waiting() != 0) {
    text += std::string(text.empty() ? "" : "; ") + "the last " + std::to_string(waiting()) +
            " bytes are missing, because nobody took them in the end";
  }
  return text;
}

void write_within(int descriptor, std::string_view text, milliseconds longest) {
  const auto output = BackgroundOutput::onto(descriptor, {}, text.size() + 1);
  output->set_when_full(WhenFull::drop);
  output->write(text);
  output->finish(BackgroundOutput::Clock::now(), longest);
}

}  // namespace stator::link
