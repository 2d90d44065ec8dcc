// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpatePictures.h"

#include <QTimer>
#include <cstring>
#include <string>

#include "pqApplicationCore.h"
#include "pqCoreUtilities.h"
#include "pqOutputPort.h"
#include "pqPVApplicationCore.h"
#include "pqPalpateFetch.h"
#include "pqPipelineSource.h"
#include "pqRepresentation.h"
#include "pqSelectionManager.h"
#include "pqServerManagerModel.h"
#include "pqView.h"
#include "vtkCommand.h"
#include "vtkDataObject.h"
#include "vtkNew.h"
#include "vtkPVArrayInformation.h"
#include "vtkPVDataInformation.h"
#include "vtkSMProperty.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMProxy.h"
#include "vtkSMSourceProxy.h"
#include "vtkSMTransferFunctionManager.h"

namespace
{
constexpr int FontSize = 10;
constexpr const char* Chart = "PalpateErrorChartRepresentation";

bool Is(vtkSMProxy* proxy, const char* name)
{
  return std::strcmp(proxy->GetXMLName(), name) == 0;
}

/// The least value of a component, which is its value where there is one point.
double LeastValue(vtkPVArrayInformation* array, int component)
{
  return array->GetComponentRange(component)[0];
}
}

pqPalpatePictures::pqPalpatePictures(QObject* parent)
  : QObject(parent)
{
}

void pqPalpatePictures::startup()
{
  // This waits, because a plugin of PV_PLUGIN_PATH is loaded before the window has all its parts.
  QTimer::singleShot(0, this, &pqPalpatePictures::watch);
}

void pqPalpatePictures::watch()
{
  QObject::connect(pqPVApplicationCore::instance()->selectionManager(),
    &pqSelectionManager::selectionChanged, this, &pqPalpatePictures::touchSelected);
  pqServerManagerModel* model = pqApplicationCore::instance()->getServerManagerModel();
  const auto watchView = [this](pqView* view)
  {
    QObject::connect(view, &pqView::representationAdded, this,
      [this, view](pqRepresentation* shown) { this->makeAxes(view, shown); });
  };
  QObject::connect(model, &pqServerManagerModel::viewAdded, this, watchView);
  for (pqView* view : model->findItems<pqView*>())
  {
    watchView(view);
  }
}

void pqPalpatePictures::touchSelected(pqOutputPort* space)
{
  if (!space || !pqPalpateGivesStateSpace(space))
  {
    return;
  }
  vtkSMSourceProxy* selected =
    space->getSourceProxy()->GetSelectionOutput(static_cast<unsigned int>(space->getPortNumber()));
  if (!selected)
  {
    return;
  }
  selected->UpdatePipeline();
  vtkPVDataInformation* data = selected->GetDataInformation(0);
  // A point of the body's surface has no array of a configuration.
  vtkPVArrayInformation* node = data->GetArrayInformation("ActiveNode", vtkDataObject::POINT);
  vtkPVArrayInformation* place = data->GetArrayInformation("Displacement", vtkDataObject::POINT);
  if (!node || !place || data->GetNumberOfPoints() != 1)
  {
    return;
  }
  const double displacement[3] = { LeastValue(place, 0), LeastValue(place, 1),
    LeastValue(place, 2) };
  for (pqPipelineSource* consumer : space->getConsumers())
  {
    vtkSMProxy* touch = consumer->getProxy();
    if (Is(touch, "TouchStateSpace"))
    {
      const auto activeNode = static_cast<vtkIdType>(LeastValue(node, 0));
      vtkSMPropertyHelper(touch, "ActiveNode").Set(activeNode);
      vtkPVArrayInformation* body = data->GetArrayInformation("BodyNumber", vtkDataObject::POINT);
      vtkSMPropertyHelper(touch, "BodyNumber")
        .Set(body ? static_cast<vtkIdType>(LeastValue(body, 0)) : 1);
      if (activeNode < 0)
      {
        // The coordinates of a rigid tool are its place.
        vtkSMPropertyHelper(touch, "ToolPosition").Set(displacement, 3);
        vtkSMPropertyHelper(touch, "FromStart").Set(0);
        vtkSMPropertyHelper(touch, "StartBranch").Set(-1);
        vtkSMPropertyHelper(touch, "Branch").Set(-1);
      }
      else
      {
        constexpr double rest[3] = { 0, 0, 0 };
        vtkSMPropertyHelper(touch, "StartDisplacement").Set(rest, 3);
        vtkSMPropertyHelper(touch, "StartBranch").Set(-1);
        vtkSMPropertyHelper(touch, "Displacement").Set(displacement, 3);
      }
      touch->UpdateVTKObjects();
      consumer->updatePipeline();
      // The colours are rescaled as after Apply.
      vtkNew<vtkSMTransferFunctionManager> colours;
      colours->ResetAllTransferFunctionRangesUsingCurrentData(consumer->proxyManager(), false);
      consumer->renderAllViews();
    }
  }
}

void pqPalpatePictures::makeAxes(pqView* view, pqRepresentation* shown)
{
  vtkSMProxy* chart = shown->getProxy();
  vtkSMProxy* axes = view->getProxy();
  // A chart of a state that is being loaded has its own axes.
  if (!Is(chart, Chart) || !axes->GetProperty("LeftAxisLogScale") ||
    pqApplicationCore::instance()->isLoadingState())
  {
    return;
  }
  vtkSMPropertyHelper(axes, "LeftAxisLogScale").Set(1);
  vtkSMPropertyHelper(axes, "BottomAxisLogScale").Set(1);
  vtkSMPropertyHelper(axes, "LeftAxisTitle").Set("Mean error of the force (%)");
  // The chart has only a third of the window, so that its letters are smaller.
  for (const char* size : { "LeftAxisTitleFontSize", "BottomAxisTitleFontSize", "LegendFontSize" })
  {
    vtkSMPropertyHelper(axes, size).Set(FontSize);
  }
  this->nameXAxes();
  pqCoreUtilities::connect(
    chart->GetProperty("XArrayName"), vtkCommand::ModifiedEvent, this, SLOT(nameXAxes()));
}

void pqPalpatePictures::nameXAxes()
{
  pqServerManagerModel* model = pqApplicationCore::instance()->getServerManagerModel();
  for (pqView* view : model->findItems<pqView*>())
  {
    for (pqRepresentation* shown : view->getRepresentations())
    {
      if (Is(shown->getProxy(), Chart))
      {
        const std::string array =
          vtkSMPropertyHelper(shown->getProxy(), "XArrayName").GetAsString();
        const char* title = array == "Time" ? "Time of an evaluation (ns)"
          : array == "Bytes"                ? "Memory of an active node (bytes)"
          : array == "PrecomputeSeconds"    ? "Precomputation of an active node on one core (s)"
                                            : array.c_str();
        vtkSMPropertyHelper(view->getProxy(), "BottomAxisTitle").Set(title);
        view->getProxy()->UpdateVTKObjects();
      }
    }
  }
}
