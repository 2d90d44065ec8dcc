// SPDX-License-Identifier: BSD-3-Clause
/// What is drawn over the body: the active nodes, the tool, and the force on it as an arrow. Plain
/// actors of the client's own, beside ParaView's representations: they follow without a pipeline,
/// and tool and arrow are seen through the body.
#pragma once

#include "haptic/servo/tick.h"
#include "vtkNew.h"
#include "vtkPalpateStateSpace.h"
#include "vtkWeakPointer.h"

class vtkActor;
class vtkRenderer;
class vtkSMRenderViewProxy;

class pqPalpateToolView
{
public:
  pqPalpateToolView(vtkSMRenderViewProxy* view, const palpate::TouchSpace& space);
  ~pqPalpateToolView();
  pqPalpateToolView(const pqPalpateToolView&) = delete;
  void operator=(const pqPalpateToolView&) = delete;

  /// @param free The tool is drawn where it touches nothing, too.
  void Show(const palpate::Tick& tick, bool free);

private:
  vtkWeakPointer<vtkRenderer> Renderer;
  vtkNew<vtkActor> Nodes;
  vtkNew<vtkActor> Tool;
  vtkNew<vtkActor> Arrow;
  /// Length of the arrow for a newton of the body, m.
  double ArrowScale = 0;
};
