// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateTouchReducedModel
 * @brief the surface of a body where the coordinates of its reduced model are
 *
 * Input: a body with its reduced model (vtkPalpateReducedModel.h).
 *
 * Output: the surface of the body, displaced by u = (Φ, L) y (see reduced/reduced_model.h), with
 * the point array `Displacement` (m) and normals. With a second input, a surface of the same
 * organ, it is that surface, carried by the body, with its own arrays too. The whole of it is on
 * rank 0.
 *
 * Everything that does not change with the coordinates is kept from one update to the next.
 */
#pragma once

#include <memory>
#include <vector>

#include "PalpateTouchingModule.h"
#include "vtkPolyDataAlgorithm.h"

class vtkPalpateDisplaySurface;

class PALPATETOUCHING_EXPORT vtkPalpateTouchReducedModel : public vtkPolyDataAlgorithm
{
public:
  static vtkPalpateTouchReducedModel* New();
  vtkTypeMacro(vtkPalpateTouchReducedModel, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /// y: those of the modes, √J, then those of the tools, m. None: the body is at rest.
  void AddCoordinate(double coordinate);
  void ClearCoordinates();
  ///@}

protected:
  vtkPalpateTouchReducedModel();
  ~vtkPalpateTouchReducedModel() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkPalpateTouchReducedModel(const vtkPalpateTouchReducedModel&) = delete;
  void operator=(const vtkPalpateTouchReducedModel&) = delete;

  struct Prepared;

  void Show(vtkPolyData* output) const;

  std::vector<double> Coordinates;
  /// The parts that depend on the input alone; they are made anew when the input changes.
  std::unique_ptr<Prepared> Cache;
  std::unique_ptr<vtkPalpateDisplaySurface> Display;
};
