#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "stator/rack/kept/kept_file.hpp"
#include "stator/rack/kept/kept_file_writer.hpp"
#include "stator/rack/kept/state_directory.hpp"

namespace stator::rack {

/// Writes files of a state directory in a thread of its own: bringing a file to the disk may take
/// tens of milliseconds, which no bus can wait for.
///
/// A job has the whole content of its file, so the newest one includes all before it: a job that
/// has not begun when the next one for its file comes is superseded. It has no result of its own;
/// the result of any later version of the file counts for it too.
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
    std::string error;  ///< empty: the file is on the disk; else path, reason, what is there now
  };

  /// `directory` must outlive the writer.
  explicit BackgroundWriter(const StateDirectory& directory);
  /// Writes what was given so far, then ends the thread.
  ~BackgroundWriter();
  BackgroundWriter(const BackgroundWriter&) = delete;
  BackgroundWriter& operator=(const BackgroundWriter&) = delete;

  /// Queues a file. A job for the same file that has not begun is superseded, and gives its turn.
  void write(Job job);
  /// Waits until everything that was given is done.
  void wait();
  /// What has been done since the last call.
  [[nodiscard]] std::vector<Result> take_results();

 private:
  void run();
  [[nodiscard]] Result perform(const Job& job);

  const StateDirectory& directory_;
  std::map<std::string, KeptFileWriter> files_;  ///< the thread's own
  std::mutex mutex_;                             ///< guards all below but the thread
  std::condition_variable changed_;
  std::deque<Job> jobs_;
  std::vector<Result> results_;
  bool working_ = false;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace stator::rack
