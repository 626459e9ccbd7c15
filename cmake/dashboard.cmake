# The pages that the web room serves. With STATOR_BUILD_DASHBOARD they are built by npm, otherwise one
# page says how to get them. stator_dashboard_source(VARIABLE) makes the C++ source that contains them.

set(node_found OFF)
find_program(STATOR_NODE NAMES node nodejs)
find_program(STATOR_NPM npm)
if(STATOR_NODE AND STATOR_NPM)
  execute_process(COMMAND ${STATOR_NODE} --version OUTPUT_VARIABLE node_version ERROR_QUIET
    OUTPUT_STRIP_TRAILING_WHITESPACE)
  string(REGEX REPLACE "^v" "" node_version "${node_version}")
  if(node_version VERSION_GREATER_EQUAL 18)
    set(node_found ON)
  endif()
endif()
option(STATOR_BUILD_DASHBOARD "Build the dashboard (needs Node.js 18 and npm)" ${node_found})
if(STATOR_BUILD_DASHBOARD AND NOT node_found)
  message(FATAL_ERROR "STATOR_BUILD_DASHBOARD needs Node.js 18 or newer and npm; install them "
    "(scripts/setup build), or configure with -DSTATOR_BUILD_DASHBOARD=OFF")
endif()

function(stator_dashboard_source variable)
  set(pages ${PROJECT_SOURCE_DIR}/dashboard/not-built)
  file(GLOB built CONFIGURE_DEPENDS ${pages}/*)
  if(STATOR_BUILD_DASHBOARD)
    set(root ${PROJECT_SOURCE_DIR}/dashboard)
    set(pages ${PROJECT_BINARY_DIR}/dashboard)
    set(built ${pages}/index.html)
    file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${root}/src/*)
    list(FILTER sources EXCLUDE REGEX "\\.test\\.tsx?$")
    add_custom_command(OUTPUT ${built}
      COMMAND ${CMAKE_COMMAND} -DROOT=${root} -DOUTPUT=${pages} -DNPM=${STATOR_NPM}
        -P ${PROJECT_SOURCE_DIR}/cmake/build_dashboard.cmake
      DEPENDS ${sources} ${root}/index.html ${root}/package.json ${root}/package-lock.json
        ${root}/vite.config.ts ${root}/tsconfig.json ${PROJECT_SOURCE_DIR}/cmake/build_dashboard.cmake
      COMMENT "Building the dashboard" VERBATIM)
  endif()
  set(source ${CMAKE_CURRENT_BINARY_DIR}/dashboard_assets.cpp)
  add_custom_command(OUTPUT ${source}
    COMMAND ${CMAKE_COMMAND} -DROOT=${pages} -DOUTPUT=${source}
      -P ${PROJECT_SOURCE_DIR}/cmake/embed_assets.cmake
    DEPENDS ${built} ${PROJECT_SOURCE_DIR}/cmake/embed_assets.cmake VERBATIM)
  set(${variable} ${source} PARENT_SCOPE)
endfunction()
