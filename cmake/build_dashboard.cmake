# Run at build time: builds the pages in ROOT into OUTPUT with NPM. Packages are installed below ROOT
# when the lock file is newer than what is there; builds of several presets share them, one at a time.
file(LOCK ${ROOT}/.build-lock GUARD PROCESS TIMEOUT 600)

function(run_npm)
  execute_process(COMMAND ${NPM} ${ARGN} WORKING_DIRECTORY ${ROOT} RESULT_VARIABLE result
    OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${output}\n\"npm ${command}\" failed in ${ROOT}, see above. Without the "
      "dashboard the rest builds with -DSTATOR_BUILD_DASHBOARD=OFF.")
  endif()
endfunction()

set(installed ${ROOT}/node_modules/.package-lock.json)
if(NOT EXISTS ${installed} OR ${ROOT}/package-lock.json IS_NEWER_THAN ${installed})
  run_npm(ci --ignore-scripts --no-audit --no-fund)
endif()
run_npm(exec --offline -- vite build --outDir ${OUTPUT} --emptyOutDir --logLevel warn)
