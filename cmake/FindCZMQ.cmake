# SPDX-License-Identifier: BSD-3-Clause
# Finds CZMQ, ZeroMQ's binding for C: target CZMQ::czmq.

find_path(CZMQ_INCLUDE_DIR czmq.h)
find_library(CZMQ_LIBRARY czmq)
find_library(CZMQ_ZMQ_LIBRARY zmq)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(CZMQ
  REQUIRED_VARS CZMQ_LIBRARY CZMQ_ZMQ_LIBRARY CZMQ_INCLUDE_DIR)
mark_as_advanced(CZMQ_INCLUDE_DIR CZMQ_LIBRARY CZMQ_ZMQ_LIBRARY)

if(CZMQ_FOUND AND NOT TARGET CZMQ::czmq)
  add_library(CZMQ::czmq UNKNOWN IMPORTED)
  set_target_properties(CZMQ::czmq PROPERTIES
    IMPORTED_LOCATION "${CZMQ_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${CZMQ_INCLUDE_DIR}"
    INTERFACE_LINK_LIBRARIES "${CZMQ_ZMQ_LIBRARY}")
endif()
