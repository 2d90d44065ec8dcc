# SPDX-License-Identifier: BSD-3-Clause

# Interface target with the warnings that every source of ours must be free of.
add_library(palpate_warnings INTERFACE)
target_compile_options(palpate_warnings INTERFACE -Wall -Wextra -Wshadow)

#[[
palpate_add_library(<part>
  SOURCES <file>…
  [DEPENDS <part or imported target>…]
  [PRIVATE_DEPENDS <part or imported target>…]
  [INNER_LOOPS])

Makes the static, position-independent library palpate_<part> (alias palpate::<part>) of a folder
of solvers/ or haptic/. A dependency without "::" is the name of another part. DEPENDS are those
that the part's headers include. With INNER_LOOPS the part has loops in which time is spent.
]]
function(palpate_add_library part)
  cmake_parse_arguments(PARSE_ARGV 1 arg "INNER_LOOPS" "" "SOURCES;DEPENDS;PRIVATE_DEPENDS")
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "palpate_add_library(${part}): unknown arguments ${arg_UNPARSED_ARGUMENTS}")
  endif()
  palpate_resolve_targets(public ${arg_DEPENDS})
  palpate_resolve_targets(private ${arg_PRIVATE_DEPENDS})

  set(target palpate_${part})
  add_library(${target} STATIC ${arg_SOURCES})
  add_library(palpate::${part} ALIAS ${target})
  set_target_properties(${target} PROPERTIES
    POSITION_INDEPENDENT_CODE ON
    # The libraries end up inside the plugin: nothing of them is to be seen from outside.
    CXX_VISIBILITY_PRESET hidden
    VISIBILITY_INLINES_HIDDEN ON)
  if(arg_INNER_LOOPS)
    target_compile_options(${target} PRIVATE ${palpate_optimise_loops})
  endif()
  target_compile_features(${target} PUBLIC cxx_std_17)
  target_include_directories(${target} PUBLIC "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/solvers>")
  if(part MATCHES "^haptic_")
    target_include_directories(${target} PUBLIC "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>")
  endif()
  target_link_libraries(${target}
    PUBLIC ${public}
    PRIVATE ${private} "$<BUILD_INTERFACE:palpate_warnings>")
endfunction()

#[[
palpate_compile_as_tests()

From here on, in the current folder and below, sources are compiled as tests are: with assertions
and little optimisation. What is tested is in the libraries, and keeps the flags of its build type;
the tests themselves compile in two thirds of the time, and for two build types only once.
]]
macro(palpate_compile_as_tests)
  set(CMAKE_CXX_FLAGS_RELEASE "-O1 -D_GLIBCXX_ASSERTIONS")
  set(CMAKE_CXX_FLAGS_ASSERTIONS "${CMAKE_CXX_FLAGS_RELEASE}")
endmacro()

#[[
palpate_add_test_library(<name> SOURCES <file>… DEPENDS <part or imported target>…)

Makes the static library palpate_<name> (alias palpate::<name>) of what several tests or benchmarks
share. Headers are included relative to tests/.
]]
function(palpate_add_test_library name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;DEPENDS")
  palpate_resolve_targets(depends ${arg_DEPENDS})
  set(target palpate_${name})
  add_library(${target} STATIC ${arg_SOURCES})
  add_library(palpate::${name} ALIAS ${target})
  target_include_directories(${target} PUBLIC "${PROJECT_SOURCE_DIR}/tests")
  target_link_libraries(${target} PUBLIC ${depends} PRIVATE palpate_warnings)
endfunction()

# Turns names of parts into targets and leaves imported targets as they are.
function(palpate_resolve_targets result)
  set(targets "")
  foreach(name IN LISTS ARGN)
    if(NOT name MATCHES "::")
      set(name "palpate::${name}")
    endif()
    list(APPEND targets "${name}")
  endforeach()
  set(${result} "${targets}" PARENT_SCOPE)
endfunction()

#[[
palpate_add_instruction_sets(<part> <source>)

Compiles a source of a part once more for each instruction set that is known for this kind of
processor; it is one that uses PALPATE_INSTRUCTION_SET (solvers/base/simd.h). Where there are any,
the part sees PALPATE_X86_KERNELS.
]]
function(palpate_add_instruction_sets part source)
  set_source_files_properties(${source} PROPERTIES COMPILE_OPTIONS "${palpate_optimise_loops}")
  # -Wpsabi warns of passing wide vectors between sources compiled differently: none are.
  target_compile_options(palpate_${part} PRIVATE -Wno-psabi)
  if(NOT CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    return()
  endif()
  target_compile_definitions(palpate_${part} PRIVATE PALPATE_X86_KERNELS)
  foreach(set IN ITEMS
      "avx2;-mavx2;-mfma"
      "avx512;-mavx512f;-mavx512dq;-mfma;-mprefer-vector-width=512")
    list(POP_FRONT set name)
    set(target palpate_${part}_${name})
    add_library(${target} OBJECT ${source})
    set_target_properties(${target} PROPERTIES
      POSITION_INDEPENDENT_CODE ON
      CXX_VISIBILITY_PRESET hidden
      VISIBILITY_INLINES_HIDDEN ON)
    target_compile_features(${target} PRIVATE cxx_std_17)
    target_compile_definitions(${target} PRIVATE PALPATE_INSTRUCTION_SET=${name})
    target_compile_options(${target} PRIVATE ${set} -Wno-psabi)
    target_include_directories(${target} PRIVATE "${PROJECT_SOURCE_DIR}/solvers")
    target_link_libraries(${target} PRIVATE palpate_warnings)
    target_sources(palpate_${part} PRIVATE $<TARGET_OBJECTS:${target}>)
  endforeach()
endfunction()
