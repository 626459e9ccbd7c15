#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "rack/kept_file.hpp"

namespace stator::rack {

/// Replaces files of a state directory in a thread of its own: bringing a file to the disk takes
/// tens of milliseconds, which no bus can wait for.
class BackgroundWriter {
 public:
  struct Job {
    std::string file;
    KeptFile content;
    std::size_t owner = 0;      ///< for who gave the job
    std::uint32_t version = 0;  ///< for who gave the job
  };
  struct Result {
    std::size_t owner = 0;
    std::uint32_t version = 0;
    std::string kind;
    std::string error;  ///< empty: the file is on the disk
  };

  /// `directory` must outlive the writer.
  explicit BackgroundWriter(const StateDirectory& directory);
  /// Writes what was given so far, then ends the thread.
  ~BackgroundWriter();
  BackgroundWriter(const BackgroundWriter&) = delete;
  BackgroundWriter& operator=(const BackgroundWriter&) = delete;

  /// Queues a file. A job for the same file that has not begun is dropped without a result.
  void write(Job job);
  /// Waits until everything that was given is done.
  void wait();
  /// What has been done since the last call.
  [[nodiscard]] std::vector<Result> take_results();

 private:
  void run();
  [[nodiscard]] Result perform(const Job& job) const;

  const StateDirectory& directory_;
  std::mutex mutex_;  ///< guards all below but the thread
  std::condition_variable changed_;
  std::deque<Job> jobs_;
  std::vector<Result> results_;
  bool working_ = false;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace stator::rack
