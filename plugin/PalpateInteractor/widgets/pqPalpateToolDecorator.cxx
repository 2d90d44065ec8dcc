// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateToolDecorator.h"

#include <cstring>

#include "pqApplicationCore.h"
#include "pqOutputPort.h"
#include "pqPalpateFetch.h"
#include "pqPipelineSource.h"
#include "pqPropertyWidget.h"
#include "pqServerManagerModel.h"
#include "vtkPVXMLElement.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMProxy.h"

pqPalpateToolDecorator::pqPalpateToolDecorator(vtkPVXMLElement* config, pqPropertyWidget* parent)
  : Superclass(config, parent)
  , IsForRigidTool(std::strcmp(config->GetAttributeOrEmpty("tool"), "rigid") == 0)
{
  pqServerManagerModel* model = pqApplicationCore::instance()->getServerManagerModel();
  QObject::connect(model, &pqServerManagerModel::dataUpdated, this,
    [this](pqPipelineSource* source)
    {
      pqOutputPort* space = this->input();
      if (space && space->getSource() == source)
      {
        Q_EMIT this->visibilityChanged();
      }
    });
}

pqOutputPort* pqPalpateToolDecorator::input() const
{
  vtkSMPropertyHelper input(this->parentWidget()->proxy(), "Input", true);
  vtkSMProxy* proxy = input.GetNumberOfElements() > 0 ? input.GetAsProxy() : nullptr;
  auto* source =
    pqApplicationCore::instance()->getServerManagerModel()->findItem<pqPipelineSource*>(proxy);
  return source ? source->getOutputPort(static_cast<int>(input.GetOutputPort())) : nullptr;
}

bool pqPalpateToolDecorator::canShowWidget(bool showAdvanced) const
{
  pqOutputPort* space = this->input();
  const bool isThere = !space ||
    (this->IsForRigidTool ? pqPalpateHasRigidTool(space) : pqPalpateHasActiveNodes(space));
  return isThere && this->Superclass::canShowWidget(showAdvanced);
}
