// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateTiltedMotion
 * @brief a tool that is turned about z by an angle that stays, and moved as it is
 */
#pragma once

#include "PalpateNewToolsModule.h"
#include "vtkPalpateMotion.h"

class PALPATENEWTOOLS_EXPORT vtkPalpateTiltedMotion : public vtkPalpateMotion {
 public:
  static vtkPalpateTiltedMotion* New();
  vtkTypeMacro(vtkPalpateTiltedMotion, vtkPalpateMotion);

  ///@{
  /// Degrees.
  vtkSetMacro(Angle, double);
  vtkGetMacro(Angle, double);
  ///@}

  void Describe(palpate::RigidTool& tool) const override;

 protected:
  vtkPalpateTiltedMotion() = default;
  ~vtkPalpateTiltedMotion() override = default;

 private:
  vtkPalpateTiltedMotion(const vtkPalpateTiltedMotion&) = delete;
  void operator=(const vtkPalpateTiltedMotion&) = delete;

  double Angle = 0;
};
