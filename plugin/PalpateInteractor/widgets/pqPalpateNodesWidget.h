// SPDX-License-Identifier: BSD-3-Clause
/// The editor of a property that lists points of the filter's input by their ids. It has ParaView's
/// table of values, and a button after which one clicks points in the view. A click on a point of
/// the body adds its id, and another click on the same point removes it; a drag turns the camera as
/// usual. Meanwhile the body is shown in place of the filter's result, with the chosen points as
/// ParaView's selection.
///
/// In the XML of a property: panel_widget="palpate_nodes".
#pragma once

#include <QPointer>
#include <QVariant>
#include <vector>

#include "pqPropertyWidget.h"
#include "vtkNew.h"
#include "vtkSmartPointer.h"
#include "vtkWeakPointer.h"

class QLabel;
class QPushButton;
class pqOutputPort;
class pqRenderView;
class pqScalarValueListPropertyWidget;
class vtkObject;
class vtkRenderWindowInteractor;
class vtkStaticCellLocator;
class vtkUnstructuredGrid;

class pqPalpateNodesWidget : public pqPropertyWidget
{
  Q_OBJECT
  typedef pqPropertyWidget Superclass;

public:
  pqPalpateNodesWidget(vtkSMProxy* proxy, vtkSMProperty* property, QWidget* parent = nullptr);
  ~pqPalpateNodesWidget() override;

private:
  void startOrEnd(bool starts);
  /// Makes this filter active again, after ParaView has made active what was clicked or selected in
  /// the view.
  void activate();
  void start();
  void end();
  bool handleEvent(vtkObject* sender, unsigned long event, void*);
  void handle(unsigned long event);
  void pick(const int* pixel);
  /// The nearest point of the body that may be touched or is held; -1: there is none.
  vtkIdType nearest(const double* place) const;
  void toggle(vtkIdType node);
  /// The chosen points as ParaView's selection.
  void showChosen();
  /// The filter's input.
  pqOutputPort* body() const;

  pqScalarValueListPropertyWidget* List = nullptr;
  QPushButton* Button = nullptr;
  QLabel* Message = nullptr;
  /// The default values of the property. The first click replaces them.
  QVariantList Defaults;

  QPointer<pqRenderView> PickingView;
  QPointer<pqOutputPort> Body;
  vtkWeakPointer<vtkRenderWindowInteractor> Interactor;
  /// The client's copy of the body. ParaView's own selection does not know the points of quadratic
  /// cells that it has drawn.
  vtkSmartPointer<vtkUnstructuredGrid> Grid;
  vtkNew<vtkStaticCellLocator> Surface;
  std::vector<unsigned long> Observers;
  int Pressed[2] = { 0, 0 };
  /// Whether body and result were visible before.
  bool BodyWasSeen = false;
  bool ResultWasSeen = false;
};
