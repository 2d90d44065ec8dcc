// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateTrocarMotion
 * @brief a tool that goes through a trocar, about which it pivots, and whose coordinates are the
 * place of its tip
 *
 * The tip of a capsule is the centre of the end at which its axis begins, and that of a sphere its
 * centre. That of a surface is where its axis leaves it, on the side at which it begins.
 */
#pragma once

#include "PalpateToolModule.h"
#include "vtkPalpateMotion.h"

class PALPATETOOL_EXPORT vtkPalpateTrocarMotion : public vtkPalpateMotion
{
public:
  static vtkPalpateTrocarMotion* New();
  vtkTypeMacro(vtkPalpateTrocarMotion, vtkPalpateMotion);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{ The point through which the tool goes, m.
  vtkSetVector3Macro(TrocarPoint, double);
  vtkGetVector3Macro(TrocarPoint, double);
  ///@}
  ///@{
  /// The axis of the instrument from its tip towards the handle, in its own axes; 0: that of a
  /// capsule, and the longest side of the box around a surface.
  vtkSetVector3Macro(InstrumentAxis, double);
  vtkGetVector3Macro(InstrumentAxis, double);
  ///@}
  ///@{
  /// The largest angle to the way from what may be touched to the trocar, degrees, 0 … 90.
  vtkSetMacro(MaximumTilt, double);
  vtkGetMacro(MaximumTilt, double);
  ///@}
  ///@{ The largest distance of the tip from the trocar, m; 0: any.
  vtkSetMacro(MaximumDepth, double);
  vtkGetMacro(MaximumDepth, double);
  ///@}

  void Describe(palpate::RigidTool& tool) const override;

protected:
  vtkPalpateTrocarMotion() = default;
  ~vtkPalpateTrocarMotion() override = default;

private:
  vtkPalpateTrocarMotion(const vtkPalpateTrocarMotion&) = delete;
  void operator=(const vtkPalpateTrocarMotion&) = delete;

  double TrocarPoint[3] = { 0, 0, 0 };
  double InstrumentAxis[3] = { 0, 0, 0 };
  double MaximumTilt = 90;
  double MaximumDepth = 0;
};
