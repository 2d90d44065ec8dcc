// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateMotion
 * @brief how the coordinates of a rigid tool place and turn it
 *
 * A subclass has the properties of one kind of motion. A palpate::MotionKind gives a meaning to the
 * numbers in which they are stored.
 */
#pragma once

#include "PalpateToolModule.h"
#include "vtkObject.h"

namespace palpate
{
struct RigidTool;
}

class PALPATETOOL_EXPORT vtkPalpateMotion : public vtkObject
{
public:
  vtkTypeMacro(vtkPalpateMotion, vtkObject);

  /// Gives the tool this motion.
  virtual void Describe(palpate::RigidTool& tool) const = 0;

protected:
  vtkPalpateMotion();
  ~vtkPalpateMotion() override;

private:
  vtkPalpateMotion(const vtkPalpateMotion&) = delete;
  void operator=(const vtkPalpateMotion&) = delete;
};
