// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSMPalpateToolProperty.h"

#include <array>

#include "vtkClientServerInterpreter.h"
#include "vtkClientServerInterpreterInitializer.h"
#include "vtkObjectFactory.h"
#include "vtkPVXMLElement.h"
#include "vtkSMPalpateOldToolProperty.h"
#include "vtkSMParaViewPipelineController.h"
#include "vtkSMPropertyIterator.h"
#include "vtkSMProxy.h"
#include "vtkSMProxyListDomain.h"
#include "vtkSMSessionProxyManager.h"
#include "vtkSmartPointer.h"

vtkStandardNewMacro(vtkSMPalpateToolProperty);

namespace
{
/// The tools by their numbers in states of earlier versions; 0 is none.
constexpr std::array<const char*, 4> OldNumbers = { "", "Sphere", "Capsule", "Surface" };
}

void vtkSMPalpateToolProperty::MakeTools()
{
  auto* domain = this->FindDomain<vtkSMProxyListDomain>();
  if (domain->GetNumberOfProxies() > 0)
  {
    return;
  }
  vtkSMSessionProxyManager* manager = this->GetParent()->GetSessionProxyManager();
  domain->CreateProxies(manager);
  vtkNew<vtkSMParaViewPipelineController> controller;
  const std::string group =
    vtkSMParaViewPipelineController::GetHelperProxyGroupName(this->GetParent());
  for (unsigned int i = 0; i < domain->GetNumberOfProxies(); ++i)
  {
    // A state that is saved has those that have a name.
    controller->InitializeProxy(domain->GetProxy(i));
    manager->RegisterProxy(group.c_str(), this->GetXMLName(), domain->GetProxy(i));
  }
}

std::vector<vtkSMProxy*> vtkSMPalpateToolProperty::Tools()
{
  auto* domain = this->FindDomain<vtkSMProxyListDomain>();
  std::vector<vtkSMProxy*> tools;
  // While the property is made it has no list yet.
  for (unsigned int i = 0; domain && i < domain->GetNumberOfProxies(); ++i)
  {
    tools.push_back(domain->GetProxy(i));
  }
  return tools;
}

void vtkSMPalpateToolProperty::Modified()
{
  this->Superclass::Modified();
  if (!this->GetParent())
  {
    return;
  }
  const auto iterator =
    vtkSmartPointer<vtkSMPropertyIterator>::Take(this->GetParent()->NewPropertyIterator());
  for (iterator->Begin(); !iterator->IsAtEnd(); iterator->Next())
  {
    if (auto* old = vtkSMPalpateOldToolProperty::SafeDownCast(iterator->GetProperty()))
    {
      old->Follow();
    }
  }
}

int vtkSMPalpateToolProperty::LoadState(vtkPVXMLElement* element, vtkSMProxyLocator* loader)
{
  vtkPVXMLElement* old = element->FindNestedElementByName("Element");
  int number = 0;
  if (!old || !old->GetScalarAttribute("value", &number))
  {
    return this->Superclass::LoadState(element, loader);
  }
  this->MakeTools();
  const std::vector<vtkSMProxy*> tools = this->Tools();
  if (number < 0 || number >= static_cast<int>(OldNumbers.size()) || tools.empty())
  {
    return 0;
  }
  vtkSMProxy* named =
    this->FindDomain<vtkSMProxyListDomain>()->GetProxyWithName(OldNumbers[number]);
  // What stands for none is the first of the list.
  vtkSMProxy* tool = named ? named : tools.front();
  this->SetProxies(1, &tool);
  return 1;
}

void PalpateAddToolProperties()
{
  vtkClientServerInterpreter* interpreter =
    vtkClientServerInterpreterInitializer::GetGlobalInterpreter();
  interpreter->AddNewInstanceFunction("vtkSMPalpateToolProperty",
    [](void*) -> vtkObjectBase* { return vtkSMPalpateToolProperty::New(); });
  interpreter->AddNewInstanceFunction("vtkSMPalpateOldToolProperty",
    [](void*) -> vtkObjectBase* { return vtkSMPalpateOldToolProperty::New(); });
}
