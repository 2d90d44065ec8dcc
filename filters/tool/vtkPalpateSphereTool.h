// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateSphereTool
 * @brief a ball
 */
#pragma once

#include "PalpateToolModule.h"
#include "vtkPalpateTool.h"

class PALPATETOOL_EXPORT vtkPalpateSphereTool : public vtkPalpateTool
{
public:
  static vtkPalpateSphereTool* New();
  vtkTypeMacro(vtkPalpateSphereTool, vtkPalpateTool);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /// The radius, m; more than 0.
  vtkSetMacro(Radius, double);
  vtkGetMacro(Radius, double);
  ///@}

protected:
  vtkPalpateSphereTool() = default;
  ~vtkPalpateSphereTool() override = default;

  void DescribeShape(vtkPolyData* surface, palpate::RigidTool& tool) const override;

private:
  vtkPalpateSphereTool(const vtkPalpateSphereTool&) = delete;
  void operator=(const vtkPalpateSphereTool&) = delete;

  double Radius = 0.01;
};
