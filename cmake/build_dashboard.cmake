# Run at build time: builds the pages in ROOT into OUTPUT with NODE and NPM. Packages are installed below ROOT
# when the lock file is newer than what is there, without those that only tests and checks need; builds of several presets
# share them, one at a time.
file(LOCK ${ROOT}/.build-lock GUARD PROCESS TIMEOUT 600)

function(run)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${ROOT} RESULT_VARIABLE result
    OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${output}\n\"${command}\" failed in ${ROOT}, see above. Without the "
      "dashboard the rest builds with -DSTATOR_BUILD_DASHBOARD=OFF.")
  endif()
endfunction()

set(installed ${ROOT}/node_modules/.package-lock.json)
if(NOT EXISTS ${installed} OR ${ROOT}/package-lock.json IS_NEWER_THAN ${installed})
  run(${NPM} ci --omit=dev --ignore-scripts --no-audit --no-fund)
endif()
run(${NODE} node_modules/vite/bin/vite.js build --outDir ${OUTPUT} --emptyOutDir --logLevel warn)
