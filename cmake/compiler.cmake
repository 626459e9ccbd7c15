# Warnings, determinism and sanitizers: one interface target that every target of the project links.

# Same inputs, same bits: a fused multiply-add rounds once where two operations round twice. GCC 12's straight-line
# vectoriser emits fused operations even with contraction off. Whoever compiles inline code of the rooms needs these
# as well, so they travel with the room `base`.
set(STATOR_SAME_BITS_OPTIONS $<$<COMPILE_LANGUAGE:CXX>:-ffp-contract=off>
  $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-fno-tree-slp-vectorize>)

add_library(stator_compile_options INTERFACE)

target_compile_options(stator_compile_options INTERFACE
  -Wall -Wextra -Wconversion -Wshadow -Wpedantic -Wnon-virtual-dtor -Woverloaded-virtual
  -ffp-contract=off)
if(STATOR_WARNINGS_AS_ERRORS)
  target_compile_options(stator_compile_options INTERFACE -Werror)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(stator_compile_options INTERFACE -fno-tree-slp-vectorize)
  if(CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # GCC 12 sees overlaps and overflows in std::string that are not there (GCC bugs 105329 and 105651), the latter
    # because it forgets that precompiled headers are the system's.
    target_compile_options(stator_compile_options INTERFACE
      -Wno-restrict -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread)
  endif()
endif()

# What programs of others load takes the options so far: a sanitizer has to be in a program from its
# start.
get_target_property(plain_options stator_compile_options INTERFACE_COMPILE_OPTIONS)
add_library(stator_plain_options INTERFACE)
target_compile_options(stator_plain_options INTERFACE ${plain_options})

# The library also goes into what programs load: the module for Python, plug-ins of others. Hidden, its functions are
# called as directly as in a program. The same for all targets, since they share precompiled headers.
target_compile_options(stator_compile_options INTERFACE
  -fPIC -fno-semantic-interposition -fvisibility=hidden -fvisibility-inlines-hidden)

if(STATOR_SANITIZE)
  target_compile_options(stator_compile_options INTERFACE
    -fsanitize=${STATOR_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(stator_compile_options INTERFACE -fsanitize=${STATOR_SANITIZE})
endif()

# What fuzzers learn from, and what takes it back. With ON these are also the operands of comparisons and the depth of the stack,
# which is about a quarter of the time that tests take in the same build.
if(STATOR_FUZZ STREQUAL "BRANCHES")
  target_compile_options(stator_compile_options INTERFACE -fsanitize-coverage=inline-8bit-counters,pc-table)
  set(STATOR_UNCOUNTED_OPTIONS -fno-sanitize-coverage=inline-8bit-counters,pc-table)
elseif(STATOR_FUZZ)
  target_compile_options(stator_compile_options INTERFACE -fsanitize=fuzzer-no-link)
  target_link_options(stator_compile_options INTERFACE -fsanitize=fuzzer-no-link)
  set(STATOR_UNCOUNTED_OPTIONS -fno-sanitize=fuzzer-no-link)
endif()

find_program(STATOR_CCACHE ccache)
if(STATOR_CCACHE)
  # Without this sloppiness a source with a precompiled header is compiled anew each time. Paths
  # below the source directory count relative to it, so that every clone shares the cache.
  set(CMAKE_CXX_COMPILER_LAUNCHER
    ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros
    CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1 ${STATOR_CCACHE})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(stator_compile_options INTERFACE -fpch-preprocess)
  else()
    # A precompiled header of Clang's otherwise differs each time it is made.
    target_compile_options(stator_compile_options INTERFACE "SHELL:-Xclang -fno-pch-timestamp")
  endif()
endif()
