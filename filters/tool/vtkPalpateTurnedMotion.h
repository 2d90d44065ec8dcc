// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateTurnedMotion
 * @brief a tool that is turned freely about its reference point, whose place its coordinates are
 */
#pragma once

#include "PalpateToolModule.h"
#include "vtkPalpateMotion.h"

class PALPATETOOL_EXPORT vtkPalpateTurnedMotion : public vtkPalpateMotion
{
public:
  static vtkPalpateTurnedMotion* New();
  vtkTypeMacro(vtkPalpateTurnedMotion, vtkPalpateMotion);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /// The axis of the instrument from its tip towards the handle, in its own axes; 0: that of a
  /// capsule, and the longest side of the box around a surface.
  vtkSetVector3Macro(InstrumentAxis, double);
  vtkGetVector3Macro(InstrumentAxis, double);
  ///@}
  ///@{ How far from the tip the reference point is on the axis, m.
  vtkSetMacro(ReferenceDistance, double);
  vtkGetMacro(ReferenceDistance, double);
  ///@}
  ///@{
  /// Whether a surface is round about the axis, so that the tool need not be turned about it. A
  /// sphere and a capsule are.
  vtkSetMacro(Axisymmetric, bool);
  vtkGetMacro(Axisymmetric, bool);
  ///@}
  ///@{
  /// The orientation from which turns are counted: a quaternion w, x, y, z that turns the tool's
  /// own axes to those of the scene.
  vtkSetVector4Macro(MiddleOrientation, double);
  vtkGetVector4Macro(MiddleOrientation, double);
  ///@}
  ///@{ The largest angle by which the tool is turned from there, degrees, below 180.
  vtkSetMacro(MaximumTurn, double);
  vtkGetMacro(MaximumTurn, double);
  ///@}

  void Describe(palpate::RigidTool& tool) const override;

protected:
  vtkPalpateTurnedMotion() = default;
  ~vtkPalpateTurnedMotion() override = default;

private:
  vtkPalpateTurnedMotion(const vtkPalpateTurnedMotion&) = delete;
  void operator=(const vtkPalpateTurnedMotion&) = delete;

  double InstrumentAxis[3] = { 0, 0, 0 };
  double ReferenceDistance = 0;
  bool Axisymmetric = false;
  double MiddleOrientation[4] = { 1, 0, 0, 0 };
  double MaximumTurn = 90;
};
