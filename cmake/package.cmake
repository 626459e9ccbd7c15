# Debian packages by CPack (docs/how-to/install.md): `stator`, the program with its guide, racks and service; `libstator-dev`,
# the library and the client in C. `cpack --config BUILD/CPackConfig.cmake` writes both into dist/; scripts/package also tries them.
#
# They are made of what cmake/install.cmake installs, below /usr. What only Debian's packages have is put beside it by
# cmake/package_contents.cmake.
set(packaging ${PROJECT_SOURCE_DIR}/packaging)

install(FILES ${packaging}/stator@.service DESTINATION lib/systemd/system COMPONENT service)
install(DIRECTORY ${packaging}/service DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/stator COMPONENT service)
# Where they stand they find each other by the same relative paths as in the source tree.
foreach(folder racks scenarios examples/mfc examples/tmcl examples/ci)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${folder}/ DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/stator/${folder}
    COMPONENT examples PATTERN __pycache__ EXCLUDE)
endforeach()
foreach(folder library c)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples/${folder}
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libstator-dev/examples COMPONENT library_examples)
endforeach()

# What has to be built before anything is packed; CPack itself builds nothing.
get_property(rooms GLOBAL PROPERTY STATOR_LIBRARY_ROOMS)
list(TRANSFORM rooms PREPEND stator_)
add_custom_target(package_contents DEPENDS stator stator_can_exec stator_chip ${rooms})

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME stator)
set(CPACK_PACKAGE_CONTACT "Stator maintainers <maintainers@stator.invalid>" CACHE STRING
  "Who answers for the packages: NAME <ADDRESS>")
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR})
set(CPACK_OUTPUT_FILE_PREFIX ${PROJECT_SOURCE_DIR}/dist)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/package_contents.cmake)
set(CPACK_STATOR_PACKAGING ${packaging})
set(CPACK_STATOR_SOURCE ${PROJECT_SOURCE_DIR})

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_COMPONENTS_ALL program service examples library chip library_examples)
foreach(component program service examples)
  string(TOUPPER ${component} name)
  set(CPACK_COMPONENT_${name}_GROUP program)
endforeach()
foreach(component library chip library_examples)
  string(TOUPPER ${component} name)
  set(CPACK_COMPONENT_${name}_GROUP library)
endforeach()

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME stator)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION electronics)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_CONTROL_EXTRA ${packaging}/postinst ${packaging}/prerm ${packaging}/postrm)
# Plots are drawn by it; all else works without.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "gnuplot-nox | gnuplot")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "libstator-dev, can-utils, bash-completion")
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION "virtual motion-control devices that real masters reach
Unmodified EtherCAT and CANopen masters and hosts that speak TMCL find
devices behind raw Ethernet, CAN and serial ports, configure them and move
their axes, behind which motors with their loads obey physics. Racks of such
devices run in real time or in lockstep, with faults on demand, recordings
and a dashboard in the browser.
.
The package has the program, its manual pages and completions, example racks
and scenarios, and a template by which systemd runs a rack as a service.")

set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libstator-dev)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS "libfmt-dev, libpugixml-dev, libtomlplusplus-dev")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SUGGESTS "stator (= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}), cmake, pkg-config")
set(CPACK_DEBIAN_LIBRARY_DESCRIPTION "virtual motion-control devices (library for C++ and C)
Racks of virtual EtherCAT, CANopen and TMCL devices in programs of one's own:
in the tests of a master, with devices that nobody has built yet, or a slave
controller, a motor or a load alone.
.
The package has static libraries, headers, files for CMake and pkg-config,
examples, and the client in C by which firmware reaches the pins of a virtual
chip.")

include(CPack)
