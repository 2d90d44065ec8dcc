// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateBodyView.h"

#include <QScopeGuard>
#include <algorithm>
#include <array>
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
#include "vtkSMRenderViewProxy.h"
#include "vtkSMRepresentationProxy.h"
#include "vtkSMSourceProxy.h"
#include "vtkSMTransferFunctionManager.h"
#include "vtkSMTransferFunctionProxy.h"
#include "vtkSMViewProxy.h"

namespace
{
/// A frame is late when it comes later than this after the one before (25 Hz).
constexpr qint64 LatestFrame = 40; // ms
/// The name of an annotation of a filter that the dock has made. It says which colours the filter
/// was last given; a person may have changed them since.
constexpr const char* OwnColours = "PalpateColours";
constexpr const char* Tissue = "tissue";
constexpr const char* Map = "map";
/// The colours from the least to the largest value, as in the pictures of the pages. The first one
/// is that of tissue.
constexpr std::array<std::array<double, 3>, 3> OverTissue = { { { 0.88, 0.70, 0.62 },
  { 0.93, 0.50, 0.27 }, { 0.60, 0.05, 0.20 } } };
/// The value of "ColorSpace" with which the colours in between are neither grey nor dark.
constexpr int Lab = 2;
/// The part of a colour that does not depend on the light.
constexpr double Brightness = 0.3;
/// The colours of the legend, those of the numbers beside the tool: legible on each background and
/// in front of the body.
constexpr std::array<double, 3> LegendInk = { 0.1, 0.1, 0.1 };
constexpr std::array<double, 4> LegendPaper = { 1, 1, 0.85, 0.9 };
constexpr const char* TouchSpace = "TouchStateSpace";
constexpr const char* TouchReduced = "TouchReducedModel";
/// When this many more frames were late than punctual, the picture becomes plainer.
constexpr int Patience = 8;
/// The property of a render view that smooths edges.
constexpr const char* SmoothEdges = "UseFXAA";
/// A property of a representation, and two of its values.
constexpr const char* Backface = "BackfaceRepresentation";
/// This number stands for the rigid tool of a space that has one, else for its first active node.
constexpr int FirstOfSpace = -1;
constexpr vtkIdType FirstBody = 1;
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

pqPipelineSource* MakeFilter(pqOutputPort* space, const char* name)
{
  pqPipelineSource* filter = pqApplicationCore::instance()->getObjectBuilder()->createFilter(
    "filters", name, space->getSource(), space->getPortNumber());
  if (!filter)
  {
    throw std::runtime_error(
      std::string("The server has no filter ") + name + ": load the plugin Palpate on it, too.");
  }
  filter->setModifiedState(pqProxy::UNMODIFIED);
  filter->getProxy()->SetAnnotation(OwnColours, "");
  return filter;
}
}

pqPalpateBodyView::pqPalpateBodyView(pqOutputPort* space, pqRenderView* view,
  const char* colouredBy, double most, bool inTissue, const double* free)
  : pqPalpateBodyView(space, view, TouchSpace, colouredBy, most, inTissue, free)
{
}

pqPalpateBodyView::pqPalpateBodyView(
  pqOutputPort* model, pqRenderView* view, double most, bool inTissue)
  : pqPalpateBodyView(model, view, TouchReduced, "Displacement", most, inTissue, nullptr)
{
}

pqPalpateBodyView::pqPalpateBodyView(pqOutputPort* space, pqRenderView* view, const char* filter,
  const char* colouredBy, double most, bool inTissue, const double* free)
  : IsReduced(!free)
  , ColouredBy(colouredBy)
  , Most(most)
  , Filter(FindFilter(space, filter))
  , View(view)
{
  if (free)
  {
    std::copy_n(free, 3, this->Free);
  }
  if (!this->Filter)
  {
    this->Filter = MakeFilter(space, filter);
  }
  // The filter may be a person's own, and show another place, or nothing in this view.
  this->SetRest();
  vtkNew<vtkSMParaViewPipelineControllerWithRendering> controller;
  if (!controller->GetVisibility(this->Filter->getSourceProxy(), 0, view->getViewProxy()))
  {
    controller->Show(this->Filter->getSourceProxy(), 0, view->getViewProxy());
  }
  if (const char* has = this->Filter->getProxy()->GetAnnotation(OwnColours))
  {
    if (std::string(has) != (inTissue ? Tissue : Map))
    {
      this->SetColours(inTissue);
    }
    this->SetLegend();
  }
  // The picture of the space itself would hide the touched body.
  controller->Hide(space->getSourceProxy(), space->getPortNumber(), view->getViewProxy());
  this->Time.start();
}

void pqPalpateBodyView::SetColours(bool inTissue)
{
  vtkSMPVRepresentationProxy* shown = this->FindShown();
  if (!shown || !shown->SetScalarColoring(this->ColouredBy.c_str(), vtkDataObject::POINT))
  {
    return;
  }
  vtkSMProxy* colours = vtkSMPropertyHelper(shown, "LookupTable").GetAsProxy();
  // The colours must not change their meaning from frame to frame.
  vtkSMPropertyHelper(colours, "AutomaticRescaleRangeMode")
    .Set(vtkSMTransferFunctionManager::NEVER);
  if (inTissue)
  {
    std::vector<double> points;
    for (std::size_t i = 0; i < OverTissue.size(); ++i)
    {
      points.push_back(static_cast<double>(i) / (OverTissue.size() - 1));
      points.insert(points.end(), OverTissue[i].begin(), OverTissue[i].end());
    }
    vtkSMPropertyHelper table(colours, "RGBPoints");
    table.SetNumberOfElements(static_cast<unsigned int>(points.size()));
    table.Set(points.data(), static_cast<unsigned int>(points.size()));
    vtkSMPropertyHelper(colours, "ColorSpace").Set(Lab);
  }
  else
  {
    vtkSMTransferFunctionProxy::ApplyPreset(colours, "Cool to Warm", true);
  }
  colours->UpdateVTKObjects();
  vtkSMTransferFunctionProxy::RescaleTransferFunction(colours, 0, this->Most);
  // With this share of ambient light, deep folds and what faces away from the light are visible
  // too.
  vtkSMPropertyHelper(shown, "Ambient", true).Set(inTissue ? Brightness : 0);
  vtkSMPropertyHelper(shown, "Diffuse", true).Set(inTissue ? 1 - Brightness : 1);
  shown->UpdateVTKObjects();
  shown->SetScalarBarVisibility(this->View->getViewProxy(), true);
  this->Filter->getProxy()->SetAnnotation(OwnColours, inTissue ? Tissue : Map);
  this->SetLegend();
  this->View->render();
}

vtkSMPVRepresentationProxy* pqPalpateBodyView::FindShown() const
{
  return this->Filter && this->View
    ? vtkSMPVRepresentationProxy::SafeDownCast(
        this->View->getViewProxy()->FindRepresentation(this->Filter->getSourceProxy(), 0))
    : nullptr;
}

void pqPalpateBodyView::SetLegend()
{
  vtkSMPVRepresentationProxy* shown = this->FindShown();
  vtkSMProxy* legend = shown
    ? vtkSMTransferFunctionProxy::FindScalarBarRepresentation(
        vtkSMPropertyHelper(shown, "LookupTable").GetAsProxy(), this->View->getViewProxy())
    : nullptr;
  if (!legend)
  {
    return;
  }
  // The letters need a colour of their own, because the body may lie behind the legend.
  for (const char* letters : { "TitleColor", "LabelColor" })
  {
    vtkSMPropertyHelper(legend, letters).Set(LegendInk.data(), 3);
  }
  vtkSMPropertyHelper(legend, "BackgroundColor").Set(LegendPaper.data(), 4);
  vtkSMPropertyHelper(legend, "DrawBackground").Set(1);
  vtkSMPropertyHelper(legend, "Title")
    .Set(this->ColouredBy == "Displacement" ? "Displacement (m)" : "Pressure (Pa)");
  vtkSMPropertyHelper(legend, "ComponentTitle").Set("");
  legend->UpdateVTKObjects();
}

void pqPalpateBodyView::Leave(pqPalpateRunWatch::Left left)
{
  if (left != pqPalpateRunWatch::Left::Nothing)
  {
    this->RestorePicture();
  }
  if (left == pqPalpateRunWatch::Left::All)
  {
    this->ShowRest();
  }
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

void pqPalpateBodyView::Show(
  int node, vtkIdType body, int branch, const double* displacement, double tornArea)
{
  vtkSMProxy* filter = this->Filter->getProxy();
  const bool isKnown = this->IsKnown();
  vtkSMPropertyHelper(filter, "ActiveNode").Set(static_cast<vtkIdType>(node));
  vtkSMPropertyHelper(filter, "BodyNumber").Set(body);
  // The loop has already followed the node to this place.
  vtkSMPropertyHelper(filter, "StartDisplacement").Set(displacement, 3);
  vtkSMPropertyHelper(filter, "StartBranch").Set(branch);
  vtkSMPropertyHelper(filter, "Branch").Set(-1);
  vtkSMPropertyHelper(filter, "Displacement").Set(displacement, 3);
  // The loop has already torn it so far.
  vtkSMPropertyHelper(filter, "TornArea").Set(tornArea);
  vtkSMPropertyHelper(filter, "FractureToughness").Set(0.0);
  this->Take(filter, isKnown);
}

void pqPalpateBodyView::ShowPressed(const double* place, int branch, bool grew)
{
  vtkSMProxy* filter = this->Filter->getProxy();
  auto* object = grew ? vtkObject::SafeDownCast(filter->GetClientSideObject()) : nullptr;
  if (object)
  {
    object->Modified();
  }
  const bool isKnown = this->IsKnown();
  vtkSMPropertyHelper(filter, "ActiveNode").Set(static_cast<vtkIdType>(FirstOfSpace));
  vtkSMPropertyHelper(filter, "BodyNumber").Set(FirstBody);
  vtkSMPropertyHelper(filter, "ToolPosition").Set(place, 3);
  // The loop has already followed the tool to this place.
  vtkSMPropertyHelper(filter, "StartBranch").Set(-1);
  vtkSMPropertyHelper(filter, "Branch").Set(branch);
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
    // Whoever asks for ranges now gets the present ones.
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
    // From here on ParaView asks for everything again.
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
  this->Show(FirstOfSpace, FirstBody, findsItself, zero, 0);
}

void pqPalpateBodyView::Draw()
{
  if (!this->View)
  {
    return;
  }
  // The progress bar would be drawn anew for each frame.
  pqProgressManager* progress = pqApplicationCore::instance()->getProgressManager();
  progress->lockProgress(progress);
  const auto unlock = qScopeGuard([progress] { progress->unlockProgress(progress); });
  this->View->forceRender();
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
