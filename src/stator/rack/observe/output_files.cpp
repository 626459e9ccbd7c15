#include "stator/rack/observe/output_files.hpp"

#include <algorithm>
#include <utility>

#include "stator/base/event.hpp"
#include "stator/rack/observe/event_log.hpp"

namespace stator::rack {

namespace {

constexpr base::EventRule kLoses{
    "output-loses", base::Severity::warning,
    "{0}: what comes is not taken quickly enough; what finds no room in its queue is lost and "
    "counted from now on, since no network waits for a file or a reader; read it faster, write it "
    "to a faster disk, or let less be written"};
constexpr base::EventRule kBreaksOff{
    "output-breaks-off", base::Severity::warning,
    "{0} ends here, since it may have no gaps and its disk does not take quickly enough what "
    "comes; write it to a faster disk"};
constexpr base::EventRule kFails{"output-failed", base::Severity::warning,
                                 "{0}; this file ends here"};
constexpr base::EventRule kIsLeft{"output-reader-gone", base::Severity::information,
                                  "{0}: its reader has gone, so this output ends here"};

}  // namespace

void OutputFiles::add(link::BackgroundOutput& output, Description description) {
  File& file = files_.emplace_back(output, std::move(description));
  if (loses_ && !file.description.always_waits) {
    output.set_when_full(link::WhenFull::drop);
  }
}

void OutputFiles::remove(const link::BackgroundOutput& output) {
  files_.remove_if([&output](const File& file) { return file.output == &output; });
}

void OutputFiles::lose_rather_than_wait() {
  loses_ = true;
  for (const File& file : files_) {
    if (!file.description.always_waits) {
      file.output->set_when_full(link::WhenFull::drop);
    }
  }
}

// Losses from now on are reported by finish() only: they do not mean that a writer was too slow.
void OutputFiles::stop_waiting() {
  for (File& file : files_) {
    file.reported = true;
    file.output->stop_waiting();
  }
}

bool OutputFiles::have_news() const {
  return std::ranges::any_of(files_, &File::has_news);
}

void OutputFiles::look(base::SimTime now) {
  for (File& file : files_) {
    if (file.has_news()) [[unlikely]] {
      tell(file, now);
    }
  }
}

void OutputFiles::tell(File& file, base::SimTime now) {
  if (const auto error = file.output->error()) {
    if (!file.failed.exchange(true)) {
      const bool left = file.output->reader_has_gone();
      report(file, now, left ? kIsLeft : kFails, left ? file.description.name : error->text);
    }
  } else if (!file.reported.exchange(true)) {
    report(file, now, file.description.ends_at_loss ? kBreaksOff : kLoses, file.description.name);
  }
}

void OutputFiles::report(const File& file, base::SimTime now, const base::EventRule& rule,
                         const std::string& text) {
  log_.on_event({now, &rule, file.description.device, {base::SharedText(text)}});
}

std::vector<std::string> OutputFiles::finish(link::BackgroundOutput::Clock::time_point asked) {
  std::vector<std::string> sentences;
  for (const File& file : files_) {
    if (!file.description.wanted_complete) {
      continue;
    }
    file.output->finish(asked);
    if (!file.output->complete()) {
      sentences.push_back(file.description.name + " is not complete: " +
                          file.output->what_is_missing(file.description.records));
    }
  }
  return sentences;
}

}  // namespace stator::rack
