// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateSetBoundary
 * @brief says where a body is held and where it may be touched
 *
 * Adds the point arrays `Fixed` and `Touchable` (1 or 0) to the body. Fixed are the points that are
 * chosen, midside nodes too. Touchable are those of the chosen points that are corners on the
 * surface and not fixed.
 *
 * Of a body in several pieces it tells which of them touch without sharing points, so that nothing
 * joins them. Those points are merged where that is asked for; then the field array `MergedPoints`
 * says how many were taken away, and points have other ids than in the input.
 *
 * Input ports 1 and 2 are the selections of fixed and of touchable points, both optional. Of
 * selected cells all points are chosen.
 */
#pragma once

#include <string>
#include <vector>

#include "PalpateFiltersModule.h"
#include "vtkSmartPointer.h"
#include "vtkUnstructuredGridAlgorithm.h"

class vtkImplicitFunction;
class vtkSelection;

class PALPATEFILTERS_EXPORT vtkPalpateSetBoundary : public vtkUnstructuredGridAlgorithm
{
public:
  static vtkPalpateSetBoundary* New();
  vtkTypeMacro(vtkPalpateSetBoundary, vtkUnstructuredGridAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// What chooses the points.
  enum Chooser
  {
    REGION = 0,    ///< where an implicit function is not positive
    ARRAY = 1,     ///< where a point array is not 0
    SELECTION = 2, ///< a selection
    SURFACE = 3    ///< the whole surface; touchable points alone
  };

  ///@{
  /// A Chooser.
  vtkSetMacro(FixedBy, int);
  vtkGetMacro(FixedBy, int);
  vtkSetMacro(TouchableBy, int);
  vtkGetMacro(TouchableBy, int);
  ///@}
  ///@{
  /// The points where the function is not positive: those within a box, sphere or cylinder, those
  /// on the side of a plane that its normal points away from.
  void SetFixedRegion(vtkImplicitFunction* region);
  void SetTouchableRegion(vtkImplicitFunction* region);
  ///@}
  ///@{
  /// Name of a point array with one component; "None" or empty for none.
  vtkSetStdStringFromCharMacro(FixedArray);
  vtkGetCharFromStdStringMacro(FixedArray);
  vtkSetStdStringFromCharMacro(TouchableArray);
  vtkGetCharFromStdStringMacro(TouchableArray);
  ///@}
  ///@{
  /// Whether points of different pieces of the body that coincide become one.
  vtkSetMacro(Merge, bool);
  vtkGetMacro(Merge, bool);
  vtkBooleanMacro(Merge, bool);
  ///@}
  ///@{
  /// A vtkSelection of points or cells of the body.
  void SetFixedSelectionConnection(vtkAlgorithmOutput* selection);
  void SetTouchableSelectionConnection(vtkAlgorithmOutput* selection);
  ///@}

  vtkMTimeType GetMTime() override;

protected:
  vtkPalpateSetBoundary();
  ~vtkPalpateSetBoundary() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkPalpateSetBoundary(const vtkPalpateSetBoundary&) = delete;
  void operator=(const vtkPalpateSetBoundary&) = delete;

  int FixedBy = REGION;
  int TouchableBy = SURFACE;
  vtkSmartPointer<vtkImplicitFunction> FixedRegion;
  vtkSmartPointer<vtkImplicitFunction> TouchableRegion;
  std::string FixedArray = "None";
  std::string TouchableArray = "None";
  bool Merge = false;
};
