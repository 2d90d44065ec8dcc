// SPDX-License-Identifier: BSD-3-Clause
/// A chart of the force at the device and that of the body, N, over the last seconds, s.
#pragma once

#include "QVTKOpenGLNativeWidget.h"

#include "vtkNew.h"

class vtkChartXY;
class vtkContextView;
class vtkFloatArray;
class vtkTable;

class pqPalpateForceGraph : public QVTKOpenGLNativeWidget
{
  Q_OBJECT
  typedef QVTKOpenGLNativeWidget Superclass;

public:
  explicit pqPalpateForceGraph(QWidget* parent = nullptr);
  ~pqPalpateForceGraph() override;

  QSize sizeHint() const override { return { 260, 150 }; }
  QSize minimumSizeHint() const override { return { 160, 110 }; }

  /// Empty.
  void clear();
  /// @param time The time since the start, s. It never decreases.
  void addSample(double time, double atDevice, double ofBody);

private:
  vtkNew<vtkContextView> View;
  vtkNew<vtkChartXY> Chart;
  vtkNew<vtkTable> Samples;
  vtkNew<vtkFloatArray> Time;
  vtkNew<vtkFloatArray> AtDevice;
  vtkNew<vtkFloatArray> OfBody;
  double Drawn = 0;
};
