// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateAbort.h"

#include <QApplication>
#include <QEvent>
#include <QScopedValueRollback>
#include <QStringList>

#include "pqApplicationCore.h"
#include "pqCoreUtilities.h"
#include "pqPipelineSource.h"
#include "pqProgressManager.h"
#include "pqProgressWidget.h"
#include "pqServerManagerModel.h"
#include "vtkAlgorithm.h"
#include "vtkCommand.h"
#include "vtkSMProxy.h"

namespace
{
/// Filters that tell their progress while they work, and hear there that they shall end.
const QStringList Aborts = { "AccuracyReport", "BuildReducedModel", "PrecomputeStateSpace",
  "SimulateTouch", "SolveDynamics", "SolveEquilibrium", "TetrahedralizeLabelMap",
  "TetrahedralizeSurface" };

pqProgressManager* Progress()
{
  return pqApplicationCore::instance()->getProgressManager();
}

bool IsInput(const QEvent* event)
{
  switch (event->type())
  {
    case QEvent::MouseButtonPress:
    case QEvent::MouseButtonRelease:
    case QEvent::MouseButtonDblClick:
    case QEvent::MouseMove:
    case QEvent::Wheel:
    case QEvent::KeyPress:
    case QEvent::KeyRelease:
    case QEvent::Shortcut:
    case QEvent::ShortcutOverride:
    case QEvent::ContextMenu:
    case QEvent::Drop:
      return true;
    default:
      return false;
  }
}
}

pqPalpateAbort::pqPalpateAbort(QObject* parent)
  : QObject(parent)
{
  pqServerManagerModel* model = pqApplicationCore::instance()->getServerManagerModel();
  QObject::connect(model, &pqServerManagerModel::sourceAdded, this, &pqPalpateAbort::watch);
  for (pqPipelineSource* source : model->findItems<pqPipelineSource*>())
  {
    this->watch(source);
  }
  // ParaView 6 no longer tells others of it by its manager of progress.
  if (auto* bar = pqCoreUtilities::mainWidget()->findChild<pqProgressWidget*>())
  {
    QObject::connect(bar, &pqProgressWidget::abortPressed, this,
      [this]
      {
        if (this->Working)
        {
          this->Working->SetAbortExecute(1);
        }
      });
  }
}

void pqPalpateAbort::watch(pqPipelineSource* source)
{
  auto* filter = vtkAlgorithm::SafeDownCast(source->getProxy()->GetClientSideObject());
  if (filter && Aborts.contains(source->getProxy()->GetXMLName()))
  {
    filter->AddObserver(vtkCommand::StartEvent, this, &pqPalpateAbort::beginWork);
    filter->AddObserver(vtkCommand::ProgressEvent, this, &pqPalpateAbort::handleEvents);
    filter->AddObserver(vtkCommand::EndEvent, this, &pqPalpateAbort::endWork);
  }
}

void pqPalpateAbort::beginWork(vtkObject* filter, unsigned long, void*)
{
  if (!Progress()->isLocked())
  {
    this->Working = vtkAlgorithm::SafeDownCast(filter);
    Progress()->setEnableAbort(true);
    // Not only while events are handled here: ParaView 6 handles some too.
    QApplication::instance()->installEventFilter(this);
  }
}

void pqPalpateAbort::handleEvents(vtkObject*, unsigned long, void*)
{
  if (this->IsHandling || !this->Working)
  {
    return;
  }
  const QScopedValueRollback<bool> handling(this->IsHandling, true);
  // ParaView's own filter would also keep from the window what is meant for the button.
  const bool unblocked = Progress()->unblockEvents(true);
  QApplication::processEvents();
  Progress()->unblockEvents(unblocked);
}

void pqPalpateAbort::endWork(vtkObject*, unsigned long, void*)
{
  if (this->Working)
  {
    QApplication::instance()->removeEventFilter(this);
    this->Working = nullptr;
    Progress()->setEnableAbort(false);
  }
}

// Of what the person does, only the button is heard, and what passes through the window to filters
// that were installed before: anything else might take away what works.
bool pqPalpateAbort::eventFilter(QObject* object, QEvent* event)
{
  if (event->type() == QEvent::Close)
  {
    event->ignore();
    return true;
  }
  // A window passes on to its widgets what it gets.
  return IsInput(event) && !object->inherits("QWidgetWindow") &&
    !Progress()->nonBlockableObjects().contains(object);
}
