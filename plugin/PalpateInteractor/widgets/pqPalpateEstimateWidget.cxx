// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateEstimateWidget.h"

#include <QLabel>
#include <QVBoxLayout>
#include <vector>

#include "pqApplicationCore.h"
#include "pqCoreUtilities.h"
#include "pqPipelineSource.h"
#include "pqServerManagerModel.h"
#include "vtkCommand.h"
#include "vtkSMDoubleVectorProperty.h"
#include "vtkSMIdTypeVectorProperty.h"
#include "vtkSMInputProperty.h"
#include "vtkSMIntVectorProperty.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMPropertyIterator.h"
#include "vtkSMProxyListDomain.h"
#include "vtkSMSessionProxyManager.h"
#include "vtkSMSourceProxy.h"
#include "vtkSMStringVectorProperty.h"

namespace
{
/// The pause after a change before the estimate is made, ms. Nobody reads faster than that.
constexpr int PauseTime = 300;

/// The proxies that a property chooses among; empty: the property chooses no proxy.
std::vector<vtkSMProxy*> ChoicesOf(vtkSMProperty* property)
{
  std::vector<vtkSMProxy*> choices;
  if (auto* list = property->FindDomain<vtkSMProxyListDomain>())
  {
    for (unsigned int i = 0; i < list->GetNumberOfProxies(); ++i)
    {
      choices.push_back(list->GetProxy(i));
    }
  }
  return choices;
}

/// Copies the value that the panel shows, where both properties are of this type.
template <class Property>
void TakeShown(vtkSMProperty* from, vtkSMProperty* to)
{
  auto* shown = Property::SafeDownCast(from);
  auto* taken = Property::SafeDownCast(to);
  if (!shown || !taken)
  {
    return;
  }
  taken->SetNumberOfElements(shown->GetNumberOfUncheckedElements());
  for (unsigned int i = 0; i < shown->GetNumberOfUncheckedElements(); ++i)
  {
    taken->SetElement(i, shown->GetUncheckedElement(i));
  }
}

/// Copies the values that the panel shows to another proxy of the same kind.
void TakeAllShown(vtkSMProxy* from, vtkSMProxy* to)
{
  auto iterator = vtkSmartPointer<vtkSMPropertyIterator>::Take(from->NewPropertyIterator());
  for (iterator->Begin(); !iterator->IsAtEnd(); iterator->Next())
  {
    vtkSMProperty* shown = iterator->GetProperty();
    vtkSMProperty* taken = to->GetProperty(iterator->GetKey());
    if (!taken || shown->GetInformationOnly())
    {
      continue;
    }
    TakeShown<vtkSMIntVectorProperty>(shown, taken);
    TakeShown<vtkSMIdTypeVectorProperty>(shown, taken);
    TakeShown<vtkSMDoubleVectorProperty>(shown, taken);
    TakeShown<vtkSMStringVectorProperty>(shown, taken);
    auto* proxies = vtkSMProxyProperty::SafeDownCast(shown);
    if (!proxies)
    {
      continue;
    }
    if (vtkSMInputProperty::SafeDownCast(shown))
    {
      taken->Copy(shown);
      continue;
    }
    auto* choices = vtkSMProxyProperty::SafeDownCast(taken);
    vtkSMProxy* chosen =
      proxies->GetNumberOfUncheckedProxies() > 0 ? proxies->GetUncheckedProxy(0) : nullptr;
    choices->RemoveAllProxies();
    if (chosen)
    {
      vtkSmartPointer<vtkSMProxy> copy;
      copy.TakeReference(
        chosen->GetSessionProxyManager()->NewProxy(chosen->GetXMLGroup(), chosen->GetXMLName()));
      TakeAllShown(chosen, copy);
      copy->UpdateVTKObjects();
      choices->AddProxy(copy);
    }
  }
}
}

pqPalpateEstimateWidget::pqPalpateEstimateWidget(
  vtkSMProxy* proxy, vtkSMProperty* vtkNotUsed(property), QWidget* parent)
  : Superclass(proxy, parent)
  , Text(new QLabel(this))
{
  this->setShowLabel(false);
  this->Text->setObjectName("estimate");
  this->Text->setWordWrap(true);
  this->Text->setTextInteractionFlags(Qt::TextSelectableByMouse);
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->addWidget(this->Text);
  this->Pause.setSingleShot(true);
  this->Pause.setInterval(PauseTime);
  QObject::connect(&this->Pause, &QTimer::timeout, this, &pqPalpateEstimateWidget::estimate);
  this->follow(proxy);
  // A filter upstream may be applied meanwhile.
  QObject::connect(pqApplicationCore::instance()->getServerManagerModel(),
    &pqServerManagerModel::dataUpdated, this,
    [this](pqPipelineSource* source)
    {
      vtkSMPropertyHelper input(this->proxy(), "Input", true);
      if (input.GetNumberOfElements() > 0 && input.GetAsProxy() == source->getProxy())
      {
        this->changed();
      }
    });
}

pqPalpateEstimateWidget::~pqPalpateEstimateWidget() = default;

void pqPalpateEstimateWidget::follow(vtkSMProxy* proxy)
{
  auto iterator = vtkSmartPointer<vtkSMPropertyIterator>::Take(proxy->NewPropertyIterator());
  for (iterator->Begin(); !iterator->IsAtEnd(); iterator->Next())
  {
    vtkSMProperty* property = iterator->GetProperty();
    if (property->GetInformationOnly())
    {
      continue;
    }
    pqCoreUtilities::connect(
      property, vtkCommand::UncheckedPropertyModifiedEvent, this, SLOT(changed()));
    for (vtkSMProxy* choice : ChoicesOf(property))
    {
      this->follow(choice);
    }
  }
}

void pqPalpateEstimateWidget::showEvent(QShowEvent* event)
{
  this->Superclass::showEvent(event);
  this->changed();
}

void pqPalpateEstimateWidget::changed()
{
  if (this->isVisible())
  {
    this->Pause.start();
  }
}

void pqPalpateEstimateWidget::estimate()
{
  if (!this->isVisible())
  {
    return;
  }
  vtkSMProxy* shown = this->proxy();
  if (!this->Copy)
  {
    this->Copy.TakeReference(vtkSMSourceProxy::SafeDownCast(
      shown->GetSessionProxyManager()->NewProxy(shown->GetXMLGroup(), shown->GetXMLName())));
  }
  TakeAllShown(shown, this->Copy);
  this->Copy->UpdateVTKObjects();
  this->Copy->InvokeCommand("UpdateEstimate");
  vtkSMProperty* text = this->Copy->GetProperty("Estimate");
  this->Copy->UpdatePropertyInformation(text);
  this->Text->setText(vtkSMPropertyHelper(text).GetAsString());
}
