#include "stator/cli/guide/man_page.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <set>
#include <span>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "stator/cli/option_words.hpp"
#include "stator/cli/program_version.hpp"

namespace stator::cli {

namespace {

/// Text in which roff finds nothing to obey. A hyphen of a text may become a dash of the page;
/// what is to be copied keeps its own.
std::string escaped(std::string_view text, bool copied = false) {
  std::string result;
  for (const char c : text) {
    if (c == '\\') {
      result += "\\e";
    } else if (c == '-' && copied) {
      result += "\\-";
    } else {
      result += c;
    }
  }
  const bool request = result.starts_with('.') || result.starts_with('\'');
  return request ? "\\&" + result : result;
}

/// A part of the footer of a command's help, which has headings of its own.
struct Section {
  std::string title;
  std::vector<std::string> lines;
};

struct Heading {
  std::string_view in_help;
  std::string_view in_page;
};
constexpr std::array<Heading, 3> kHeadings{
    {{"Examples:", "EXAMPLES"}, {"Example:", "EXAMPLES"}, {"Exit status:", "EXIT STATUS"}}};

bool is_indented(const std::string& line) {
  return line.starts_with("  ");
}

std::vector<Section> sections_of(const std::string& footer) {
  std::vector<Section> sections{{"DESCRIPTION", {}}};
  std::istringstream text(footer);
  for (std::string line; std::getline(text, line);) {
    const auto heading = std::ranges::find_if(
        kHeadings, [&line](const Heading& each) { return line.starts_with(each.in_help); });
    if (heading != kHeadings.end()) {
      sections.push_back({std::string(heading->in_page), {}});
      line.erase(0, heading->in_help.size());
      line.erase(0, line.find_first_not_of(' '));
    } else if (sections.size() > 1 && !is_indented(line) && !sections.back().lines.empty() &&
               is_indented(sections.back().lines.back())) {
      sections.push_back({"NOTES", {}});
    }
    if (!line.empty()) {
      sections.back().lines.push_back(line);
    }
  }
  return sections;
}

/// Lines that are indented stay as they are, others flow.
std::string body(const std::vector<std::string>& lines) {
  std::string text;
  bool as_is = false;
  for (const std::string& line : lines) {
    if (is_indented(line) != as_is) {
      text += as_is ? ".EE\n" : ".EX\n";
      as_is = !as_is;
    }
    text += escaped(line, as_is) + "\n";
  }
  return text + (as_is ? ".EE\n" : "");
}

std::string_view kind_of(Names names) {
  switch (names) {
    case Names::product:
      return "PRODUCT";
    case Names::directory:
      return "DIRECTORY";
    case Names::fault_kind:
      return "KIND";
    case Names::fault_key:
      return "KEY=VALUE";
    case Names::command:
      return "COMMAND";
    case Names::ethernet_link:
      return "LINK";
    case Names::can_port:
      return "PORT";
    case Names::serial_line:
      return "LINE";
    case Names::rack_file:
    case Names::scenario_file:
    case Names::recording:
    case Names::tmcl_program:
    case Names::file:
      break;
  }
  return "FILE";
}

std::string value_of(CLI::Option& option) {
  if (option.get_items_expected_max() == 0) {
    return {};
  }
  if (!option.get_option_text().empty()) {
    return option.get_option_text();
  }
  if (const auto choices = words_of(option).choices; !choices.empty()) {
    return fmt::format("{}", fmt::join(choices, "|"));
  }
  if (const auto named = words_of(option).named) {
    return std::string(kind_of(*named));
  }
  const std::string type = option.get_type_name();
  return type.substr(0, type.find(':'));
}

/// "1 to 500", from what CLI11 shows of a range: "UINT:UINT in [1 - 500]".
std::string range_of(const CLI::Option& option) {
  std::string type = option.get_type_name();
  const std::size_t begin = type.find(" in [");
  const std::size_t end = type.rfind(']');
  if (begin == std::string::npos || end == std::string::npos) {
    return {};
  }
  std::string range = type.substr(begin + 5, end - begin - 5);
  if (const std::size_t dash = range.find(" - "); dash != std::string::npos) {
    range.replace(dash, 3, " to ");
  }
  return range;
}

std::string sentence_of(const CLI::Option& option) {
  std::vector<std::string> remarks;
  if (const std::string range = range_of(option); !range.empty()) {
    remarks.push_back(range);
  }
  if (option.get_required()) {
    remarks.emplace_back("needed");
  }
  if (!option.get_default_str().empty()) {
    remarks.push_back(option.get_default_str() + " if left out");
  }
  const auto add = [&remarks](const char* word, const std::set<CLI::Option*>& others) {
    for (const CLI::Option* other : others) {
      remarks.push_back(fmt::format("{} {}", word, other->get_name()));
    }
  };
  add("with", option.get_needs());
  add("not with", option.get_excludes());
  std::ranges::sort(remarks.end() - static_cast<std::ptrdiff_t>(option.get_needs().size() +
                                                                option.get_excludes().size()),
                    remarks.end());
  return remarks.empty()
             ? option.get_description()
             : fmt::format("{} ({})", option.get_description(), fmt::join(remarks, "; "));
}

std::string row(const std::string& label, const std::string& text) {
  return fmt::format(".TP\n{}\n{}\n", label, escaped(text));
}

std::string option_row(CLI::Option& option) {
  std::vector<std::string> spellings;
  for (const std::string& spelling : spellings_of(option)) {
    spellings.push_back(fmt::format("\\fB{}\\fR", escaped(spelling, true)));
  }
  const std::string value = value_of(option);
  return row(fmt::format("{}{}{}", fmt::join(spellings, ", "), value.empty() ? "" : " ",
                         value.empty() ? "" : fmt::format("\\fI{}\\fR", escaped(value, true))),
             sentence_of(option));
}

std::string synopsis(CLI::App& command) {
  std::string text = fmt::format(R"(\fB{}\fR [\fIOPTIONS\fR])", escaped(path_of(command), true));
  for (CLI::Option* option : options_of(command)) {
    if (option->get_positional()) {
      const std::string name = fmt::format("\\fI{}\\fR", escaped(option->get_name(), true));
      const bool several = option->get_items_expected_max() > 1;
      const std::string word = name + (several ? "..." : "");
      text += option->get_required() ? fmt::format(" {}", word) : fmt::format(" [{}]", word);
    }
  }
  if (!commands_of(command).empty()) {
    text += " \\fICOMMAND\\fR";
  }
  return text + "\n";
}

std::string arguments_and_options(CLI::App& command) {
  std::string arguments;
  std::vector<std::pair<std::string, std::string>> groups;
  for (CLI::Option* option : options_of(command)) {
    if (option->get_positional()) {
      arguments +=
          row(fmt::format("\\fI{}\\fR", escaped(option->get_name(), true)), sentence_of(*option));
      continue;
    }
    const std::string& group = option->get_group();
    auto found = std::ranges::find(groups, group, &std::pair<std::string, std::string>::first);
    if (found == groups.end()) {
      found = groups.insert(groups.end(), {group, ""});
    }
    found->second += option_row(*option);
  }
  std::string text = arguments.empty() ? "" : ".SH ARGUMENTS\n" + arguments;
  for (const auto& [group, rows] : groups) {
    text += group == "Options" ? ".SH OPTIONS\n" : fmt::format(".SS {}\n", escaped(group));
    text += rows;
  }
  return text;
}

std::string commands(CLI::App& command) {
  std::string rows;
  for (CLI::App* sub : commands_of(command)) {
    rows += row(fmt::format("\\fB{}\\fR(1)", escaped(man_page_name(*sub), true)),
                sub->get_description());
  }
  return rows.empty() ? "" : ".SH COMMANDS\n" + rows;
}

/// Of commands that say nothing of their own.
constexpr std::string_view kExitStatus =
    ".SH EXIT STATUS\n"
    "0: done. 1: not done, or not as it should be; standard error says why.\n"
    "2: the command line is not understood.\n";

}  // namespace

std::string man_page_name(const CLI::App& command) {
  std::string name = path_of(command);
  std::ranges::replace(name, ' ', '-');
  return name;
}

std::string man_page(CLI::App& command) {
  const std::string name = man_page_name(command);
  std::string title = name;
  std::ranges::transform(title, title.begin(), [](char c) {
    return c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c;
  });
  std::string page = fmt::format(".TH {} 1 \"\" \"stator {}\" \"Stator\"\n", escaped(title, true),
                                 program_version());
  page +=
      fmt::format(".SH NAME\n{} \\- {}\n", escaped(name, true), escaped(command.get_description()));
  page += ".SH SYNOPSIS\n" + synopsis(command);
  bool tells_status = false;
  const std::vector<Section> sections = sections_of(command.get_footer());
  if (!sections.front().lines.empty()) {
    page += ".SH DESCRIPTION\n" + body(sections.front().lines);
  }
  page += arguments_and_options(command) + commands(command);
  for (const Section& section : std::span(sections).subspan(1)) {
    tells_status = tells_status || section.title == "EXIT STATUS";
    page += fmt::format(".SH {}\n", section.title) + body(section.lines);
  }
  if (!tells_status) {
    page += kExitStatus;
  }
  if (const CLI::App* parent = command.get_parent(); parent != nullptr) {
    page += fmt::format(".SH SEE ALSO\n\\fB{}\\fR(1)\n", escaped(man_page_name(*parent), true));
  }
  return page;
}

}  // namespace stator::cli
