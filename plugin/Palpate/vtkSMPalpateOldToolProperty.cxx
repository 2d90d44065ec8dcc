// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSMPalpateOldToolProperty.h"

#include "vtkCommand.h"
#include "vtkObjectFactory.h"
#include "vtkPVXMLElement.h"
#include "vtkSMPalpateToolProperty.h"
#include "vtkSMProxy.h"

vtkStandardNewMacro(vtkSMPalpateOldToolProperty);

namespace
{
vtkSMPalpateToolProperty* ToolOf(vtkSMProxy* filter)
{
  return filter ? vtkSMPalpateToolProperty::SafeDownCast(filter->GetProperty("Tool")) : nullptr;
}

vtkSMDoubleVectorProperty* NumbersOf(vtkSMProxy* tool, const std::string& name)
{
  return tool ? vtkSMDoubleVectorProperty::SafeDownCast(tool->GetProperty(name.c_str())) : nullptr;
}
}

vtkSMPalpateOldToolProperty::~vtkSMPalpateOldToolProperty()
{
  if (this->Followed)
  {
    this->Followed->RemoveObserver(this->Observer);
  }
}

std::vector<vtkSMDoubleVectorProperty*> vtkSMPalpateOldToolProperty::OfTools()
{
  std::vector<vtkSMDoubleVectorProperty*> all;
  if (vtkSMPalpateToolProperty* property = ToolOf(this->GetParent()))
  {
    for (vtkSMProxy* tool : property->Tools())
    {
      if (vtkSMDoubleVectorProperty* numbers = NumbersOf(tool, this->NewName))
      {
        all.push_back(numbers);
      }
    }
  }
  return all;
}

void vtkSMPalpateOldToolProperty::Follow()
{
  vtkSMPalpateToolProperty* property = ToolOf(this->GetParent());
  const std::vector<vtkSMDoubleVectorProperty*> all = this->OfTools();
  vtkSMDoubleVectorProperty* chosen = property && property->GetNumberOfProxies() > 0
    ? NumbersOf(property->GetProxy(0), this->NewName)
    : nullptr;
  vtkSMDoubleVectorProperty* followed = chosen || all.empty() ? chosen : all.front();
  if (followed && followed != this->Followed)
  {
    if (this->Followed)
    {
      this->Followed->RemoveObserver(this->Observer);
    }
    this->Followed = followed;
    this->Observer =
      followed->AddObserver(vtkCommand::ModifiedEvent, this, &vtkSMPalpateOldToolProperty::Read);
  }
  this->Read();
}

void vtkSMPalpateOldToolProperty::Read()
{
  if (auto* followed = vtkSMDoubleVectorProperty::SafeDownCast(this->Followed))
  {
    this->IsReading = true;
    this->SetElements(followed->GetElements(), followed->GetNumberOfElements());
    this->IsReading = false;
  }
}

void vtkSMPalpateOldToolProperty::Modified()
{
  if (this->IsReading)
  {
    return;
  }
  this->Superclass::Modified();
  vtkSMPalpateToolProperty* property = ToolOf(this->GetParent());
  if (!property || this->GetParent()->IsPrototype())
  {
    return;
  }
  property->MakeTools();
  for (vtkSMDoubleVectorProperty* numbers : this->OfTools())
  {
    numbers->SetElements(this->GetElements(), this->GetNumberOfElements());
    numbers->GetParent()->UpdateVTKObjects();
  }
}

void vtkSMPalpateOldToolProperty::ResetToXMLDefaults()
{
  for (vtkSMDoubleVectorProperty* numbers : this->OfTools())
  {
    numbers->ResetToXMLDefaults();
    numbers->GetParent()->UpdateVTKObjects();
  }
}

int vtkSMPalpateOldToolProperty::ReadXMLAttributes(vtkSMProxy* parent, vtkPVXMLElement* element)
{
  // Until it is made it sets nothing.
  this->IsReading = true;
  const int isRead = this->Superclass::ReadXMLAttributes(parent, element);
  this->IsReading = false;
  this->NewName = element->GetAttributeOrEmpty("new_name");
  return isRead;
}
