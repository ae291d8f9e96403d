# Installs a build of perch under a prefix of its own, builds tests/consumer against it, and runs that.
# cmake -D BUILD=... -D SOURCE=... -D WORK=... -D SCENE=... -D COMPILER=... -D BUILD_TYPE=... -P consumer_test.cmake
file(REMOVE_RECURSE ${WORK})
function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)

file(GLOB_RECURSE support RELATIVE ${WORK}/prefix ${WORK}/prefix/include/*test*)
if(support)
  message(FATAL_ERROR "headers of tests were installed: ${support}")
endif()

run(${CMAKE_COMMAND} -S ${SOURCE} -B ${WORK}/build -G Ninja -DCMAKE_CXX_COMPILER=${COMPILER}
    -DCMAKE_BUILD_TYPE=${BUILD_TYPE} -DCMAKE_PREFIX_PATH=${WORK}/prefix)
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${WORK}/build/consumer ${SCENE})
run(${WORK}/prefix/bin/perch --version)
