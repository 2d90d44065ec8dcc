// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSMPalpateRenamedProperty.h"

#include "vtkClientServerInterpreter.h"
#include "vtkClientServerInterpreterInitializer.h"
#include "vtkObjectFactory.h"
#include "vtkPVXMLElement.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMProxy.h"

vtkStandardNewMacro(vtkSMPalpateRenamedProperty);

void vtkSMPalpateRenamedProperty::Modified()
{
  this->Superclass::Modified();
  vtkSMProxy* proxy = this->GetParent();
  if (proxy && this->GetNumberOfElements() > 0)
  {
    vtkSMPropertyHelper(proxy, this->NewName.c_str())
      .Set(this->GetElements(), this->GetNumberOfElements());
  }
}

int vtkSMPalpateRenamedProperty::ReadXMLAttributes(vtkSMProxy* parent, vtkPVXMLElement* element)
{
  this->NewName = element->GetAttributeOrEmpty("new_name");
  return this->Superclass::ReadXMLAttributes(parent, element);
}

void PalpateAddRenamedProperty()
{
  vtkClientServerInterpreterInitializer::GetGlobalInterpreter()->AddNewInstanceFunction(
    "vtkSMPalpateRenamedProperty",
    [](void*) -> vtkObjectBase* { return vtkSMPalpateRenamedProperty::New(); });
}
