// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateCapsuleTool
 * @brief a rod with round ends
 */
#pragma once

#include "PalpateToolModule.h"
#include "vtkPalpateTool.h"

class PALPATETOOL_EXPORT vtkPalpateCapsuleTool : public vtkPalpateTool
{
public:
  static vtkPalpateCapsuleTool* New();
  vtkTypeMacro(vtkPalpateCapsuleTool, vtkPalpateTool);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /// The radius of the rod and its ends, m; more than 0.
  vtkSetMacro(Radius, double);
  vtkGetMacro(Radius, double);
  ///@}
  ///@{
  /// The direction of the rod, a vector of any length but 0.
  vtkSetVector3Macro(Axis, double);
  vtkGetVector3Macro(Axis, double);
  ///@}
  ///@{
  /// The length of the straight part, m.
  vtkSetMacro(Length, double);
  vtkGetMacro(Length, double);
  ///@}

protected:
  vtkPalpateCapsuleTool() = default;
  ~vtkPalpateCapsuleTool() override = default;

  void DescribeShape(vtkPolyData* surface, palpate::RigidTool& tool) const override;

private:
  vtkPalpateCapsuleTool(const vtkPalpateCapsuleTool&) = delete;
  void operator=(const vtkPalpateCapsuleTool&) = delete;

  double Radius = 0.01;
  double Axis[3] = { 1, 0, 0 };
  double Length = 0.03;
};
