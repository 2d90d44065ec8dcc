// SPDX-License-Identifier: BSD-3-Clause
/// Notices that touching has to end: the space, the view or the server goes away, ParaView quits,
/// or a person presses Escape. Escape counts in all of ParaView's windows, whatever else it does
/// there, and also while they handle no event.
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

  /// The parts of the pipeline that are still there at the end.
  enum class Left
  {
    Nothing,
    View,
    All
  };

  /// @param filter The filter that shows what is touched.
  /// @param letGo It asks for zero force, and is called on another thread while the windows handle
  ///   no event.
  void begin(pqOutputPort* touched, pqRenderView* view, pqPipelineSource* filter,
    std::function<void()> letGo);
  void end();

  /// Call this in each frame.
  /// @return Whether Escape was pressed while the windows handled no event.
  bool hearsEscape();

Q_SIGNALS:
  /// @param why The reason; empty: a person asked for it.
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
