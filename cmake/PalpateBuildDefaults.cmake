# SPDX-License-Identifier: BSD-3-Clause
# What holds for every target: the language, the build type, where the products lie.

set(CMAKE_CXX_STANDARD 17)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()

# CMake's -O3 takes twice as long to compile as -O2. Parts whose loops gain by it ask for it: see
# INNER_LOOPS of palpate_add_library.
if(CMAKE_CXX_FLAGS_RELEASE STREQUAL "-O3 -DNDEBUG")
  set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG")
endif()
set(palpate_optimise_loops "$<$<CONFIG:Release>:-O3>")

set(CMAKE_ARCHIVE_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/${CMAKE_INSTALL_LIBDIR}")
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/${CMAKE_INSTALL_LIBDIR}")
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/${CMAKE_INSTALL_BINDIR}")

# Reference data beside a checkout is picked up without being asked for.
if(NOT PALPATE_SHARED_DATA AND IS_DIRECTORY "${PROJECT_SOURCE_DIR}/../shared/data")
  cmake_path(ABSOLUTE_PATH PROJECT_SOURCE_DIR NORMALIZE OUTPUT_VARIABLE source)
  cmake_path(GET source PARENT_PATH beside)
  set(PALPATE_SHARED_DATA "${beside}/shared/data" CACHE PATH "" FORCE)
endif()

# What two presets compile alike is compiled once: the tests (palpate_compile_as_tests). The folders
# of the build are different, so that ccache has to compare paths relative to the project.
find_program(PALPATE_CCACHE ccache)
mark_as_advanced(PALPATE_CCACHE)
if(PALPATE_CCACHE AND NOT DEFINED CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER env "CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}" "${PALPATE_CCACHE}")
endif()
