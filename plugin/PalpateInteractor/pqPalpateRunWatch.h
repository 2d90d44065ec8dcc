// SPDX-License-Identifier: BSD-3-Clause
/// Sees why touching has to end: the space, the view or the server goes, ParaView quits, or a
/// person presses Escape, wherever in ParaView's windows that is, whatever else it does there, and
/// while they handle no event.
#pragma once

#include <QObject>
#include <QPointer>
#include <QString>
#include <functional>
#include <memory>

#include "vtkWeakPointer.h"

class pqOutputPort;
class pqPalpateEscape;
class pqPipelineSource;
class pqRenderView;
class pqServer;
class vtkSMSession;

class pqPalpateRunWatch : public QObject
{
  Q_OBJECT
public:
  explicit pqPalpateRunWatch(QObject* parent = nullptr);
  ~pqPalpateRunWatch() override;

  /// What of the pipeline is still there when it ends.
  enum class Left
  {
    Nothing,
    View,
    All
  };

  /// @param filter It shows what is touched.
  /// @param letGo Zero force: called on another thread, while the windows handle no event.
  void begin(pqOutputPort* touched, pqRenderView* view, pqPipelineSource* filter,
    std::function<void()> letGo);
  void end();

  /// Call this in each frame.
  /// @return Whether Escape was pressed while the windows handled no event.
  bool hearsEscape();

Q_SIGNALS:
  /// @param why Empty where it was asked for.
  void mustEnd(const QString& why, Left left);

protected:
  bool eventFilter(QObject* object, QEvent* event) override;

private:
  void loseServer(pqServer* server);
  void loseConnection();

  bool IsWatching = false;
  QPointer<pqPipelineSource> Source;
  QPointer<pqPipelineSource> Filter;
  QPointer<pqRenderView> View;
  vtkWeakPointer<vtkSMSession> Connection;
  unsigned long ConnectionObserver = 0;
  std::unique_ptr<pqPalpateEscape> Escape;
};
