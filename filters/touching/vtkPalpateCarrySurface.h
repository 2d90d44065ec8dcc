// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateCarrySurface
 * @brief a fine surface of an organ that follows its body
 *
 * Inputs: a body with the point array `Displacement` (m), whose points are where it was meshed, as
 * the filters that solve for it give it; the surface. Output: the surface as the body carries it
 * (mesh/surface_embedding.h), with `Displacement` and `Normals`, its own arrays, and the point
 * arrays of the body, interpolated. Under MPI the result is whole on rank 0 and empty elsewhere.
 *
 * How the surface lies on the body is kept from one execution to the next.
 */
#pragma once

#include <memory>

#include "PalpateTouchingModule.h"
#include "vtkPolyDataAlgorithm.h"

class PALPATETOUCHING_EXPORT vtkPalpateCarrySurface : public vtkPolyDataAlgorithm
{
public:
  static vtkPalpateCarrySurface* New();
  vtkTypeMacro(vtkPalpateCarrySurface, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

protected:
  vtkPalpateCarrySurface();
  ~vtkPalpateCarrySurface() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkPalpateCarrySurface(const vtkPalpateCarrySurface&) = delete;
  void operator=(const vtkPalpateCarrySurface&) = delete;

  struct Prepared;
  std::unique_ptr<Prepared> Cache;
};
