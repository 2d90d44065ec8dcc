# SPDX-License-Identifier: BSD-3-Clause
# Finds the MPI build of MUMPS, double and single precision: target MUMPS::MUMPS.
#
# The sequential build (libdmumps_seq, libmpiseq) is never taken: libmpiseq exports MPI_Init and
# would shadow ParaView's.

find_package(MPI REQUIRED COMPONENTS C)

find_path(MUMPS_INCLUDE_DIR dmumps_c.h)
set(mumps_required MUMPS_INCLUDE_DIR)
foreach(library IN ITEMS dmumps smumps mumps_common pord)
  find_library(MUMPS_${library}_LIBRARY ${library})
  list(APPEND mumps_required MUMPS_${library}_LIBRARY)
endforeach()

if(MUMPS_INCLUDE_DIR AND EXISTS "${MUMPS_INCLUDE_DIR}/dmumps_c.h")
  file(STRINGS "${MUMPS_INCLUDE_DIR}/dmumps_c.h" version_line REGEX "define MUMPS_VERSION ")
  string(REGEX REPLACE ".*\"([0-9.]+)\".*" "\\1" MUMPS_VERSION "${version_line}")
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(MUMPS
  REQUIRED_VARS ${mumps_required}
  VERSION_VAR MUMPS_VERSION)
mark_as_advanced(${mumps_required})

if(MUMPS_FOUND AND NOT TARGET MUMPS::MUMPS)
  add_library(MUMPS::MUMPS UNKNOWN IMPORTED)
  set_target_properties(MUMPS::MUMPS PROPERTIES
    IMPORTED_LOCATION "${MUMPS_dmumps_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${MUMPS_INCLUDE_DIR}")
  target_link_libraries(MUMPS::MUMPS INTERFACE
    "${MUMPS_smumps_LIBRARY}" "${MUMPS_mumps_common_LIBRARY}" "${MUMPS_pord_LIBRARY}" MPI::MPI_C)
endif()
