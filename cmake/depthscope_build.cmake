# Compiler settings and the functions that folders use.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_CXX_FLAGS_RELEASE "-O3 -DNDEBUG")
set(CMAKE_CXX_FLAGS_DEBUG "-O1 -g")
find_package(Threads REQUIRED)

add_library(depthscope_options INTERFACE)
target_compile_options(depthscope_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Werror)
# A portable baseline. Wider SIMD is chosen at run time, function by function, where it gives the same
# bits, so that one input gives one output on every processor.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  target_compile_options(depthscope_options INTERFACE -march=x86-64-v2 -mtune=generic)
elseif(CMAKE_SYSTEM_PROCESSOR MATCHES "aarch64|arm64")
  # No fused multiply-add behind the programmer's back: it would make results depend on inlining.
  target_compile_options(depthscope_options INTERFACE -march=armv8-a -ffp-contract=off)
endif()

set(DEPTHSCOPE_SANITIZE "" CACHE STRING "Sanitizers to build with: address,undefined or thread")
if(DEPTHSCOPE_SANITIZE)
  add_compile_options(-fsanitize=${DEPTHSCOPE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${DEPTHSCOPE_SANITIZE})
  add_compile_definitions(DEPTHSCOPE_SANITIZED)
endif()

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # The sloppiness lets ccache serve units that use a precompiled header.
  set(CMAKE_CXX_COMPILER_LAUNCHER
      ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE_PROGRAM})
  add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-fpch-preprocess>)
endif()

# depthscope_module(name SOURCES... [PUBLIC targets...] [PRIVATE targets...] [PCH headers...])
# One static library depthscope_<name>; includes are written from the repository's root.
function(depthscope_module name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC;PRIVATE;PCH" ${ARGN})
  add_library(depthscope_${name} STATIC ${ARG_SOURCES})
  target_link_libraries(depthscope_${name} PUBLIC depthscope_types ${ARG_PUBLIC}
                                           PRIVATE depthscope_options ${ARG_PRIVATE})
  if(ARG_PCH)
    target_precompile_headers(depthscope_${name} PRIVATE ${ARG_PCH})
  endif()
endfunction()

# For modules that compute much: results do not depend on which expressions the compiler fuses, and
# loops become vectors, for neither errno nor the floating-point flags are looked at.
function(depthscope_exact_floats name)
  target_compile_options(depthscope_${name} PRIVATE -ffp-contract=off -fno-math-errno -fno-trapping-math)
endfunction()

# depthscope_test(name SOURCES... LIBRARIES...): one GoogleTest program, each test known to ctest.
function(depthscope_test name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBRARIES" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE depthscope_options ${ARG_LIBRARIES} GTest::gmock_main)
  target_compile_definitions(${name} PRIVATE DEPTHSCOPE_TEST_DATA="${CMAKE_SOURCE_DIR}/tests/data")
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 300)
endfunction()
