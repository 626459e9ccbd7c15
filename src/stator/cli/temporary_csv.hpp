#pragma once

#include <filesystem>
#include <string>
#include <system_error>

namespace stator::cli {

/// A file for the data of a plot that goes when the plot is drawn.
class TemporaryCsv {
 public:
  explicit TemporaryCsv(const std::string& beside) : path_(beside + ".csv.tmp") {}
  TemporaryCsv(const TemporaryCsv&) = delete;
  TemporaryCsv& operator=(const TemporaryCsv&) = delete;
  ~TemporaryCsv() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace stator::cli
