// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateSurfaceTool
 * @brief a tool of the shape of a closed surface, about the middle of its bounds
 */
#pragma once

#include "PalpateToolModule.h"
#include "vtkPalpateTool.h"

class PALPATETOOL_EXPORT vtkPalpateSurfaceTool : public vtkPalpateTool
{
public:
  static vtkPalpateSurfaceTool* New();
  vtkTypeMacro(vtkPalpateSurfaceTool, vtkPalpateTool);

  bool HasShapeOfSurface() const override { return true; }

protected:
  vtkPalpateSurfaceTool() = default;
  ~vtkPalpateSurfaceTool() override = default;

  void DescribeShape(vtkPolyData* surface, palpate::RigidTool& tool) const override;

private:
  vtkPalpateSurfaceTool(const vtkPalpateSurfaceTool&) = delete;
  void operator=(const vtkPalpateSurfaceTool&) = delete;
};
