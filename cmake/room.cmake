# A room is one folder below src/stator/, one namespace stator::<room> and one static library stator_<room>
# (alias stator::<room>). USES names the rooms it may include directly; scripts/check_layering.py
# verifies every #include against the same lists. PRECOMPILED names large headers of libraries that most
# of the room's sources include. APART and ALONE are further sources, see stator_compile_together. UNHURRIED:
# nothing in the room runs in every cycle, so that it is compiled quickly rather than well; optimising is half of
# the time where sanitizers are compiled in. PROGRAM: the room is a part of the program stator and not of the library
# that is installed (cmake/install.cmake).
function(stator_room name)
  cmake_parse_arguments(ROOM "UNHURRIED;PROGRAM" "" "SOURCES;APART;ALONE;USES;LIBRARIES;PRECOMPILED" ${ARGN})
  set(sources ${ROOM_SOURCES} ${ROOM_APART} ${ROOM_ALONE})
  list(REMOVE_ITEM sources AND)
  add_library(stator_${name} STATIC ${sources})
  stator_compile_together(stator_${name} "${ROOM_SOURCES}" "${ROOM_APART}")
  add_library(stator::${name} ALIAS stator_${name})
  target_include_directories(stator_${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>)
  target_link_libraries(stator_${name} PRIVATE $<BUILD_INTERFACE:stator_compile_options>)
  set(headers stator_standard_headers)
  if(ROOM_UNHURRIED)
    set(headers stator_standard_headers_unhurried)
    target_compile_options(stator_${name} PRIVATE ${STATOR_UNHURRIED_OPTIONS})
  endif()
  foreach(used IN LISTS ROOM_USES)
    target_link_libraries(stator_${name} PUBLIC stator_${used})
  endforeach()
  target_link_libraries(stator_${name} PRIVATE ${ROOM_LIBRARIES})
  if(ROOM_PRECOMPILED)
    target_precompile_headers(stator_${name} PRIVATE ${ROOM_PRECOMPILED})
  elseif(TARGET ${headers})
    target_precompile_headers(stator_${name} REUSE_FROM ${headers})
  endif()
  if(NOT ROOM_PROGRAM)
    stator_library_room(${name} "${ROOM_USES}" "${ROOM_LIBRARIES}")
  endif()
endfunction()

# Compiles sources of a target many at a time, which reads the headers they share once. The names that one source
# has for itself, in an unnamed namespace, are then seen by the next: a source with a name that another one of the
# list has as well stands in the list `apart`, which is compiled together but not with `sources`; the word AND divides
# it into lists that are not compiled with one another either. A source in no list is compiled alone. The build for
# clang-tidy compiles each source alone and so sees what it forgot to include.
function(stator_compile_together target sources apart)
  if(NOT STATOR_UNITY)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # To GCC each source of a group is a header, where a member of an unnamed namespace's type is a mistake.
    target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
  endif()
  stator_group_sources(sources "${sources}")
  set(together "")
  set(number 0)
  foreach(source IN LISTS apart ITEMS AND)
    if(NOT source STREQUAL "AND")
      list(APPEND together ${source})
      continue()
    endif()
    stator_group_sources(apart_${number} "${together}")
    set(together "")
    math(EXPR number "${number} + 1")
  endforeach()
endfunction()

# Gives sources to groups of at most 32 with names that begin with `name`: fewer and larger groups would keep one
# processor busy while others have nothing left to do.
function(stator_group_sources name sources)
  set(number 0)
  foreach(source IN LISTS sources)
    math(EXPR group "${number} / 32")
    math(EXPR number "${number} + 1")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${name}_${group})
  endforeach()
endfunction()

# Sources of a room that are compiled for processors with AVX2 or AVX-512 and run on those only. They
# include nothing with code of its own but what is always inline.
function(stator_vector_sources name)
  cmake_parse_arguments(VECTOR "" "" "AVX2;AVX512" ${ARGN})
  target_sources(stator_${name} PRIVATE ${VECTOR_AVX2} ${VECTOR_AVX512})
  set_source_files_properties(${VECTOR_AVX2} PROPERTIES COMPILE_OPTIONS "-mavx2")
  set_source_files_properties(${VECTOR_AVX512} PROPERTIES
    COMPILE_OPTIONS "-mavx512f;-mavx512dq;-mavx512vl;-mavx512bw")
  # Headers were precompiled for other instructions.
  set_source_files_properties(${VECTOR_AVX2} ${VECTOR_AVX512} PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
endfunction()

# One GoogleTest program per room: tests/<room>/*.cpp, registered case by case with CTest, or with STATOR_TEST_SHARDS
# in that many parts; of these the ones with the highest COST, 0 if it is not given, run first. APART and
# ALONE are further sources, see stator_compile_together.
function(stator_test_suite name)
  cmake_parse_arguments(SUITE "" "COST" "SOURCES;APART;ALONE;USES;LIBRARIES" ${ARGN})
  set(sources ${SUITE_SOURCES} ${SUITE_APART} ${SUITE_ALONE})
  list(REMOVE_ITEM sources AND)
  add_executable(test_${name} ${sources})
  stator_compile_together(test_${name} "${SUITE_SOURCES}" "${SUITE_APART}")
  target_include_directories(test_${name} PRIVATE
    ${PROJECT_SOURCE_DIR}/tests ${STATOR_TEST_INCLUDES})
  # First, so that its warnings come before what rooms ask of whoever uses them.
  target_link_libraries(test_${name} PRIVATE stator_compile_options)
  foreach(used IN LISTS SUITE_USES)
    target_link_libraries(test_${name} PRIVATE stator_${used})
  endforeach()
  target_link_libraries(test_${name} PRIVATE
    $<TARGET_NAME_IF_EXISTS:stator_uncounted> ${SUITE_LIBRARIES}
    GTest::gtest GTest::gmock GTest::gtest_main)
  # What is tested is optimised as users get it; optimising the tests only makes building slow.
  target_compile_options(test_${name} PRIVATE ${STATOR_TEST_OPTIONS})
  target_precompile_headers(test_${name} REUSE_FROM stator_test_headers)
  # Ends what hangs, whatever the machine does beside it.
  set(timeout 300)
  if(STATOR_SANITIZE)
    set(timeout 1200)
  endif()
  if(STATOR_TEST_SHARDS)
    stator_add_shards(test_${name} ${STATOR_TEST_SHARDS} ${timeout} "${SUITE_COST}")
  else()
    gtest_discover_tests(test_${name} DISCOVERY_TIMEOUT 300 PROPERTIES TIMEOUT ${timeout})
  endif()
endfunction()

# Registers a GoogleTest program as `count` cases, each of which runs every count-th test of it in one process. What
# fails is named at the end of its output; where a sanitizer ends it, the last line with RUN names the test.
function(stator_add_shards target count timeout cost)
  if(NOT cost)
    set(cost 0)
  endif()
  foreach(number RANGE 1 ${count})
    math(EXPR index "${number} - 1")
    add_test(NAME ${target}.${number}-of-${count} COMMAND ${target})
    set_tests_properties(${target}.${number}-of-${count} PROPERTIES TIMEOUT ${timeout} COST ${cost}
      ENVIRONMENT "GTEST_TOTAL_SHARDS=${count};GTEST_SHARD_INDEX=${index}")
  endforeach()
endfunction()
