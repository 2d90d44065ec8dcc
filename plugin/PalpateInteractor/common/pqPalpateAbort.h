// SPDX-License-Identifier: BSD-3-Clause
/// Lets the button of ParaView's progress bar abort the long work of our filters. ParaView shows
/// their progress, but before version 6 it handles no event meanwhile, so that the button is not
/// heard.
///
/// This works only for filters of this process: a server elsewhere hears nothing while it works.
#pragma once

#include <QObject>

#include "vtkWeakPointer.h"

class pqPipelineSource;
class vtkAlgorithm;
class vtkObject;

class pqPalpateAbort : public QObject
{
  Q_OBJECT
public:
  explicit pqPalpateAbort(QObject* parent = nullptr);

protected:
  bool eventFilter(QObject* object, QEvent* event) override;

private:
  void watch(pqPipelineSource* source);
  void beginWork(vtkObject* filter, unsigned long, void*);
  void handleEvents(vtkObject*, unsigned long, void*);
  void endWork(vtkObject*, unsigned long, void*);

  vtkWeakPointer<vtkAlgorithm> Working;
  bool IsHandling = false;
};
