# Installs a build folder to a prefix inside it, then builds and runs the consumer against that prefix.
# cmake -D BUILD=... -D SOURCE=... -D GENERATOR=... -D COMPILER=... -P run.cmake
set(work ${BUILD}/install_consumer)
file(REMOVE_RECURSE ${work})

function(step what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${what} failed (${result}):\n${output}")
  endif()
  message(STATUS "${what}: done")
endfunction()

step("install" ${CMAKE_COMMAND} --install ${BUILD} --prefix ${work}/prefix)
file(GLOB_RECURSE strangers ${work}/prefix/include/*_test.* ${work}/prefix/include/ferrers/testing/*)
if(strangers)
  message(FATAL_ERROR "test files were installed: ${strangers}")
endif()
step("configure" ${CMAKE_COMMAND} -S ${SOURCE} -B ${work}/build -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${COMPILER}
     -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH=${work}/prefix -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF)
step("build" ${CMAKE_COMMAND} --build ${work}/build)
step("run" ${work}/build/consumer)
