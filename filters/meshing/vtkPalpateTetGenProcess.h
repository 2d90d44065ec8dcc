// SPDX-License-Identifier: BSD-3-Clause
// Runs palpate-tetgen (filters/tetgen/main.cxx), where a crash or hang of TetGen harms nobody.
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

/// What ends a run early.
struct vtkPalpateTetGenLimits
{
  std::chrono::steady_clock::time_point Deadline = std::chrono::steady_clock::time_point::max();
  /// Called many times a second while the program runs. What it throws ends the program and is
  /// passed on. May be empty.
  std::function<void()> Poll;

  vtkPalpateTetGenLimits() = default;
  /// From now on.
  /// @param timeOut s; 0: none. @param progress Is told how far it may be, from 0 to 1: nobody
  /// knows how long TetGen takes. What it throws ends the program.
  PALPATEMESHING_EXPORT vtkPalpateTetGenLimits(
    double timeOut, const std::function<void(double)>& progress);
};

/// TetGen itself gave up or crashed: another surface may fare better.
class vtkPalpateTetGenFailure : public palpate::BackendError
{
public:
  using BackendError::BackendError;
};

/// Input and result: see filters/tetgen/main.cxx.
/// @throws vtkPalpateTetGenFailure with TetGen's last words.
/// @throws palpate::BackendError where the program cannot be run, gives no mesh or exceeds the
/// deadline.
PALPATEMESHING_EXPORT vtkSmartPointer<vtkUnstructuredGrid> vtkPalpateRunTetGen(vtkPolyData* surface,
  const vtkPalpateTetGenOptions& options, const vtkPalpateTetGenLimits& limits);
