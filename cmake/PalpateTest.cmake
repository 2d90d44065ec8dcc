# SPDX-License-Identifier: BSD-3-Clause
# Names of tests follow the folders: tests/solvers/mesh gives solvers.mesh.<Suite>.<Test>.

include(GoogleTest)
find_package(GTest REQUIRED)

if(PALPATE_WITH_MPI)
  # Tests run side by side: bound to cores, the first ranks of all of them would share one.
  # mpiexec needs the folder of its job, which a program of one rank is kept from making: see
  # PalpateTestEnvironment.cmake.
  set(palpate_mpiexec env OMPI_MCA_orte_create_session_dirs=1 "${MPIEXEC_EXECUTABLE}"
    --oversubscribe --bind-to none)
  execute_process(COMMAND id -u OUTPUT_VARIABLE uid OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(uid EQUAL 0)
    list(APPEND palpate_mpiexec --allow-run-as-root)
  endif()
endif()

# For every test at once: gtest_discover_tests() takes no list as the value of a property.
set_property(DIRECTORY "${PROJECT_SOURCE_DIR}" APPEND PROPERTY
  TEST_INCLUDE_FILES "${CMAKE_CURRENT_LIST_DIR}/PalpateTestEnvironment.cmake")

function(palpate_test_prefix result)
  cmake_path(RELATIVE_PATH CMAKE_CURRENT_SOURCE_DIR BASE_DIRECTORY "${PROJECT_SOURCE_DIR}/tests"
    OUTPUT_VARIABLE prefix)
  string(REPLACE "/" "." prefix "${prefix}")
  set(${result} "${prefix}" PARENT_SCOPE)
endfunction()

#[[
palpate_add_test(<part>
  SOURCES <file>…
  DEPENDS <part or imported target>…
  [RANKS <n>…])

Makes the GoogleTest program palpate_test_<part>. It sees PALPATE_SHARED_DATA (may be empty) and
PALPATE_TEST_DATA (tests/data) as string macros, and includes headers relative to tests/. With
RANKS the program is run as a whole, once for each number of ranks (without MPI: test by test), and
SOURCES hold solvers/support/mpi_main.cpp, whose main() starts and ends MPI.
]]
function(palpate_add_test part)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;DEPENDS;RANKS")
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "palpate_add_test(${part}): unknown arguments ${arg_UNPARSED_ARGUMENTS}")
  endif()
  palpate_resolve_targets(depends ${arg_DEPENDS})
  palpate_test_prefix(prefix)

  set(target palpate_test_${part})
  add_executable(${target} ${arg_SOURCES})
  target_include_directories(${target} PRIVATE "${PROJECT_SOURCE_DIR}/tests")
  target_compile_definitions(${target} PRIVATE
    "PALPATE_SHARED_DATA=\"${PALPATE_SHARED_DATA}\""
    "PALPATE_TEST_DATA=\"${PROJECT_SOURCE_DIR}/tests/data\"")
  target_link_libraries(${target} PRIVATE ${depends} palpate_warnings)

  if(arg_RANKS AND PALPATE_WITH_MPI)
    target_link_libraries(${target} PRIVATE GTest::gtest MPI::MPI_C)
    target_compile_definitions(${target} PRIVATE PALPATE_WITH_MPI)
    foreach(ranks IN LISTS arg_RANKS)
      palpate_add_mpi_test("${prefix}.${ranks}_ranks" ${ranks} $<TARGET_FILE:${target}>)
    endforeach()
  else()
    target_link_libraries(${target} PRIVATE
      GTest::gtest $<$<NOT:$<BOOL:${arg_RANKS}>>:GTest::gtest_main>)
    gtest_discover_tests(${target}
      TEST_PREFIX "${prefix}."
      NO_PRETTY_VALUES
      DISCOVERY_TIMEOUT 60
      PROPERTIES TIMEOUT 300)
  endif()
endfunction()

#[[
palpate_add_pvpython_test(<name> <script.py> [ARGS <arg>…] [RANKS <n>] [SYMMETRIC]
                          [RENDERS | WINDOW])

Runs a script of the current folder with pvpython, or with RANKS under mpiexec with pvbatch. The
plugin is loaded when the script starts (PV_PLUGIN_PATH): `from paraview.simple import *` gives its
proxies. The script finds the reference data in the environment variable PALPATE_SHARED_DATA (may
be empty) and the sources' root in PALPATE_SOURCE_DIR. Its working folder is its own, and empty at
the start. Exit code 77 means skipped. With SYMMETRIC each rank runs the script. RENDERS gives it a
display; so does WINDOW, for a test that opens ParaView's window.
]]
function(palpate_add_pvpython_test name script)
  cmake_parse_arguments(PARSE_ARGV 2 arg "RENDERS;SYMMETRIC;WINDOW" "RANKS" "ARGS")
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR
      "palpate_add_pvpython_test(${name}): unknown arguments ${arg_UNPARSED_ARGUMENTS}")
  endif()
  palpate_test_prefix(prefix)
  set(test "${prefix}.${name}")

  set(launcher
    sh "${PROJECT_SOURCE_DIR}/cmake/in_empty_folder.sh" "${CMAKE_CURRENT_BINARY_DIR}/${name}")
  set(environment
    "PV_PLUGIN_PATH=${PALPATE_PLUGIN_BUILD_DIR}"
    "PALPATE_SHARED_DATA=${PALPATE_SHARED_DATA}"
    "PALPATE_SOURCE_DIR=${PROJECT_SOURCE_DIR}")
  set(locks "")
  set(cost 0)
  if(arg_RENDERS OR arg_WINDOW)
    list(APPEND launcher sh "${PROJECT_SOURCE_DIR}/cmake/in_display.sh")
    # The longest first: at the end one of them would leave the other cores idle.
    set(cost 100)
  endif()
  if(arg_WINDOW)
    # What happens in a window happens in time, and drawing takes a core: one after another.
    set(locks window)
  endif()
  if(arg_RANKS)
    list(APPEND launcher ${palpate_mpiexec} -n ${arg_RANKS} $<TARGET_FILE:ParaView::pvbatch>)
    if(arg_SYMMETRIC)
      list(APPEND launcher --symmetric)
    endif()
    # While one rank runs the script, the others ask again and again what to do: they let go first
    # who has something to do. Ranks that solve together all the time are faster without, and so is
    # a single one beside other programs: MUMPS would let these go first whenever it asks for mail.
    list(APPEND environment "OMPI_MCA_mpi_yield_when_idle=1")
  else()
    set(arg_RANKS 1)
    list(APPEND launcher $<TARGET_FILE:ParaView::pvpython>)
  endif()

  add_test(NAME "${test}"
    COMMAND ${launcher} "${CMAKE_CURRENT_SOURCE_DIR}/${script}" ${arg_ARGS})
  set_tests_properties("${test}" PROPERTIES
    PROCESSORS ${arg_RANKS}
    RESOURCE_LOCK "${locks}"
    COST ${cost}
    SKIP_RETURN_CODE 77
    TIMEOUT 600)
  set_property(TEST "${test}" PROPERTY ENVIRONMENT ${environment})
endfunction()

function(palpate_add_mpi_test test ranks)
  add_test(NAME "${test}" COMMAND ${palpate_mpiexec} -n ${ranks} ${ARGN})
  set_tests_properties("${test}" PROPERTIES PROCESSORS ${ranks} TIMEOUT 300)
endfunction()
