# What is installed: the rooms as a library that other projects find (docs/library.md), and the program. Two components
# for `cmake --install --component`: library, program; the client in C of clients/c is a third, chip.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(STATOR_CONFIG_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/stator)
set(STATOR_PKGCONFIG_DIR ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
# From where a file of pkg-config is to the prefix, so that an installation can be moved.
file(RELATIVE_PATH STATOR_PREFIX_FROM_PKGCONFIG /${STATOR_PKGCONFIG_DIR} /)

# Writes and installs NAME.pc, for those who build without CMake.
function(stator_pkg_config name summary requires flags libraries)
  list(JOIN requires " " requires)
  list(JOIN flags " " flags)
  list(JOIN libraries " " libraries)
  set(file ${PROJECT_BINARY_DIR}/pkgconfig/${name}.pc)
  file(CONFIGURE OUTPUT ${file} @ONLY CONTENT [[
prefix=${pcfiledir}/@STATOR_PREFIX_FROM_PKGCONFIG@
libdir=${prefix}/@CMAKE_INSTALL_LIBDIR@
includedir=${prefix}/@CMAKE_INSTALL_INCLUDEDIR@

Name: @name@
Description: @summary@
Version: @PROJECT_VERSION@
Requires: @requires@
Cflags: -I${includedir} @flags@
Libs: -L${libdir} @libraries@
]])
  install(FILES ${file} DESTINATION ${STATOR_PKGCONFIG_DIR} COMPONENT library)
endfunction()

# A room that is a part of the library: its archive, its headers, and how others link it.
function(stator_library_room name uses libraries)
  set_property(GLOBAL APPEND PROPERTY STATOR_LIBRARY_ROOMS ${name})
  set_target_properties(stator_${name} PROPERTIES EXPORT_NAME ${name})
  if(NOT STATOR_INSTALL)
    return()
  endif()
  target_include_directories(stator_${name} INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  install(TARGETS stator_${name} EXPORT stator
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library)
  install(DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/stator
    COMPONENT library FILES_MATCHING PATTERN "*.hpp"
    PATTERN internal EXCLUDE PATTERN can_exec EXCLUDE)

  list(TRANSFORM uses PREPEND stator- OUTPUT_VARIABLE requires)
  set(archives -lstator_${name})
  foreach(library IN LISTS libraries)
    if(library STREQUAL "Threads::Threads")
      list(APPEND archives -pthread)
    elseif(NOT library MATCHES "BUILD_INTERFACE")
      string(REGEX REPLACE "^.*::" "" package ${library})
      list(APPEND requires ${package})
    endif()
  endforeach()
  set(flags)
  if(name STREQUAL base)
    set(flags -std=c++20 -ffp-contract=off -fno-tree-slp-vectorize)
  endif()
  stator_pkg_config(stator-${name} "Virtual motion-control devices: ${name}" "${requires}" "${flags}" "${archives}")
endfunction()

# Behind all rooms: stator::stator, which is all of them and has the headers of the public face, and the package.
function(stator_library)
  get_property(rooms GLOBAL PROPERTY STATOR_LIBRARY_ROOMS)
  add_library(stator_library INTERFACE)
  add_library(stator::stator ALIAS stator_library)
  set_target_properties(stator_library PROPERTIES EXPORT_NAME stator)
  # What uses others comes first.
  list(REVERSE rooms)
  list(TRANSFORM rooms PREPEND stator_ OUTPUT_VARIABLE targets)
  target_link_libraries(stator_library INTERFACE ${targets})
  if(NOT STATOR_INSTALL)
    return()
  endif()
  install(TARGETS stator_library EXPORT stator)
  install(EXPORT stator NAMESPACE stator:: FILE statorTargets.cmake DESTINATION ${STATOR_CONFIG_DIR} COMPONENT library)
  configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/statorConfig.cmake.in
    ${PROJECT_BINARY_DIR}/statorConfig.cmake INSTALL_DESTINATION ${STATOR_CONFIG_DIR})
  # Before 1.0 anything may change with the second number.
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/statorConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/statorConfig.cmake ${PROJECT_BINARY_DIR}/statorConfigVersion.cmake
    DESTINATION ${STATOR_CONFIG_DIR} COMPONENT library)
  file(GLOB face CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/stator/*.hpp)
  install(FILES ${face} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/stator COMPONENT library)
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT library)
  list(TRANSFORM rooms PREPEND stator- OUTPUT_VARIABLE packages)
  stator_pkg_config(stator "Virtual motion-control devices: all of the library" "${packages}" "" "")
endfunction()

# The program, and what it needs beside it.
function(stator_install_program)
  install(TARGETS stator RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
  # Where "stator can-exec" looks for it.
  install(TARGETS stator_can_exec LIBRARY DESTINATION lib/stator COMPONENT program)
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
  if(NOT CMAKE_CROSSCOMPILING)
    stator_install_guide()
  endif()
endfunction()

# Manual pages and completions, which the program makes from what its commands declare; made when they are installed, so
# that no build waits for them.
function(stator_install_guide)
  set(guide ${PROJECT_BINARY_DIR}/guide)
  set(stator [["$<TARGET_FILE:stator>"]])
  set(make "file(REMOVE_RECURSE \"${guide}\")\nfile(MAKE_DIRECTORY \"${guide}\")\n")
  string(APPEND make "execute_process(COMMAND ${stator} man --directory \"${guide}/man1\" COMMAND_ERROR_IS_FATAL ANY)\n")
  set(shells bash zsh fish)
  set(scripts stator _stator stator.fish)
  foreach(shell script IN ZIP_LISTS shells scripts)
    string(APPEND make "execute_process(COMMAND ${stator} completion ${shell} OUTPUT_FILE \"${guide}/${script}\" "
      "COMMAND_ERROR_IS_FATAL ANY)\n")
  endforeach()
  install(CODE "${make}" COMPONENT program)
  install(DIRECTORY ${guide}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT program)
  install(FILES ${guide}/stator DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT program)
  install(FILES ${guide}/_stator DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions COMPONENT program)
  install(FILES ${guide}/stator.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT program)
endfunction()
