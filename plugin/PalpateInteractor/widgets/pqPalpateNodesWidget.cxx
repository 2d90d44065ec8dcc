// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateNodesWidget.h"

#include <QLabel>
#include <QPushButton>
#include <QTimer>
#include <QVBoxLayout>
#include <cstdlib>
#include <exception>

#include "pqActiveObjects.h"
#include "pqApplicationCore.h"
#include "pqOutputPort.h"
#include "pqPVApplicationCore.h"
#include "pqPalpateFetch.h"
#include "pqPalpateHit.h"
#include "pqPipelineSource.h"
#include "pqRenderView.h"
#include "pqScalarValueListPropertyWidget.h"
#include "pqSelectionManager.h"
#include "pqServerManagerModel.h"
#include "vtkCommand.h"
#include "vtkDataSetSurfaceFilter.h"
#include "vtkMath.h"
#include "vtkPalpateGuard.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkRenderWindowInteractor.h"
#include "vtkSMOutputPort.h"
#include "vtkSMParaViewPipelineControllerWithRendering.h"
#include "vtkSMProperty.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMRenderViewProxy.h"
#include "vtkSMSelectionHelper.h"
#include "vtkSMSessionProxyManager.h"
#include "vtkSMSourceProxy.h"
#include "vtkSelectionNode.h"
#include "vtkStaticCellLocator.h"
#include "vtkUnstructuredGrid.h"

namespace
{
/// The observers come before ParaView's own, which have the priority 0.
constexpr float NodesPriority = 5;
/// A press and a release that are farther apart are a drag, pixels.
constexpr int Still = 3;
constexpr int AnyProcess = -1;
}

pqPalpateNodesWidget::pqPalpateNodesWidget(
  vtkSMProxy* proxy, vtkSMProperty* property, QWidget* parent)
  : Superclass(proxy, parent)
{
  this->setShowLabel(false);
  this->setChangeAvailableAsChangeFinished(true);
  this->List = new pqScalarValueListPropertyWidget(property, proxy, this);
  this->List->setObjectName("ScalarValueList");
  this->Button = new QPushButton("Click on the Body", this);
  this->Button->setObjectName("pick");
  this->Button->setCheckable(true);
  this->Button->setToolTip(
    "Shows the body in the active view. A click on one of its points adds the point, another one "
    "takes it away.");
  this->Message = new QLabel(this);
  this->Message->setObjectName("pickMessage");
  this->Message->setWordWrap(true);
  this->Message->hide();
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->addWidget(this->List);
  column->addWidget(this->Button);
  column->addWidget(this->Message);
  this->addPropertyLink(this->List, "scalars", SIGNAL(scalarsChanged()), property);
  if (property->IsValueDefault())
  {
    this->Defaults = this->List->scalars();
  }
  QObject::connect(this->Button, &QPushButton::toggled, this, &pqPalpateNodesWidget::startOrEnd);
  // When another filter is chosen, the panel shows that one.
  QObject::connect(&pqActiveObjects::instance(), &pqActiveObjects::sourceChanged, this,
    [this](pqPipelineSource* source)
    {
      if (this->Grid && this->Body && source == this->Body->getSource())
      {
        // This source was clicked. The filter is made active again only later, because ParaView is
        // still handling the click.
        QTimer::singleShot(0, this, &pqPalpateNodesWidget::activate);
      }
      else if (!source || source->getProxy() != this->proxy())
      {
        this->Button->setChecked(false);
      }
    });
}

pqPalpateNodesWidget::~pqPalpateNodesWidget()
{
  this->end();
}

void pqPalpateNodesWidget::activate()
{
  pqActiveObjects::instance().setActiveSource(
    pqApplicationCore::instance()->getServerManagerModel()->findItem<pqPipelineSource*>(
      this->proxy()));
}

void pqPalpateNodesWidget::startOrEnd(bool starts)
{
  if (starts)
  {
    this->start();
  }
  else
  {
    this->end();
    // Clearing a selection makes its source active too, but the button is in this filter's panel.
    this->activate();
  }
  this->Message->setVisible(starts);
}

pqOutputPort* pqPalpateNodesWidget::body() const
{
  vtkSMOutputPort* input = vtkSMPropertyHelper(this->proxy(), "Input", true).GetAsOutputPort();
  return input
    ? pqApplicationCore::instance()->getServerManagerModel()->findItem<pqOutputPort*>(input)
    : nullptr;
}

void pqPalpateNodesWidget::start()
{
  this->PickingView = qobject_cast<pqRenderView*>(pqActiveObjects::instance().activeView());
  this->Body = this->body();
  if (!this->PickingView || !this->Body)
  {
    this->Message->setText("Make a render view the active one, and press the button again.");
    return;
  }
  try
  {
    this->Grid = pqPalpateFetchBody(this->Body);
  }
  catch (const std::exception& error)
  {
    this->Message->setText(error.what());
    return;
  }
  if (!this->Grid || this->Grid->GetNumberOfCells() == 0)
  {
    this->Message->setText("The filter's input is no body. Press Apply on the filters before it.");
    return;
  }
  vtkNew<vtkDataSetSurfaceFilter> skin;
  skin->SetInputData(this->Grid);
  skin->Update();
  this->Surface->SetDataSet(skin->GetOutput());
  this->Surface->BuildLocator();
  this->Message->setText("Click on points of the body in the view; a drag turns the camera.");
  vtkSMRenderViewProxy* view = this->PickingView->getRenderViewProxy();
  vtkNew<vtkSMParaViewPipelineControllerWithRendering> controller;
  vtkSMSourceProxy* body = this->Body->getSourceProxy();
  auto* result = vtkSMSourceProxy::SafeDownCast(this->proxy());
  this->BodyWasSeen = controller->GetVisibility(body, this->Body->getPortNumber(), view);
  this->ResultWasSeen = result && controller->GetVisibility(result, 0, view);
  controller->Show(body, this->Body->getPortNumber(), view);
  if (this->ResultWasSeen)
  {
    controller->Hide(result, 0, view);
  }
  this->Interactor = view->GetInteractor();
  for (const unsigned long event :
    { vtkCommand::LeftButtonPressEvent, vtkCommand::LeftButtonReleaseEvent })
  {
    this->Observers.push_back(this->Interactor->AddObserver(
      event, this, &pqPalpateNodesWidget::handleEvent, NodesPriority));
  }
  this->PickingView->setCursor(Qt::CrossCursor);
  this->showChosen();
}

void pqPalpateNodesWidget::end()
{
  for (const unsigned long observer : this->Observers)
  {
    if (this->Interactor)
    {
      this->Interactor->RemoveObserver(observer);
    }
  }
  const bool picked = !this->Observers.empty();
  this->Observers.clear();
  if (!picked || !this->PickingView || !this->Body)
  {
    return;
  }
  this->Grid = nullptr;
  this->PickingView->setCursor(QCursor());
  pqPVApplicationCore::instance()->selectionManager()->clearSelection(this->Body);
  vtkNew<vtkSMParaViewPipelineControllerWithRendering> controller;
  vtkSMRenderViewProxy* view = this->PickingView->getRenderViewProxy();
  if (!this->BodyWasSeen)
  {
    controller->Hide(this->Body->getSourceProxy(), this->Body->getPortNumber(), view);
  }
  if (this->ResultWasSeen)
  {
    controller->Show(vtkSMSourceProxy::SafeDownCast(this->proxy()), 0, view);
  }
  this->PickingView->render();
}

bool pqPalpateNodesWidget::handleEvent(vtkObject* sender, unsigned long event, void*)
{
  vtkPalpateGuard(sender, [&] { this->handle(event); });
  return false;
}

void pqPalpateNodesWidget::handle(unsigned long event)
{
  const int* pixel = this->Interactor->GetEventPosition();
  if (event == vtkCommand::LeftButtonPressEvent)
  {
    this->Pressed[0] = pixel[0];
    this->Pressed[1] = pixel[1];
  }
  else if (std::abs(pixel[0] - this->Pressed[0]) <= Still &&
    std::abs(pixel[1] - this->Pressed[1]) <= Still)
  {
    this->pick(this->Pressed);
  }
}

void pqPalpateNodesWidget::pick(const int* pixel)
{
  if (!this->PickingView || !this->Body)
  {
    return;
  }
  double hit[3];
  if (!pqPalpateHit(
        this->PickingView->getRenderViewProxy()->GetRenderer(), this->Surface, pixel, hit))
  {
    this->Message->setText("The body is not there. Click on it in the view.");
    return;
  }
  const vtkIdType node = this->nearest(hit);
  vtkDataArray* fixed = this->Grid->GetPointData()->GetArray("Fixed");
  if (node < 0 || (fixed && fixed->GetTuple1(node) != 0))
  {
    this->Message->setText("The body is held there. Click on a point that may be touched.");
    return;
  }
  this->toggle(node);
}

vtkIdType pqPalpateNodesWidget::nearest(const double* place) const
{
  vtkDataArray* fixed = this->Grid->GetPointData()->GetArray("Fixed");
  vtkDataArray* touchable = this->Grid->GetPointData()->GetArray("Touchable");
  vtkIdType nearest = -1;
  double least = VTK_DOUBLE_MAX;
  for (vtkIdType point = 0; point < this->Grid->GetNumberOfPoints(); ++point)
  {
    const bool isInside =
      fixed && touchable && fixed->GetTuple1(point) == 0 && touchable->GetTuple1(point) == 0;
    const double squared = vtkMath::Distance2BetweenPoints(place, this->Grid->GetPoint(point));
    if (!isInside && squared < least)
    {
      least = squared;
      nearest = point;
    }
  }
  return nearest;
}

void pqPalpateNodesWidget::toggle(vtkIdType node)
{
  QVariantList nodes = this->List->scalars();
  if (!this->Defaults.empty() && nodes == this->Defaults)
  {
    nodes.clear();
  }
  this->Defaults.clear();
  int found = 0;
  while (found < nodes.size() && nodes[found].toLongLong() != node)
  {
    ++found;
  }
  const bool isNew = found == nodes.size();
  if (isNew)
  {
    nodes.push_back(static_cast<qlonglong>(node));
  }
  else
  {
    nodes.removeAt(found);
  }
  this->List->setScalars(nodes);
  // The list signals a change by itself only where it is edited by hand.
  Q_EMIT this->List->scalarsChanged();
  this->Message->setText(
    QString(isNew ? "Point %1 is chosen." : "Point %1 is not chosen any more.").arg(node));
  this->showChosen();
}

void pqPalpateNodesWidget::showChosen()
{
  std::vector<vtkIdType> pairs;
  for (const QVariant& node : this->List->scalars())
  {
    pairs.push_back(AnyProcess);
    pairs.push_back(node.toLongLong());
  }
  pqSelectionManager* manager = pqPVApplicationCore::instance()->selectionManager();
  if (pairs.empty())
  {
    manager->clearSelection(this->Body);
    this->PickingView->render();
    return;
  }
  vtkSmartPointer<vtkSMSourceProxy> points;
  points.TakeReference(vtkSMSourceProxy::SafeDownCast(
    this->proxy()->GetSessionProxyManager()->NewProxy("sources", "IDSelectionSource")));
  vtkSMPropertyHelper(points, "IDs").Set(pairs.data(), static_cast<unsigned int>(pairs.size()));
  vtkSMPropertyHelper(points, "FieldType").Set(vtkSelectionNode::POINT);
  points->UpdateVTKObjects();
  vtkSmartPointer<vtkSMSourceProxy> selection;
  selection.TakeReference(vtkSMSourceProxy::SafeDownCast(
    vtkSMSelectionHelper::NewAppendSelectionsFromSelectionSource(points)));
  this->Body->setSelectionInput(selection, 0);
  manager->select(this->Body);
  this->PickingView->render();
}
