# SPDX-License-Identifier: BSD-3-Clause
# Finds ParaView, and Qt in the version that its window has.

# Debian 13 renames the Python modules of ParaView, but not where paraview-dev tells CMake of them,
# which stops at a file that is missing. The plugins need none of them, so their files are not
# looked for: CMake leaves out targets that have a folder in such a variable, as Apple's
# XCFrameworks do.
set(paraview_folders "${ParaView_DIR}")
if(NOT ParaView_DIR)
  file(GLOB paraview_folders "/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/paraview-*")
endif()
foreach(folder IN LISTS paraview_folders)
  file(GLOB exports "${folder}/*Python*-targets-*.cmake" "${folder}/vtk/*Python*-targets-*.cmake")
  foreach(export IN LISTS exports)
    file(STRINGS "${export}" modules REGEX "_cmake_import_check_targets ")
    foreach(module IN LISTS modules)
      string(REGEX REPLACE ".*_targets ([^ ]+) .*" "\\1" module "${module}")
      set("_cmake_import_check_xcframework_for_${module}" "${folder}")
    endforeach()
  endforeach()
endforeach()
# Its functions are given empty arguments by its own code, which recent releases of CMake point out.
set(CMAKE_POLICY_DEFAULT_CMP0174 OLD)

# Behind VTK's reader of tables; its own file does not look for it when only these components are
# asked for.
find_package(Freetype REQUIRED)
# Only what a server-side plugin needs: the whole of ParaView would ask for the development packages
# of GDAL, FFmpeg and more. The targets of its window are there all the same; they need Qt's
# widgets, and its component pqCore would ask for Qt's help system too.
find_package(ParaView 5.11 REQUIRED
  COMPONENTS RemotingCore VTKExtensionsExtraction VTKExtensionsIOCore)
# From Debian 13 on VTK looks for what lies behind a module only when that module is asked for, and
# ParaView does not ask for these that it links. Its development package brings them all.
if(ParaView_VERSION VERSION_GREATER_EQUAL 5.13)
  find_package(VTK REQUIRED COMPONENTS hdf5 jsoncpp netcdf)
endif()
if(PALPATE_WITH_INTERACTOR)
  find_package(X11 REQUIRED)
  find_package(Qt${VTK_QT_VERSION} REQUIRED COMPONENTS Widgets)
  if(VTK_QT_VERSION GREATER 5)
    find_package(Qt6 REQUIRED COMPONENTS OpenGLWidgets)  # Qt 5 has it in Widgets.
  endif()
endif()
if(PALPATE_WITH_MPI AND NOT PARAVIEW_USE_MPI)
  message(FATAL_ERROR "This ParaView is built without MPI: turn PALPATE_WITH_MPI off.")
endif()

# Where the plugin lies, in the build tree and in the installation. The library of the filters and
# the programs that they start lie beside it.
set(PALPATE_PLUGIN_DIR "${CMAKE_INSTALL_LIBDIR}/${PARAVIEW_PLUGIN_SUBDIR}/Palpate")
# The same with its full path, for the tests.
set(PALPATE_PLUGIN_BUILD_DIR "${PROJECT_BINARY_DIR}/${PALPATE_PLUGIN_DIR}")
