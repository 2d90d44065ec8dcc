// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateCutNow.h"

#include <QDateTime>
#include <QFileInfo>
#include <QList>
#include <QMap>
#include <QString>
#include <stdexcept>
#include <string>
#include <vector>

#include "pqApplicationCore.h"
#include "pqObjectBuilder.h"
#include "pqOutputPort.h"
#include "pqPalpateFetch.h"
#include "pqPipelineSource.h"
#include "pqServerManagerModel.h"
#include "pqUndoStack.h"
#include "vtkSMInputProperty.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMSourceProxy.h"
#include "vtkSmartPointer.h"
#include "vtkUnstructuredGrid.h"

namespace
{
/// What Solve Equilibrium has in common with Precompute State Space.
constexpr const char* OfTool[] = { "Tool", "ToolSurface", "TipRadius", "BodyForce" };

using Inputs = QMap<QString, QList<pqOutputPort*>>;

/// A filter, as when a person makes it.
pqPipelineSource* MakeFilter(const char* name, const Inputs& inputs)
{
  pqObjectBuilder* builder = pqApplicationCore::instance()->getObjectBuilder();
  return builder->createFilter("filters", name, inputs, inputs.first().first()->getServer());
}

/// Has Solve Equilibrium hold the body as the tool of a space does.
void Hold(vtkSMProxy* solve, vtkSMProxy* precompute, const pqPalpateHeldTool& tool)
{
  for (const char* name : OfTool)
  {
    solve->GetProperty(name)->Copy(precompute->GetProperty(name));
  }
  if (tool.Node < 0)
  {
    vtkSMPropertyHelper(solve, "ToolPosition").Set(tool.Place.data(), 3);
    return;
  }
  vtkSMPropertyHelper(solve, "ActiveNodes").SetNumberOfElements(1);
  vtkSMPropertyHelper(solve, "ActiveNodes").Set(0, tool.Node);
  vtkSMPropertyHelper(solve, "Displacement").SetNumberOfElements(3);
  vtkSMPropertyHelper(solve, "Displacement").Set(tool.Place.data(), 3);
}

/// Runs a filter. @throws std::runtime_error it has failed.
void Run(pqPipelineSource* filter)
{
  vtkSMSourceProxy* proxy = filter->getSourceProxy();
  proxy->UpdateVTKObjects();
  proxy->UpdatePipeline();
  filter->setModifiedState(pqProxy::UNMODIFIED);
  proxy->UpdatePropertyInformation();
  if (proxy->GetProperty("ErrorCode") && vtkSMPropertyHelper(proxy, "ErrorCode").GetAsIdType() != 0)
  {
    throw std::runtime_error("The body cannot be cut there: see the message of " +
      filter->getSMName().toStdString() + ".");
  }
}

/// The name of a new file beside that of the space.
QString FileOfCut(const QString& name)
{
  if (name.isEmpty())
  {
    return name;
  }
  const QFileInfo file(name);
  const QString added =
    "_cut_" + QDateTime::currentDateTime().toString("yyyy-MM-dd_HH-mm-ss") + ".";
  const QString folder = name.left(name.size() - file.fileName().size());
  return folder + file.completeBaseName() + added + file.suffix();
}

/// What of Precompute State Space a cut changes.
struct BeforeCut
{
  explicit BeforeCut(vtkSMProxy* precompute)
    : Input(vtkSMInputProperty::SafeDownCast(precompute->GetProperty("Input")))
    , Source(this->Input->GetProxy(0))
    , Port(this->Input->GetOutputPortForConnection(0))
    , Nodes(vtkSMPropertyHelper(precompute, "ActiveNodes").GetIntArray())
    , File(vtkSMPropertyHelper(precompute, "FileName").GetAsString())
  {
  }

  void Restore(vtkSMProxy* precompute)
  {
    this->Input->SetInputConnection(0, this->Source, this->Port);
    if (!this->Nodes.empty())
    {
      vtkSMPropertyHelper(precompute, "ActiveNodes")
        .Set(this->Nodes.data(), static_cast<unsigned int>(this->Nodes.size()));
    }
    vtkSMPropertyHelper(precompute, "FileName").Set(this->File.c_str());
    precompute->UpdateVTKObjects();
  }

  vtkSMInputProperty* Input;
  vtkSMProxy* Source;
  unsigned int Port;
  std::vector<int> Nodes;
  std::string File;
};
}

void pqPalpateCutNow(pqOutputPort* space, pqOutputPort* sheet, const pqPalpateHeldTool& tool)
{
  pqPipelineSource* source = space->getSource();
  vtkSMSourceProxy* precompute = source->getSourceProxy();
  if (precompute->GetXMLName() != std::string("PrecomputeStateSpace"))
  {
    throw std::runtime_error("A body is cut where its space comes from Precompute State Space. One "
                             "that was read from a file has no body before it: make it again with "
                             "that filter.");
  }
  if (pqPalpateHasCut(space))
  {
    throw std::runtime_error("The space has the stages of a cut already, along which the body "
                             "tears. For another cut, set CutStages of Precompute State Space to "
                             "This Stage.");
  }
  BeforeCut whole(precompute);
  pqOutputPort* body = pqApplicationCore::instance()
                         ->getServerManagerModel()
                         ->findItem<pqPipelineSource*>(whole.Source)
                         ->getOutputPort(static_cast<int>(whole.Port));
  const vtkSmartPointer<vtkUnstructuredGrid> before = pqPalpateFetchBody(body);

  std::vector<pqPipelineSource*> made;
  bool isChanged = false;
  BEGIN_UNDO_SET("Cut Now");
  try
  {
    pqOutputPort* held = body;
    if (tool.Touches)
    {
      made.push_back(MakeFilter("SolveEquilibrium", { { "Input", { body } } }));
      Hold(made.back()->getProxy(), precompute, tool);
      Run(made.back());
      held = made.back()->getOutputPort(0);
    }
    made.push_back(MakeFilter("CutNow", { { "Input", { held } }, { "Sheet", { sheet } } }));
    pqPipelineSource* cut = made.back();
    Run(cut);

    const vtkSmartPointer<vtkUnstructuredGrid> after = pqPalpateFetchBody(cut->getOutputPort(0));
    isChanged = true;
    for (std::size_t k = 0; k < whole.Nodes.size(); ++k)
    {
      const vtkIdType nearest = after->FindPoint(before->GetPoint(whole.Nodes[k]));
      vtkSMPropertyHelper(precompute, "ActiveNodes")
        .Set(static_cast<unsigned int>(k), static_cast<int>(nearest));
    }
    const QString file = FileOfCut(QString::fromStdString(whole.File));
    vtkSMPropertyHelper(precompute, "FileName").Set(file.toUtf8().constData());
    whole.Input->SetInputConnection(0, cut->getProxy(), 0);
    Run(source);
  }
  catch (...)
  {
    if (isChanged)
    {
      whole.Restore(precompute);
    }
    for (auto filter = made.rbegin(); filter != made.rend(); ++filter)
    {
      pqApplicationCore::instance()->getObjectBuilder()->destroy(*filter);
    }
    END_UNDO_SET();
    throw;
  }
  END_UNDO_SET();
}
