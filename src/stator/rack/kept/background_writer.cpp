#include "stator/rack/kept/background_writer.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace stator::rack {

BackgroundWriter::BackgroundWriter(const StateDirectory& directory)
    : directory_(directory), thread_([this] { run(); }) {}

BackgroundWriter::~BackgroundWriter() {
  {
    const std::scoped_lock lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void BackgroundWriter::write(Job job) {
  {
    const std::scoped_lock lock(mutex_);
    const auto queued = std::ranges::find(jobs_, job.file, &Job::file);
    if (queued != jobs_.end()) {
      *queued = std::move(job);
    } else {
      jobs_.push_back(std::move(job));
    }
  }
  changed_.notify_all();
}

void BackgroundWriter::wait() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return jobs_.empty() && !working_; });
}

std::vector<BackgroundWriter::Result> BackgroundWriter::take_results() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(results_, {});
}

void BackgroundWriter::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return !jobs_.empty() || ending_; });
    if (jobs_.empty()) {
      return;
    }
    const Job job = std::move(jobs_.front());
    jobs_.pop_front();
    working_ = true;
    lock.unlock();
    Result result = perform(job);
    lock.lock();
    working_ = false;
    results_.push_back(std::move(result));
    changed_.notify_all();
  }
}

BackgroundWriter::Result BackgroundWriter::perform(const Job& job) {
  Result result{job.owner, job.version, job.content.kind, {}};
  try {
    files_.try_emplace(job.file, directory_, job.file).first->second.write(job.content);
  } catch (const std::runtime_error& error) {
    result.error = error.what();
  }
  return result;
}

}  // namespace stator::rack
