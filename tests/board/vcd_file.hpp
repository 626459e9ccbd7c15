#pragma once

#include <cstdint>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "stator/board/lines/logic_trace.hpp"
#include "stator/board/lines/vcd.hpp"

namespace stator::board {

/// Collects what a trace gives away.
struct Collector {
  std::vector<TraceRecord> records;
  void take(std::span<const TraceRecord> block) {
    records.insert(records.end(), block.begin(), block.end());
  }
  LogicTrace::Sink sink() { return LogicTrace::Sink::bind<&Collector::take>(*this); }
};

inline std::array<std::string, kLines> names() {
  std::array<std::string, kLines> result;
  for (Line line = 0; line < kLines; ++line) {
    result[line] = line_name(line);
  }
  return result;
}

/// The text of a value change dump, read back as a viewer does.
class VcdFile {
 public:
  struct Change {
    std::int64_t time;
    std::string value;
  };

  explicit VcdFile(const std::string& text) {
    std::istringstream in(text);
    std::map<std::string, std::string> codes;
    std::string word;
    while (in >> word && word != "$enddefinitions") {
      if (word == "$var") {
        std::string kind, width, code, name;
        in >> kind >> width >> code >> name;
        codes[code] = name;
      }
    }
    in >> word;
    std::int64_t time = 0;
    while (in >> word) {
      if (word[0] == '#') {
        time = std::stoll(word.substr(1));
      } else if (word[0] == 's') {
        std::string code;
        in >> code;
        changes_[codes.at(code)].push_back({time, word.substr(1)});
      } else {
        changes_[codes.at(word.substr(1))].push_back({time, word.substr(0, 1)});
      }
    }
  }

  [[nodiscard]] const std::vector<Change>& of(const std::string& name) const {
    return changes_.at(name);
  }
  /// Times at which a wire rises or falls.
  [[nodiscard]] std::vector<std::int64_t> edges(const std::string& name, bool rising) const {
    std::vector<std::int64_t> result;
    for (std::size_t k = 1; k < of(name).size(); ++k) {
      if (of(name)[k].value == (rising ? "1" : "0")) {
        result.push_back(of(name)[k].time);
      }
    }
    return result;
  }
  /// The level just before a time.
  [[nodiscard]] bool before(const std::string& name, std::int64_t time) const {
    bool level = false;
    for (const Change& change : of(name)) {
      if (change.time >= time) {
        break;
      }
      level = change.value == "1";
    }
    return level;
  }

 private:
  std::map<std::string, std::vector<Change>> changes_;
};

/// The text of everything a trace has noted.
inline std::string vcd_text(LogicTrace& trace, const Collector& collector) {
  trace.flush();
  VcdFormat format("board", trace, names());
  std::string text = format.header();
  format.append(text, collector.records);
  return text;
}

}  // namespace stator::board
