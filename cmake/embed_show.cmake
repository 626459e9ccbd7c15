# Run at build time: writes OUTPUT, a C++ source with the texts of FILES, which are named from ROOT on, for
# src/stator/cli/run/show_files.hpp.
set(source "// Made by cmake/embed_show.cmake.\n#include \"stator/cli/run/show_files.hpp\"\n\n#include <array>\n\n")
string(APPEND source "namespace stator::cli {\n\nnamespace {\n\nconstexpr auto kFiles = std::to_array<ShowFile>({\n")
string(REPLACE "," ";" files "${FILES}")
foreach(path IN LISTS files)
  file(READ ${ROOT}/${path} text)
  string(APPEND source "    {\"${path}\", R\"show(${text})show\"},\n")
endforeach()
string(APPEND source "});\n\n}  // namespace\n\nstd::span<const ShowFile> show_files() {\n  return kFiles;\n}\n\n}  // namespace stator::cli\n")
file(WRITE ${OUTPUT} "${source}")
