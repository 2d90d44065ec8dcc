// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateTranslatedMotion.h"

#include "interaction/rigid_tool.h"
#include "vtkObjectFactory.h"

vtkStandardNewMacro(vtkPalpateTranslatedMotion);

void vtkPalpateTranslatedMotion::Describe(palpate::RigidTool& tool) const
{
  tool.motion = palpate::ToolMotion::translated;
}
