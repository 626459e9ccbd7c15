#include "stator/link/system/background_output.hpp"

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/temporary_directory.hpp"
#include "stator/link/system/file_descriptor.hpp"

namespace stator::link {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

/// Both ends of a pipe, which nobody reads on its own.
struct Pipe {
  Pipe() {
    std::array<int, 2> ends{};
    EXPECT_EQ(::pipe2(ends.data(), O_CLOEXEC), 0);
    reader = FileDescriptor(ends[0]);
    writer = FileDescriptor(ends[1]);
  }
  /// All that comes until the writing ends are closed.
  [[nodiscard]] std::string rest() const {
    std::string text;
    std::array<char, 4096> piece{};
    for (ssize_t length = 0; (length = ::read(reader.get(), piece.data(), piece.size())) > 0;) {
      text.append(piece.data(), static_cast<std::size_t>(length));
    }
    return text;
  }
  /// Leaves no room in it.
  void fill() const {
    const std::string much(4096, '.');
    ASSERT_EQ(::fcntl(writer.get(), F_SETFL, O_NONBLOCK), 0);
    while (::write(writer.get(), much.data(), much.size()) > 0) {
    }
    ASSERT_EQ(::fcntl(writer.get(), F_SETFL, 0), 0);
  }
  FileDescriptor reader;
  FileDescriptor writer;
};

std::string content(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// A line of 100 bytes.
std::string line(int number) {
  std::string text = std::to_string(number) + ' ';
  text.resize(99, '.');
  return text + '\n';
}

class BackgroundOutputTest : public testing::Test {
 protected:
  const tests::TemporaryDirectory directory_;
  const std::string path_ = directory_.path() + "/output";
};

TEST_F(BackgroundOutputTest, WritesEverythingInItsOrderThoughTheQueueIsShort) {
  auto output = BackgroundOutput::create(path_, {}, 1000);
  ASSERT_TRUE(output) << output.error().text;
  std::string expected;
  for (int i = 0; i < 1000; ++i) {
    expected += line(i);
    ASSERT_TRUE((*output)->write(line(i)));
  }
  (*output)->finish();
  EXPECT_EQ(content(path_), expected);
  EXPECT_TRUE((*output)->complete());
  EXPECT_EQ((*output)->what_is_missing("lines"), "");
  EXPECT_EQ((*output)->records(), 1000U);
  EXPECT_EQ((*output)->bytes(), expected.size());
}

TEST_F(BackgroundOutputTest, TakesARecordAsAWholeOrNotAtAllAndCountsIt) {
  Pipe pipe;
  const auto output = BackgroundOutput::onto(pipe.writer.get(), "the pipe", 1050);
  output->set_when_full(WhenFull::drop);
  std::string taken;
  std::uint64_t lost = 0;
  for (int i = 0; i < 5000; ++i) {
    if (output->write(line(i))) {
      taken += line(i);
    } else {
      ++lost;
    }
  }
  EXPECT_GT(lost, 1000U) << "a pipe holds less than 500,000 bytes";
  EXPECT_EQ(output->lost(), lost);
  pipe.writer = FileDescriptor();
  std::thread reader([&] { EXPECT_EQ(pipe.rest(), taken); });
  output->finish();
  reader.join();
  EXPECT_THAT(output->what_is_missing("lines"),
              StartsWith(std::to_string(lost) + " of 5000 lines are missing"));
}

// Otherwise each line read would make room for a line, and a gap would come after each.
TEST_F(BackgroundOutputTest, TakesMoreAfterALossOnlyWhenTheQueueIsHalfEmpty) {
  Pipe pipe;
  pipe.fill();
  const auto output = BackgroundOutput::onto(pipe.writer.get(), "the pipe", 100'000);
  output->set_when_full(WhenFull::drop);
  while (output->write(line(0))) {
  }
  ASSERT_EQ(output->waiting(), 100'000U);
  std::string buffer(20'000, ' ');
  ASSERT_GT(::read(pipe.reader.get(), buffer.data(), buffer.size()), 4096);
  while (output->waiting() == 100'000U) {
    std::this_thread::yield();
  }
  EXPECT_FALSE(output->write("x"));
  while (output->waiting() > 50'000) {
    ASSERT_GT(::read(pipe.reader.get(), buffer.data(), buffer.size()), 0);
  }
  EXPECT_TRUE(output->write("x"));
}

TEST_F(BackgroundOutputTest, WaitsForRoomUntilItIsStopped) {
  Pipe pipe;
  const auto output = BackgroundOutput::onto(pipe.writer.get(), "the pipe", 1000);
  std::atomic<int> written{0};
  std::thread writer([&] {
    while (output->write(line(written))) {
      ++written;
    }
  });
  while (output->waiting() < 900) {
    std::this_thread::yield();
  }
  output->stop_waiting();
  writer.join();
  EXPECT_GT(written, 9);
  EXPECT_EQ(output->lost(), 1U) << "it has waited with the others";
  output->finish();
  EXPECT_FALSE(output->complete());
  EXPECT_THAT(output->what_is_missing("lines"), HasSubstr("the last 1000 bytes are missing"));
}

TEST_F(BackgroundOutputTest, IsCompleteThoughItIsStoppedIfTheReaderReads) {
  Pipe pipe;
  auto output = BackgroundOutput::onto(pipe.writer.get(), "the pipe", 1000);
  pipe.writer = FileDescriptor();
  std::string read;
  std::thread reader([&] { read = pipe.rest(); });
  output->stop_waiting();
  std::string expected;
  for (int i = 0; i < 3000; ++i) {
    expected += line(i);
    ASSERT_TRUE(output->write(line(i)));
  }
  output->finish();
  EXPECT_TRUE(output->complete());
  output.reset();
  reader.join();
  EXPECT_EQ(read, expected);
}

TEST_F(BackgroundOutputTest, LeavesTheDescriptorOfOthersAsItIs) {
  const Pipe pipe;
  const auto output = BackgroundOutput::onto(pipe.writer.get(), "the pipe");
  EXPECT_EQ(::fcntl(pipe.writer.get(), F_GETFL) & O_NONBLOCK, 0);
}

TEST_F(BackgroundOutputTest, WritesAFifoWhoseReaderComesLater) {
  ASSERT_EQ(::mkfifo(path_.c_str(), 0600), 0);
  auto output = BackgroundOutput::create(path_, std::as_bytes(std::span("head\n", 5)));
  ASSERT_TRUE(output) << output.error().text;
  ASSERT_TRUE((*output)->write("record\n"));
  std::string read;
  std::thread reader([&] { read = content(path_); });
  EXPECT_TRUE((*output)->drain());
  output->reset();
  reader.join();
  EXPECT_EQ(read, "head\nrecord\n");
}

TEST_F(BackgroundOutputTest, EndsThoughNobodyOpensTheFifo) {
  ASSERT_EQ(::mkfifo(path_.c_str(), 0600), 0);
  auto output = BackgroundOutput::create(path_);
  ASSERT_TRUE(output) << output.error().text;
  ASSERT_TRUE((*output)->write("record\n"));
  (*output)->stop_waiting();
  (*output)->finish();
  EXPECT_EQ((*output)->what_is_missing("records"),
            "the last 7 bytes are missing, because nobody took them in the end");
}

TEST_F(BackgroundOutputTest, NobodyMissesAnythingWhenTheReaderHasGone) {
  Pipe pipe;
  const auto output = BackgroundOutput::onto(pipe.writer.get(), "the pipe");
  pipe.reader = FileDescriptor();
  EXPECT_TRUE(output->write("record\n"));
  EXPECT_FALSE(output->drain()) << "and no signal has ended this program";
  EXPECT_TRUE(output->reader_has_gone());
  EXPECT_FALSE(output->write("record\n"));
  EXPECT_TRUE(output->complete());
  EXPECT_EQ(output->what_is_missing("records"), "");
}

TEST_F(BackgroundOutputTest, SaysThatTheDiskIsFull) {
  const auto refused = BackgroundOutput::create("/dev/full", std::as_bytes(std::span("head", 4)));
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().text, HasSubstr("\"/dev/full\": No space left"));
  const auto output = BackgroundOutput::create("/dev/full");
  ASSERT_TRUE(output);
  (*output)->write("record");
  EXPECT_FALSE((*output)->drain());
  EXPECT_TRUE((*output)->in_trouble());
  EXPECT_FALSE((*output)->write("record")) << "it waits for nothing any more";
  EXPECT_THAT((*output)->what_is_missing("records"), HasSubstr("No space left"));
}

TEST_F(BackgroundOutputTest, SaysWhatCannotBeOpened) {
  const auto output = BackgroundOutput::create("/nowhere/file");
  ASSERT_FALSE(output);
  EXPECT_THAT(output.error().text, HasSubstr("\"/nowhere/file\": No such file"));
}

TEST_F(BackgroundOutputTest, LastWordsWaitForNobody) {
  Pipe pipe;
  pipe.fill();
  write_within(pipe.writer.get(), "nobody reads this\n");
  pipe = Pipe();
  write_within(pipe.writer.get(), "the end\n");
  pipe.writer = FileDescriptor();
  EXPECT_EQ(pipe.rest(), "the end\n");
}

}  // namespace
}  // namespace stator::link
