// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateTranslatedMotion
 * @brief a tool that does not turn, and whose coordinates are the place of its centre
 */
#pragma once

#include "PalpateToolModule.h"
#include "vtkPalpateMotion.h"

class PALPATETOOL_EXPORT vtkPalpateTranslatedMotion : public vtkPalpateMotion
{
public:
  static vtkPalpateTranslatedMotion* New();
  vtkTypeMacro(vtkPalpateTranslatedMotion, vtkPalpateMotion);

  void Describe(palpate::RigidTool& tool) const override;

protected:
  vtkPalpateTranslatedMotion() = default;
  ~vtkPalpateTranslatedMotion() override = default;

private:
  vtkPalpateTranslatedMotion(const vtkPalpateTranslatedMotion&) = delete;
  void operator=(const vtkPalpateTranslatedMotion&) = delete;
};
