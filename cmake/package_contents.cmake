# Run by CPack before it packs: what Debian's policy wants in a package beside what `cmake --install` installs - manual pages
# packed, changelogs, a copyright file in place of a copy of the licence, reasons for what lintian says.
cmake_minimum_required(VERSION 3.25)

# The same sources give the same packages: all times are that of the last commit, or what SOURCE_DATE_EPOCH says.
if(NOT DEFINED ENV{SOURCE_DATE_EPOCH})
  execute_process(COMMAND git -C ${CPACK_STATOR_SOURCE} log -1 --format=%ct OUTPUT_VARIABLE time
    OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(NOT time)
    string(TIMESTAMP time %s)
  endif()
  set(ENV{SOURCE_DATE_EPOCH} ${time})
endif()
# Debian wants English names of days and months, and time stamps as mail has them.
set(ENV{LC_ALL} C)
execute_process(COMMAND date --utc --date=@$ENV{SOURCE_DATE_EPOCH} "+%a, %d %b %Y %H:%M:%S +0000"
  OUTPUT_VARIABLE date OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)

function(pack_file from to)
  execute_process(COMMAND gzip --best --no-name --stdout ${from} OUTPUT_FILE ${to} COMMAND_ERROR_IS_FATAL ANY)
  file(CHMOD ${to} PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
endfunction()

function(complete root package)
  set(documents ${root}/share/doc/${package})
  file(REMOVE ${root}/share/doc/stator/LICENSE)
  file(GLOB others ${root}/share/doc/stator/*)
  if(NOT others)
    file(REMOVE_RECURSE ${root}/share/doc/stator)
  endif()
  file(MAKE_DIRECTORY ${documents})
  file(COPY ${CPACK_STATOR_PACKAGING}/copyright DESTINATION ${documents}
    FILE_PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
  pack_file(${CPACK_STATOR_SOURCE}/CHANGELOG.md ${documents}/changelog.gz)
  set(version ${CPACK_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})
  set(changelog ${CPACK_TEMPORARY_DIRECTORY}/changelog)
  file(WRITE ${changelog} "${CPACK_PACKAGE_NAME} (${version}) unstable; urgency=medium\n\n"
    "  * Package version ${CPACK_PACKAGE_VERSION}; changelog.gz tells what has changed in it.\n\n"
    " -- ${CPACK_PACKAGE_CONTACT}  ${date}\n")
  pack_file(${changelog} ${documents}/changelog.Debian.gz)
  file(REMOVE ${changelog})
  file(GLOB pages ${root}/share/man/man*/*.[1-9])
  foreach(page IN LISTS pages)
    pack_file(${page} ${page}.gz)
    file(REMOVE ${page})
  endforeach()
  set(overrides ${CPACK_STATOR_PACKAGING}/${package}.lintian-overrides)
  if(EXISTS ${overrides})
    file(MAKE_DIRECTORY ${root}/share/lintian/overrides)
    file(COPY_FILE ${overrides} ${root}/share/lintian/overrides/${package})
  endif()
endfunction()

complete(${CPACK_TEMPORARY_DIRECTORY}/program/usr stator)
complete(${CPACK_TEMPORARY_DIRECTORY}/library/usr libstator-dev)
