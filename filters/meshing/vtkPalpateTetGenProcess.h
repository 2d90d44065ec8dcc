// SPDX-License-Identifier: BSD-3-Clause
// Runs palpate-tetgen (filters/programs/tetgen/main.cxx), a process of its own, so that a crash or
// hang of TetGen does no harm.
#pragma once

#include <chrono>
#include <functional>
#include <string>

#include "PalpateMeshingModule.h"
#include "base/error.h"
#include "vtkSmartPointer.h"

class vtkImageData;
class vtkPolyData;
class vtkUnstructuredGrid;

struct vtkPalpateTetGenOptions
{
  double MaximumRadiusEdgeRatio = 1.414; ///< of circumscribed radius to shortest edge, ≥ 1
  double MaximumVolume = 0;              ///< of a tetrahedron, m³; 0 = none
  bool PreserveSurface = false;          ///< no new points on the surface
  vtkImageData* Region = nullptr;        ///< point array `Region`, ≤ 0 where RegionVolume holds
  double RegionVolume = 0;               ///< of a tetrahedron there, m³; 0 = as elsewhere
};

/// The limits that end a run early.
struct vtkPalpateTetGenLimits
{
  std::chrono::steady_clock::time_point Deadline = std::chrono::steady_clock::time_point::max();
  /// Called many times a second while the program runs. An exception ends the program and is passed
  /// on. May be empty.
  std::function<void()> Poll;

  vtkPalpateTetGenLimits() = default;
  /// Limits that count from now.
  /// @param timeOut The time that the run may take, s; 0: there is no limit.
  /// @param progress Called with a guess of the finished share, from 0 to 1, since nobody knows how
  ///   long TetGen takes. An exception ends the program.
  PALPATEMESHING_EXPORT vtkPalpateTetGenLimits(
    double timeOut, const std::function<void(double)>& progress);
};

/// TetGen itself gave up or crashed: it may succeed with another surface.
class vtkPalpateTetGenFailure : public palpate::BackendError
{
public:
  using BackendError::BackendError;
};

/// Runs TetGen. For input and result see filters/programs/tetgen/main.cxx.
/// @throws vtkPalpateTetGenFailure with the last lines of TetGen's output.
/// @throws palpate::BackendError the program cannot be run, gives no mesh or exceeds the deadline.
PALPATEMESHING_EXPORT vtkSmartPointer<vtkUnstructuredGrid> vtkPalpateRunTetGen(vtkPolyData* surface,
  const vtkPalpateTetGenOptions& options, const vtkPalpateTetGenLimits& limits);
