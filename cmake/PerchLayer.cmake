# One CMake target a layer: perch_layer(name SOURCES a.cpp b.cpp DEPENDS core ... LINK pkg::target ... [PRIVATE_LINK ...]
# [KERNELS c.cpp], those of the sources that include core/for_each_instruction_set.hpp)
# makes the library perch_<name> (alias perch::<name>), and perch_layer_test(name [PLAIN] SOURCES a_test.cpp ...) its
# test program.

add_library(perch_options INTERFACE)
target_compile_features(perch_options INTERFACE cxx_std_20)
# Exact and the same on every machine: no fused multiply-add unless every path has it, no fast-math.
target_compile_options(perch_options INTERFACE -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion -ffp-contract=off)
# The same roots without a call for those of negative numbers, which only sets errno.
target_compile_options(perch_options INTERFACE -fno-math-errno)
# Vectors are passed between inlined functions only (core/lanes.inc), where no calling convention is at stake.
target_compile_options(perch_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-psabi>)
if(PERCH_UNITY)
  # What is local to one source would shadow what is local to another.
  target_compile_options(perch_options INTERFACE -Wno-shadow)
  # The sources are few: memory is there to be used, and collecting it takes time.
  target_compile_options(perch_options INTERFACE
                         $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-expand=300>
                         $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=500000>)
endif()
if(PERCH_WERROR)
  target_compile_options(perch_options INTERFACE -Werror)
endif()
if(PERCH_SANITIZE)
  # The checks left out find what AddressSanitizer finds too, or casts that this code has none of, and double
  # the time to compile Eigen's expressions.
  target_compile_options(perch_options INTERFACE -fsanitize=${PERCH_SANITIZE}
                         -fno-sanitize=null,alignment,object-size,pointer-overflow,vptr -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(perch_options INTERFACE -fsanitize=${PERCH_SANITIZE})
endif()

# The headers that take longest to read, read once for each kind of source: libraries, the program, tests, and
# tests that compute little and are not optimized at all, since most of them is json and matchers.
function(perch_precompile target)
  cmake_parse_arguments(P "" "" "OPTIONS;LINK;HEADERS" ${ARGN})
  file(WRITE ${PROJECT_BINARY_DIR}/precompiled/${target}.cpp "")
  add_library(${target} STATIC ${PROJECT_BINARY_DIR}/precompiled/${target}.cpp)
  target_link_libraries(${target} PRIVATE perch_options Eigen3::Eigen fmt::fmt ${P_LINK})
  target_compile_options(${target} PRIVATE ${P_OPTIONS})
  target_precompile_headers(${target} PRIVATE ${P_HEADERS} <Eigen/Geometry> <fmt/format.h> <algorithm> <cmath>
                            <functional> <map> <memory> <optional> <string> <vector>)
endfunction()
# What is tested is optimized; the tests themselves need not be, and compile faster so.
set(PERCH_TEST_OPTIONS $<$<CONFIG:Release>:-O1>)
set(PERCH_PLAIN_TEST_OPTIONS -O0)
set(PERCH_PROGRAM_OPTIONS $<IF:$<CONFIG:Release>,-O1,-O0>)
perch_precompile(perch_precompiled)
perch_precompile(perch_precompiled_program OPTIONS ${PERCH_PROGRAM_OPTIONS} LINK CLI11::CLI11 HEADERS <CLI/CLI.hpp>)
if(PERCH_TESTS)
  perch_precompile(perch_precompiled_tests OPTIONS ${PERCH_TEST_OPTIONS} LINK GTest::gtest GTest::gmock HEADERS <gtest/gtest.h>)
  perch_precompile(perch_precompiled_plain_tests OPTIONS ${PERCH_PLAIN_TEST_OPTIONS}
                   LINK GTest::gtest GTest::gmock nlohmann_json::nlohmann_json
                   HEADERS <gmock/gmock.h> <gtest/gtest.h> <nlohmann/json.hpp>)
endif()

function(perch_layer name)
  cmake_parse_arguments(L "" "" "SOURCES;DEPENDS;LINK;PRIVATE_LINK;KERNELS" ${ARGN})
  list(TRANSFORM L_DEPENDS PREPEND perch::)
  if(L_SOURCES)
    add_library(perch_${name} STATIC ${L_SOURCES})
    set(scope PUBLIC)
    target_link_libraries(perch_${name} PRIVATE $<BUILD_INTERFACE:perch_options> ${L_PRIVATE_LINK})
    target_precompile_headers(perch_${name} REUSE_FROM perch_precompiled)
    set_target_properties(perch_${name} PROPERTIES UNITY_BUILD ${PERCH_UNITY} UNITY_BUILD_BATCH_SIZE 0)
    set_source_files_properties(${L_KERNELS} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  else()
    add_library(perch_${name} INTERFACE)
    set(scope INTERFACE)
  endif()
  add_library(perch::${name} ALIAS perch_${name})
  set_target_properties(perch_${name} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(perch_${name} ${scope} cxx_std_20)
  target_include_directories(perch_${name} ${scope}
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(perch_${name} ${scope} ${L_DEPENDS} ${L_LINK})
  set_property(GLOBAL APPEND PROPERTY PERCH_LAYERS perch_${name})
  install(TARGETS perch_${name} EXPORT perchTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
endfunction()

function(perch_test target)
  cmake_parse_arguments(T "PLAIN" "TIMEOUT" "SOURCES;LINK;LABELS" ${ARGN})
  if(NOT PERCH_TESTS)
    return()
  endif()
  if(NOT T_TIMEOUT)
    set(T_TIMEOUT 300)
  endif()
  add_executable(${target} ${T_SOURCES})
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${PERCH_UNITY} UNITY_BUILD_BATCH_SIZE 0)
  if(T_PLAIN)
    target_precompile_headers(${target} REUSE_FROM perch_precompiled_plain_tests)
    target_compile_options(${target} PRIVATE ${PERCH_PLAIN_TEST_OPTIONS})
  else()
    target_precompile_headers(${target} REUSE_FROM perch_precompiled_tests)
    target_compile_options(${target} PRIVATE ${PERCH_TEST_OPTIONS})
  endif()
  target_link_libraries(${target} PRIVATE perch_options ${T_LINK} Eigen3::Eigen fmt::fmt GTest::gtest GTest::gmock GTest::gtest_main)
  # One process a test. Suites whose names end in Heavy get the label `heavy`: too slow for sanitizers.
  gtest_discover_tests(${target} TEST_FILTER "-*Heavy.*" DISCOVERY_TIMEOUT 60
    PROPERTIES TIMEOUT ${T_TIMEOUT} LABELS "${T_LABELS}")
  gtest_discover_tests(${target} TEST_FILTER "*Heavy.*" TEST_LIST ${target}_HEAVY DISCOVERY_TIMEOUT 60
    PROPERTIES TIMEOUT ${T_TIMEOUT} LABELS "heavy")
endfunction()

function(perch_layer_test name)
  cmake_parse_arguments(T "PLAIN" "" "SOURCES;LINK" ${ARGN})
  if(T_PLAIN)
    set(plain PLAIN)
  endif()
  perch_test(perch_${name}_test ${plain} SOURCES ${T_SOURCES} LINK perch::${name} ${T_LINK} LABELS ${name})
endfunction()
