// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateCutPlane
 * @brief The plane sheet of a cut that ends inside a body.
 *
 * A rectangle that goes along CutDirection from outside the body to Origin, where the cut ends, for
 * Place Cut and Cut Now. Points of the output:
 *   `Front`  how far along the direction the point is, from where the rectangle begins, m
 *
 * @note Collective. Rank 0 has the whole output.
 */
#pragma once

#include "PalpateCuttingModule.h"
#include "vtkPolyDataAlgorithm.h"

class PALPATECUTTING_EXPORT vtkPalpateCutPlane : public vtkPolyDataAlgorithm
{
public:
  static vtkPalpateCutPlane* New();
  vtkTypeMacro(vtkPalpateCutPlane, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{ The middle of the line at which the cut ends, m.
  vtkSetVector3Macro(Origin, double);
  vtkGetVector3Macro(Origin, double);
  ///@}

  ///@{ The normal of the plane, of any length.
  vtkSetVector3Macro(Normal, double);
  vtkGetVector3Macro(Normal, double);
  ///@}

  ///@{
  /// The direction in which the cut grows, of which the part along the plane is taken; 0: from
  /// outside towards the middle of the body.
  vtkSetVector3Macro(CutDirection, double);
  vtkGetVector3Macro(CutDirection, double);
  ///@}

  ///@{ The width of the sheet across that direction, m; 0: as wide as the body.
  vtkSetMacro(Width, double);
  vtkGetMacro(Width, double);
  ///@}

protected:
  vtkPalpateCutPlane() = default;
  ~vtkPalpateCutPlane() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestData(
    vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;

private:
  vtkPalpateCutPlane(const vtkPalpateCutPlane&) = delete;
  void operator=(const vtkPalpateCutPlane&) = delete;

  double Origin[3] = { 0, 0, 0 };
  double Normal[3] = { 0, 0, 1 };
  double CutDirection[3] = { 0, 0, 0 };
  double Width = 0;
};
