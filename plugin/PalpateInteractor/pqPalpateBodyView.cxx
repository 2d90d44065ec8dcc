// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateBodyView.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "pqApplicationCore.h"
#include "pqObjectBuilder.h"
#include "pqOutputPort.h"
#include "pqPipelineSource.h"
#include "pqProgressManager.h"
#include "pqRenderView.h"
#include "vtkDataObject.h"
#include "vtkNew.h"
#include "vtkSMOutputPort.h"
#include "vtkSMPVRepresentationProxy.h"
#include "vtkSMParaViewPipelineControllerWithRendering.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMRepresentationProxy.h"
#include "vtkSMSourceProxy.h"
#include "vtkSMTransferFunctionManager.h"
#include "vtkSMTransferFunctionProxy.h"
#include "vtkSMViewProxy.h"

namespace
{
/// A frame that comes later than this after the one before is late: 25 Hz.
constexpr qint64 LatestFrame = 40; // ms
constexpr const char* TouchSpace = "TouchStateSpace";
constexpr const char* TouchReduced = "TouchReducedModel";
/// So many more late than punctual ones, and the picture becomes plainer.
constexpr int Patience = 8;
/// Of a render view.
constexpr const char* SmoothEdges = "UseFXAA";
/// Of a representation, and two values of it.
constexpr const char* Backface = "BackfaceRepresentation";
/// The rigid tool of a space that has one, else its first active node.
constexpr int FirstOfSpace = -1;
constexpr int LikeTheFront = 400;
constexpr int Culled = 401;

pqPipelineSource* FindFilter(pqOutputPort* space, const char* name)
{
  for (pqPipelineSource* consumer : space->getConsumers())
  {
    if (QString(consumer->getProxy()->GetXMLName()) == name)
    {
      return consumer;
    }
  }
  return nullptr;
}

pqPipelineSource* MakeFilter(
  pqOutputPort* space, pqRenderView* view, const char* name, const char* colouredBy, double most)
{
  pqPipelineSource* filter = pqApplicationCore::instance()->getObjectBuilder()->createFilter(
    "filters", name, space->getSource(), space->getPortNumber());
  if (!filter)
  {
    throw std::runtime_error(
      std::string("The server has no filter ") + name + ": load the plugin Palpate on it, too.");
  }
  filter->setModifiedState(pqProxy::UNMODIFIED);
  vtkNew<vtkSMParaViewPipelineControllerWithRendering> controller;
  auto* shown = vtkSMPVRepresentationProxy::SafeDownCast(
    controller->Show(filter->getSourceProxy(), 0, view->getViewProxy()));
  if (shown && shown->SetScalarColoring(colouredBy, vtkDataObject::POINT))
  {
    // The colours shall not change their meaning from frame to frame.
    vtkSMProxy* colours = vtkSMPropertyHelper(shown, "LookupTable").GetAsProxy();
    vtkSMPropertyHelper(colours, "AutomaticRescaleRangeMode")
      .Set(vtkSMTransferFunctionManager::NEVER);
    colours->UpdateVTKObjects();
    vtkSMTransferFunctionProxy::RescaleTransferFunction(colours, 0, most);
    shown->SetScalarBarVisibility(view->getViewProxy(), true);
  }
  return filter;
}
}

pqPalpateBodyView::pqPalpateBodyView(
  pqOutputPort* space, pqRenderView* view, const char* colouredBy, double most, const double* free)
  : pqPalpateBodyView(space, view, TouchSpace, colouredBy, most, free)
{
}

pqPalpateBodyView::pqPalpateBodyView(pqOutputPort* model, pqRenderView* view, double most)
  : pqPalpateBodyView(model, view, TouchReduced, "Displacement", most, nullptr)
{
}

pqPalpateBodyView::pqPalpateBodyView(pqOutputPort* space, pqRenderView* view, const char* filter,
  const char* colouredBy, double most, const double* free)
  : IsReduced(!free)
  , Filter(FindFilter(space, filter))
  , View(view)
{
  if (free)
  {
    std::copy_n(free, 3, this->Free);
  }
  if (!this->Filter)
  {
    this->Filter = MakeFilter(space, view, filter, colouredBy, most);
  }
  // It may be a person's own, and show another place, or nothing here.
  this->SetRest();
  vtkNew<vtkSMParaViewPipelineControllerWithRendering> controller;
  if (!controller->GetVisibility(this->Filter->getSourceProxy(), 0, view->getViewProxy()))
  {
    controller->Show(this->Filter->getSourceProxy(), 0, view->getViewProxy());
  }
  // What is seen of the space itself would hide the touched body.
  controller->Hide(space->getSourceProxy(), space->getPortNumber(), view->getViewProxy());
  this->Time.start();
}

void pqPalpateBodyView::RestorePicture()
{
  this->IsOver = true;
  for (const Omission& omission : this->Omissions)
  {
    if (omission.Proxy)
    {
      vtkSMPropertyHelper(omission.Proxy, omission.Property).Set(omission.Before);
      omission.Proxy->UpdateVTKObjects();
    }
  }
  const bool isPlain = !this->Omissions.empty();
  this->Omissions.clear();
  if (this->View && isPlain)
  {
    this->View->render();
  }
}

void pqPalpateBodyView::Show(int node, int branch, const double* displacement)
{
  vtkSMProxy* filter = this->Filter->getProxy();
  const bool isKnown = this->IsKnown();
  vtkSMPropertyHelper(filter, "ActiveNode").Set(static_cast<vtkIdType>(node));
  // The loop has followed the node here.
  vtkSMPropertyHelper(filter, "StartDisplacement").Set(displacement, 3);
  vtkSMPropertyHelper(filter, "StartBranch").Set(branch);
  vtkSMPropertyHelper(filter, "Branch").Set(-1);
  vtkSMPropertyHelper(filter, "Displacement").Set(displacement, 3);
  this->Take(filter, isKnown);
}

void pqPalpateBodyView::ShowPressed(const double* place)
{
  vtkSMProxy* filter = this->Filter->getProxy();
  const bool isKnown = this->IsKnown();
  vtkSMPropertyHelper(filter, "ActiveNode").Set(static_cast<vtkIdType>(FirstOfSpace));
  vtkSMPropertyHelper(filter, "ToolPosition").Set(place, 3);
  this->Take(filter, isKnown);
}

void pqPalpateBodyView::ShowReduced(const double* coordinates, unsigned int number)
{
  vtkSMProxy* filter = this->Filter->getProxy();
  const bool isKnown = this->IsKnown();
  vtkSMPropertyHelper helper(filter, "Coordinates");
  helper.SetNumberOfElements(number);
  helper.Set(coordinates, number);
  this->Take(filter, isKnown);
}

bool pqPalpateBodyView::IsKnown() const
{
  return this->View && !this->View->getViewProxy()->GetNeedsUpdate();
}

void pqPalpateBodyView::Take(vtkSMProxy* filter, bool isKnown)
{
  filter->UpdateVTKObjects();
  if (isKnown && !this->IsOver && this->NumberOfFrames > 0)
  {
    this->KeepDomains();
  }
}

void pqPalpateBodyView::KeepDomains()
{
  constexpr bool usesCache = true;
  vtkSMPropertyHelper shown(this->View->getProxy(), "Representations");
  for (unsigned int i = 0; i < shown.GetNumberOfElements(); ++i)
  {
    auto* representation = vtkSMRepresentationProxy::SafeDownCast(shown.GetAsProxy(i));
    if (!representation)
    {
      continue;
    }
    representation->PostUpdateData(usesCache);
    // Who asks for ranges is told those of now.
    if (vtkSMOutputPort* port =
          vtkSMPropertyHelper(representation, "Input", true).GetAsOutputPort())
    {
      port->InvalidateDataInformation();
    }
  }
}

void pqPalpateBodyView::ShowRest()
{
  if (this->Filter && this->View)
  {
    this->SetRest();
    // Now ParaView asks for everything.
    vtkSMProxy* filter = this->Filter->getProxy();
    filter->MarkDirty(filter);
    this->View->render();
  }
}

void pqPalpateBodyView::SetRest()
{
  if (this->IsReduced)
  {
    this->ShowReduced(nullptr, 0);
    return;
  }
  constexpr int findsItself = -1;
  const double zero[3] = { 0, 0, 0 };
  vtkSMPropertyHelper(this->Filter->getProxy(), "ToolPosition").Set(this->Free, 3);
  this->Show(FirstOfSpace, findsItself, zero);
}

void pqPalpateBodyView::Draw()
{
  if (!this->View)
  {
    return;
  }
  // The bar of progress would be drawn anew for each frame.
  pqProgressManager* progress = pqApplicationCore::instance()->getProgressManager();
  progress->lockProgress(progress);
  this->View->forceRender();
  progress->unlockProgress(progress);
  ++this->NumberOfFrames;
  this->Frames.push_back(this->Time.elapsed());
  this->KeepPace();
}

void pqPalpateBodyView::KeepPace()
{
  const qint64 last = this->LastFrame;
  this->LastFrame = this->Frames.back();
  if (last < 0 || !this->View || this->IsOver)
  {
    return;
  }
  const qint64 interval = this->LastFrame - last;
  this->LateFrames = std::max(0, this->LateFrames + (interval > LatestFrame ? 1 : -1));
  if (this->LateFrames < Patience || !this->Omissions.empty())
  {
    return;
  }
  vtkSMProxy* view = this->View->getProxy();
  if (vtkSMPropertyHelper(view, SmoothEdges, true).GetAsInt() != 0)
  {
    this->LeaveOut(view, SmoothEdges, 0);
  }
  // The inner side of a closed, opaque surface is never seen.
  vtkSMProxy* body = this->Filter
    ? this->View->getViewProxy()->FindRepresentation(this->Filter->getSourceProxy(), 0)
    : nullptr;
  if (body && vtkSMPropertyHelper(body, "Opacity", true).GetAsDouble() >= 1 &&
    vtkSMPropertyHelper(body, Backface, true).GetAsInt() == LikeTheFront)
  {
    this->LeaveOut(body, Backface, Culled);
  }
}

void pqPalpateBodyView::LeaveOut(vtkSMProxy* proxy, const char* property, int value)
{
  vtkSMPropertyHelper helper(proxy, property);
  this->Omissions.push_back({ proxy, property, helper.GetAsInt() });
  helper.Set(value);
  proxy->UpdateVTKObjects();
}

double pqPalpateBodyView::GetFrameRate()
{
  constexpr qint64 window = 1000; // ms
  const auto recent = std::find_if(this->Frames.begin(), this->Frames.end(),
    [now = this->Time.elapsed()](qint64 frame) { return frame >= now - window; });
  this->Frames.erase(this->Frames.begin(), recent);
  return 1e3 / window * static_cast<double>(this->Frames.size());
}
