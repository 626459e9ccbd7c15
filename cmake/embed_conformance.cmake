# Run at build time: writes OUTPUT, a C++ source with the lines of the requirements of each device and
# of what became of them, from DOCS/<device>.csv and DATA/<device>/requirements.csv.
file(GLOB tables ${DOCS}/*.csv)
list(SORT tables)
set(source "// Made by cmake/embed_conformance.cmake.\n#include \"stator/cli/describe/conformance_data.hpp\"\n\n#include <array>\n\n")
string(APPEND source "namespace stator::cli {\n\nnamespace {\n\n")
set(index "")
set(number 0)

# Lines instead of one text: compilers need not take literals of that length.
function(append_lines variable name path)
  file(READ ${path} text)
  string(REGEX REPLACE "\n$" "" text "${text}")
  string(REPLACE "\n" ")csv\",\n    R\"csv(" text "${text}")
  set(${variable} "${${variable}}constexpr auto ${name} = std::to_array<std::string_view>({\n    R\"csv(${text})csv\"});\n\n"
    PARENT_SCOPE)
endfunction()

foreach(table IN LISTS tables)
  get_filename_component(device ${table} NAME_WE)
  append_lines(source kRequirements${number} ${DATA}/${device}/requirements.csv)
  append_lines(source kOutcomes${number} ${table})
  string(APPEND index "    ConformanceTables{\"${device}\", kRequirements${number}, kOutcomes${number}},\n")
  math(EXPR number "${number} + 1")
endforeach()
string(APPEND source "constexpr auto kTables = std::to_array<ConformanceTables>({\n${index}});\n\n}  // namespace\n\n")
string(APPEND source "std::span<const ConformanceTables> conformance_tables() {\n  return kTables;\n}\n\n}  // namespace stator::cli\n")
file(WRITE ${OUTPUT} "${source}")
