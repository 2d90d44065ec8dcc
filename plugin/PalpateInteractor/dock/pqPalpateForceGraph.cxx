// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateForceGraph.h"

#include <algorithm>
#include <utility>

#include "vtkAxis.h"
#include "vtkChartLegend.h"
#include "vtkChartXY.h"
#include "vtkContextScene.h"
#include "vtkContextView.h"
#include "vtkFloatArray.h"
#include "vtkGenericOpenGLRenderWindow.h"
#include "vtkPlot.h"
#include "vtkTable.h"
#include "vtkTextProperty.h"

namespace
{
constexpr double Seconds = 10;
/// The time between two redraws. A redraw costs as much as a few lines of text, and the eye needs
/// no more of them.
constexpr double RedrawInterval = 0.2; // s
constexpr vtkIdType MostSamples = 1024;
constexpr int GraphFontSize = 10;
}

pqPalpateForceGraph::pqPalpateForceGraph(QWidget* parent)
  : Superclass(parent)
{
  vtkNew<vtkGenericOpenGLRenderWindow> window;
  window->SetMultiSamples(0);
  this->setRenderWindow(window);
  this->View->SetRenderWindow(window);
  this->View->GetScene()->AddItem(this->Chart);

  this->Time->SetName("Time");
  this->AtDevice->SetName("Device");
  this->OfBody->SetName("Body");
  this->Samples->AddColumn(this->Time);
  this->Samples->AddColumn(this->AtDevice);
  this->Samples->AddColumn(this->OfBody);
  constexpr unsigned char colours[][3] = { { 204, 26, 26 }, { 40, 70, 120 } };
  for (int column = 1; column <= 2; ++column)
  {
    vtkPlot* line = this->Chart->AddPlot(vtkChart::LINE);
    line->SetInputData(this->Samples, 0, column);
    line->SetColor(colours[column - 1][0], colours[column - 1][1], colours[column - 1][2], 255);
    line->SetWidth(1.5);
  }
  this->Chart->SetShowLegend(true);
  this->Chart->GetLegend()->GetLabelProperties()->SetFontSize(GraphFontSize);
  for (const auto& [axis, title] :
    { std::pair(vtkAxis::LEFT, "Force (N)"), std::pair(vtkAxis::BOTTOM, "Time (s)") })
  {
    this->Chart->GetAxis(axis)->SetTitle(title);
    this->Chart->GetAxis(axis)->GetTitleProperties()->SetFontSize(GraphFontSize);
    this->Chart->GetAxis(axis)->GetLabelProperties()->SetFontSize(GraphFontSize);
  }
  this->clear();
}

pqPalpateForceGraph::~pqPalpateForceGraph() = default;

void pqPalpateForceGraph::clear()
{
  // A chart complains of a line with less than two points.
  this->Samples->SetNumberOfRows(0);
  this->addSample(0, 0, 0);
  this->Drawn = -RedrawInterval;
  this->addSample(0, 0, 0);
}

void pqPalpateForceGraph::addSample(double time, double atDevice, double ofBody)
{
  this->Time->InsertNextValue(static_cast<float>(time));
  this->AtDevice->InsertNextValue(static_cast<float>(atDevice));
  this->OfBody->InsertNextValue(static_cast<float>(ofBody));
  if (time < this->Drawn + RedrawInterval)
  {
    return;
  }
  this->Drawn = time;
  constexpr vtkIdType fewest = 2;
  while (this->Samples->GetNumberOfRows() > MostSamples ||
    (this->Samples->GetNumberOfRows() > fewest && this->Time->GetValue(0) < time - Seconds))
  {
    this->Samples->RemoveRow(0);
  }
  this->Samples->Modified();
  vtkAxis* bottom = this->Chart->GetAxis(vtkAxis::BOTTOM);
  bottom->SetBehavior(vtkAxis::FIXED);
  bottom->SetRange(std::max(0.0, time - Seconds), std::max(Seconds, time));
  this->Chart->RecalculateBounds();
  if (this->isVisible())
  {
    this->renderWindow()->Render();
  }
}
