# SPDX-License-Identifier: BSD-3-Clause
# Finds hidapi over the kernel's hidraw: target HIDAPI::hidraw.
#
# The build over libusb is never taken: it detaches the kernel's driver from the device.

find_path(HIDAPI_INCLUDE_DIR hidapi/hidapi.h)
find_library(HIDAPI_LIBRARY hidapi-hidraw)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(HIDAPI REQUIRED_VARS HIDAPI_LIBRARY HIDAPI_INCLUDE_DIR)
mark_as_advanced(HIDAPI_INCLUDE_DIR HIDAPI_LIBRARY)

if(HIDAPI_FOUND AND NOT TARGET HIDAPI::hidraw)
  add_library(HIDAPI::hidraw UNKNOWN IMPORTED)
  set_target_properties(HIDAPI::hidraw PROPERTIES
    IMPORTED_LOCATION "${HIDAPI_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${HIDAPI_INCLUDE_DIR}")
endif()
