// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateCutNow
 * @brief cuts a body along a sheet, at once, where nobody has foreseen a cut
 *
 * As vtkPalpatePlaceCut, but the whole sheet opens, and it may lie on the body as that is deformed
 * now: with the point array `Displacement`, as Solve Equilibrium and Touch State Space give it, the
 * sheet is drawn back to the body at rest first. What is open of earlier cuts stays open.
 *
 * Output ports as those of vtkPalpatePlaceCut; `Stage` is 1.
 *
 * @note Collective. The pieces of all ranks are gathered, and rank 0 has the whole output.
 */
#pragma once

#include "PalpateCuttingModule.h"
#include "vtkPalpatePlaceCut.h"

class PALPATECUTTING_EXPORT vtkPalpateCutNow : public vtkPalpatePlaceCut
{
public:
  static vtkPalpateCutNow* New();
  vtkTypeMacro(vtkPalpateCutNow, vtkPalpatePlaceCut);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /// Whether the sheet lies on the body as it is deformed, if it is, and not on the body at rest.
  vtkSetMacro(OnDeformedBody, bool);
  vtkGetMacro(OnDeformedBody, bool);
  vtkBooleanMacro(OnDeformedBody, bool);
  ///@}

protected:
  vtkPalpateCutNow();
  ~vtkPalpateCutNow() override;

  palpate::SheetMesh PutSheet(vtkUnstructuredGrid* body, const palpate::TetMesh& cells,
    vtkPolyData* sheet, int& stage) override;

private:
  vtkPalpateCutNow(const vtkPalpateCutNow&) = delete;
  void operator=(const vtkPalpateCutNow&) = delete;

  bool OnDeformedBody = true;
};
