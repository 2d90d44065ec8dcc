// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateRingTool
 * @brief a torus
 */
#pragma once

#include "PalpateNewToolsModule.h"
#include "vtkPalpateTool.h"

class PALPATENEWTOOLS_EXPORT vtkPalpateRingTool : public vtkPalpateTool {
 public:
  static vtkPalpateRingTool* New();
  vtkTypeMacro(vtkPalpateRingTool, vtkPalpateTool);

  ///@{
  /// Of the tube, m.
  vtkSetMacro(Radius, double);
  vtkGetMacro(Radius, double);
  ///@}
  ///@{
  /// Across the ring.
  vtkSetVector3Macro(Axis, double);
  vtkGetVector3Macro(Axis, double);
  ///@}
  ///@{
  /// Of the circle in the middle of the tube, m; 0 makes a sphere.
  vtkSetMacro(RingRadius, double);
  vtkGetMacro(RingRadius, double);
  ///@}

 protected:
  vtkPalpateRingTool() = default;
  ~vtkPalpateRingTool() override = default;

  void DescribeShape(vtkPolyData* surface, palpate::RigidTool& tool) const override;

 private:
  vtkPalpateRingTool(const vtkPalpateRingTool&) = delete;
  void operator=(const vtkPalpateRingTool&) = delete;

  double Radius = 0.01;
  double Axis[3] = {0, 0, 1};
  double RingRadius = 0.02;
};
