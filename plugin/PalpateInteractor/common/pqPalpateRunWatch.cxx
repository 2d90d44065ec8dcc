// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateRunWatch.h"

#include <QCoreApplication>
#include <QKeyEvent>
#include <utility>

#include "pqApplicationCore.h"
#include "pqOutputPort.h"
#include "pqPalpateEscape.h"
#include "pqPipelineSource.h"
#include "pqRenderView.h"
#include "pqServer.h"
#include "pqServerManagerModel.h"
#include "vtkLogger.h"
#include "vtkSMSession.h"

namespace
{
constexpr float ConnectionPriority = 100;
}

pqPalpateRunWatch::pqPalpateRunWatch(QObject* parent)
  : QObject(parent)
{
  pqServerManagerModel* model = pqApplicationCore::instance()->getServerManagerModel();
  QObject::connect(model, &pqServerManagerModel::preSourceRemoved, this,
    [this](pqPipelineSource* source)
    {
      if (this->IsWatching && (source == this->Source || source == this->Filter))
      {
        Q_EMIT this->mustEnd("The state space, or what shows it, was deleted.", Left::View);
      }
    });
  QObject::connect(model, &pqServerManagerModel::preViewRemoved, this,
    [this](pqView* view)
    {
      if (this->IsWatching && view == this->View)
      {
        Q_EMIT this->mustEnd("The view was closed.", Left::Nothing);
      }
    });
  QObject::connect(
    model, &pqServerManagerModel::aboutToRemoveServer, this, &pqPalpateRunWatch::loseServer);
  QObject::connect(
    model, &pqServerManagerModel::preServerRemoved, this, &pqPalpateRunWatch::loseServer);
  QObject::connect(QCoreApplication::instance(), &QCoreApplication::aboutToQuit, this,
    [this] { Q_EMIT this->mustEnd({}, Left::Nothing); });
}

pqPalpateRunWatch::~pqPalpateRunWatch()
{
  this->end();
}

void pqPalpateRunWatch::begin(
  pqOutputPort* touched, pqRenderView* view, pqPipelineSource* filter, std::function<void()> letGo)
{
  this->end();
  this->Source = touched->getSource();
  this->View = view;
  this->Filter = filter;
  // ParaView opens a dialog when the connection is lost, and the device would be left alone
  // meanwhile.
  this->Connection = touched->getServer()->session();
  this->ConnectionObserver = this->Connection->AddObserver(
    vtkPVSessionBase::ConnectionLost, this, &pqPalpateRunWatch::loseConnection, ConnectionPriority);
  // The event filter that was installed last is asked first.
  QCoreApplication::instance()->installEventFilter(this);
  this->Escape = std::make_unique<pqPalpateEscape>(std::move(letGo));
  this->IsWatching = true;
}

void pqPalpateRunWatch::end()
{
  if (!std::exchange(this->IsWatching, false))
  {
    return;
  }
  this->Escape.reset();
  QCoreApplication::instance()->removeEventFilter(this);
  if (this->Connection)
  {
    this->Connection->RemoveObserver(this->ConnectionObserver);
  }
}

bool pqPalpateRunWatch::hearsEscape()
{
  if (!this->Escape)
  {
    return false;
  }
  this->Escape->HearsItself();
  return this->Escape->WasPressed();
}

// Takes the key Escape before anybody else gets it. As a shortcut it would be ambiguous while one
// of ParaView's modes of selection has the same shortcut, and a dialog would keep it. The first
// event of a pressed key asks whether somebody wants it in place of a shortcut.
bool pqPalpateRunWatch::eventFilter(QObject* object, QEvent* event)
{
  if ((event->type() == QEvent::ShortcutOverride || event->type() == QEvent::KeyPress) &&
    static_cast<QKeyEvent*>(event)->key() == Qt::Key_Escape)
  {
    Q_EMIT this->mustEnd({}, Left::All);
  }
  return QObject::eventFilter(object, event);
}

void pqPalpateRunWatch::loseServer(pqServer* server)
{
  if (this->IsWatching && (!this->Source || this->Source->getServer() == server))
  {
    Q_EMIT this->mustEnd("The server was disconnected.", Left::Nothing);
  }
}

void pqPalpateRunWatch::loseConnection()
{
  Q_EMIT this->mustEnd("The connection to the server was lost.", Left::Nothing);
  // This is logged, because ParaView 5.13 ends at once, and its window with it.
  vtkLog(WARNING, "The connection to the server was lost: the tool is without force.");
}
