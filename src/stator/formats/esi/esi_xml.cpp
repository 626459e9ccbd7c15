#include "stator/formats/esi/esi_xml.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "stator/formats/esi/esi_encoding.hpp"
#include "stator/formats/nesting.hpp"

namespace stator::formats {

namespace {

using dictionary::ImportError;
using dictionary::ImportKind;
using dictionary::ImportNote;

/// The largest known file has 60 MB. Lines are kept in 32 bits.
constexpr std::size_t kLargestFile = std::size_t{1} << 29;

/// Values of elements lie in them instead of in nodes of their own, which halves the tree.
constexpr unsigned kParsing = pugi::parse_cdata | pugi::parse_escapes | pugi::parse_eol |
                              pugi::parse_wconv_attribute | pugi::parse_embed_pcdata;

/// How many notes of one rule are told.
constexpr std::size_t kTold = 40;

std::size_t line_at(std::string_view text, std::size_t offset) {
  const std::string_view before = text.substr(0, offset);
  return 1 + static_cast<std::size_t>(std::ranges::count(before, '\n'));
}

bool begins_name(char c) {
  return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_' || c == ':' ||
         static_cast<unsigned char>(c) >= 0x80;
}

/// Where an entity is declared before the first element. Entities could grow without bound, or
/// stand for files; no description needs them.
std::optional<std::size_t> entity_declared_at(std::string_view text) {
  for (std::size_t at = text.find('<'); at < text.size(); at = text.find('<', at + 1)) {
    const std::string_view rest = text.substr(at);
    if (rest.starts_with("<!--")) {
      at = text.find("-->", at);
    } else if (rest.starts_with("<?")) {
      at = text.find("?>", at);
    } else if (rest.starts_with("<!ENTITY") || rest.starts_with("<!entity")) {
      return at;
    } else if (rest.size() > 1 && begins_name(rest[1])) {
      return std::nullopt;
    }
    if (at == std::string_view::npos) {
      return std::nullopt;
    }
  }
  return std::nullopt;
}

/// Elements that hold lists of any length; others with more children than this are an attack on
/// whoever looks for one by its name.
constexpr std::size_t kMostChildren = 2048;
constexpr std::array<std::string_view, 16> kLists{"EtherCATInfoList",
                                                  "Descriptions",
                                                  "Groups",
                                                  "Devices",
                                                  "Device",
                                                  "Modules",
                                                  "Module",
                                                  "DataTypes",
                                                  "DataType",
                                                  "Objects",
                                                  "Profile",
                                                  "CoE",
                                                  "CANopenObjectList",
                                                  "parameterList",
                                                  "dataTypeList",
                                                  "templateList"};

/// The first element that is nested too deep, or has more children than any. Walks without calling
/// itself.
pugi::xml_node beyond_limits(pugi::xml_node top) {
  std::array<std::size_t, kDeepestNesting + 1> children{};
  std::size_t depth = 0;
  for (pugi::xml_node node = top; node;) {
    if (pugi::xml_node child = node.first_child()) {
      if (depth == kDeepestNesting) {
        return child;
      }
      ++depth;
      children[depth] = 1;
      node = child;
      continue;
    }
    while (node != top && !node.next_sibling()) {
      node = node.parent();
      --depth;
    }
    if (node == top) {
      break;
    }
    node = node.next_sibling();
    if (++children[depth] > kMostChildren &&
        std::ranges::find(kLists, local_name(node.parent())) == kLists.end()) {
      return node;
    }
  }
  return {};
}

}  // namespace

std::string_view local_name(pugi::xml_node node) {
  const std::string_view name = node.name();
  return name.substr(name.find(':') + 1);
}

base::Expected<EsiXml, ImportError> EsiXml::read(std::string_view file) {
  if (file.size() > kLargestFile) {
    return refusal(0, "too-large", "the file has more than 512 MB; no device description has");
  }
  EsiXml xml;
  EsiDecoded decoded = decode_esi(file);
  std::string& text = *xml.text_;
  text = std::move(decoded.text);
  // Editors of old systems leave zeros or a control-Z behind the end.
  constexpr std::string_view kBehindEnd("\0\x1A \t\r\n", 6);
  text.resize(text.find_last_not_of(kBehindEnd) + 1);  // npos + 1 is 0
  if (const std::size_t zero = text.find('\0'); zero != std::string::npos) {
    return refusal(line_at(text, zero), "not-xml",
                   "there are zero bytes in the file, so it is no XML text; a binary SII image is "
                   "read as such if its name ends in .bin");
  }
  if (text.find('<') == std::string::npos) {
    return refusal(0, "not-xml", "this is no XML text; an ESI file begins with <EtherCATInfo>");
  }
  if (const auto entity = entity_declared_at(text)) {
    return refusal(line_at(text, *entity), "xml-entity",
                   "the file declares entities, which could stand for other files or grow without "
                   "bound; write out what they stand for and take the DOCTYPE out");
  }
  for (const auto& [sentence, kind] : {std::pair{&decoded.repaired, ImportKind::repaired},
                                       std::pair{&decoded.assumed, ImportKind::assumed}}) {
    if (!sentence->empty()) {
      xml.notes_.push_back({kind, 1, "encoding", *sentence});
    }
  }
  for (std::size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + 1)) {
    xml.line_ends_.push_back(static_cast<std::uint32_t>(at));
  }
  const pugi::xml_parse_result parsed =
      xml.document_->load_buffer_inplace(text.data(), text.size(), kParsing, pugi::encoding_utf8);
  if (!parsed) {
    const auto at = static_cast<std::uint32_t>(std::max<std::ptrdiff_t>(parsed.offset, 0));
    const auto line = std::ranges::lower_bound(xml.line_ends_, at) - xml.line_ends_.begin() + 1;
    return refusal(static_cast<std::size_t>(line), "not-xml",
                   fmt::format("the file is no well-formed XML from here on ({}); is it complete?",
                               parsed.description()));
  }
  if (const pugi::xml_node beyond = beyond_limits(xml.document_->root())) {
    return refusal(xml.line_of(beyond), "too-deep",
                   fmt::format("elements are nested deeper than {}, or one has more than {} others "
                               "in it; no device description needs that",
                               kDeepestNesting, kMostChildren));
  }
  return xml;
}

std::size_t EsiXml::line_of(pugi::xml_node node) const {
  const std::ptrdiff_t offset = node.offset_debug();
  if (!node || offset < 0) {
    return 0;
  }
  const auto found = std::ranges::lower_bound(line_ends_, static_cast<std::uint32_t>(offset));
  return static_cast<std::size_t>(found - line_ends_.begin()) + 1;
}

void EsiNotes::add(ImportKind kind, pugi::xml_node at, std::string_view rule, std::string text) {
  auto found = std::ranges::find(rules_, rule, &Rule::name);
  if (found == rules_.end()) {
    found = rules_.insert(found, Rule{std::string(rule), kind, 0});
  }
  if (++found->count <= kTold) {
    report_.add(kind, xml_.line_of(at), found->name, std::move(text));
    return;
  }
  if (found->count == kTold + 1) {
    // Holds the place of the sentence that finish() writes.
    report_.add(kind, std::numeric_limits<std::size_t>::max(), found->name, "");
  }
}

void EsiNotes::finish() {
  const auto ours = report_.notes.begin() + static_cast<std::ptrdiff_t>(first_);
  std::stable_sort(ours, report_.notes.end(),
                   [](const ImportNote& a, const ImportNote& b) { return a.line < b.line; });
  for (auto note = ours; note != report_.notes.end(); ++note) {
    if (note->line == std::numeric_limits<std::size_t>::max()) {
      const auto rule = std::ranges::find(rules_, note->rule, &Rule::name);
      note->line = 0;
      note->text = fmt::format("the same in {} other places", rule->count - kTold);
    }
  }
}

}  // namespace stator::formats
