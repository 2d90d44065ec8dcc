# SPDX-License-Identifier: BSD-3-Clause
# The parts of ITK that read NRRD, MetaImage and NIfTI, as the target ITK::ImageIO. ITK_DIR: the
# folder of ITKTargets.cmake.
#
# ITKConfig.cmake is left alone: it looks for all that any part of ITK needs, GDCM and HDF5 among
# it, and what it finds changes what ParaView's own files find. These parts need none of that but
# Eigen.

if(NOT ITK_DIR)
  file(GLOB folders
    "/usr/lib/cmake/ITK-5*" "/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/ITK-5*"
    "/usr/local/lib/cmake/ITK-5*")
endif()
find_path(ITK_DIR ITKTargets.cmake PATHS ${folders} NO_DEFAULT_PATH)
cmake_path(GET ITK_DIR FILENAME name)
find_path(ITK_INCLUDE_DIR itkNrrdImageIO.h
  HINTS "${ITK_DIR}/../../.." "${ITK_DIR}/../../../.."
  PATH_SUFFIXES "include/${name}")
mark_as_advanced(ITK_DIR ITK_INCLUDE_DIR)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(ITKImageIO REQUIRED_VARS ITK_DIR ITK_INCLUDE_DIR)

if(ITKImageIO_FOUND AND NOT TARGET ITK::ImageIO)
  include("${ITK_DIR}/ITKTargets.cmake")
  if(NOT TARGET ITKInternalEigen3::Eigen)
    add_library(ITKInternalEigen3::Eigen ALIAS Eigen3::Eigen)
  endif()
  add_library(ITK::ImageIO INTERFACE IMPORTED)
  target_include_directories(ITK::ImageIO SYSTEM INTERFACE "${ITK_INCLUDE_DIR}")
  target_link_libraries(ITK::ImageIO INTERFACE ITKIONRRD ITKNrrdIO ITKIOMeta ITKIONIFTI)
endif()
