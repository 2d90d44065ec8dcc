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
/// The filters that report their progress while they work, and learn from that call that they are
/// to abort.
const QStringList Aborts = { "AccuracyReport", "BuildReducedModel", "PrecomputeStateSpace",
  "RefineMesh", "SimulateTouch", "SolveDynamics", "SolveEquilibrium", "TetrahedralizeLabelMap",
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
  // In ParaView 6 the progress manager no longer signals the button.
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
    // The filter of events stays installed all the time, because ParaView 6 handles some events too
    // while filters work.
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
  // ParaView's own event filter would also keep from the window the events that are meant for the
  // button.
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

// Of the person's input, only that of the button is let through, and what the window passes on to
// event filters that were installed before. Any other input might delete what is working.
bool pqPalpateAbort::eventFilter(QObject* object, QEvent* event)
{
  if (event->type() == QEvent::Close)
  {
    event->ignore();
    return true;
  }
  // A window passes the events that it gets on to its widgets.
  return IsInput(event) && !object->inherits("QWidgetWindow") &&
    !Progress()->nonBlockableObjects().contains(object);
}
