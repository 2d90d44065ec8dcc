// SPDX-License-Identifier: BSD-3-Clause
/// What Apply will take, in the panel of a long filter: it follows what the panel shows, also what
/// is not applied yet, as a copy of the filter has that and is asked for its estimate.
///
/// In the XML of the property UpdateEstimate: panel_widget="palpate_estimate".
#pragma once

#include <QTimer>

#include "pqPropertyWidget.h"
#include "vtkSmartPointer.h"

class QLabel;
class vtkSMSourceProxy;

class pqPalpateEstimateWidget : public pqPropertyWidget
{
  Q_OBJECT
  typedef pqPropertyWidget Superclass;

public:
  pqPalpateEstimateWidget(vtkSMProxy* proxy, vtkSMProperty* property, QWidget* parent = nullptr);
  ~pqPalpateEstimateWidget() override;

protected:
  void showEvent(QShowEvent* event) override;

private Q_SLOTS:
  void changed();

private:
  /// Hears of all that a proxy has to choose, also within the proxies that it chooses among.
  void follow(vtkSMProxy* proxy);
  void estimate();

  QLabel* Text = nullptr;
  /// Runs while what was changed last may be changed on.
  QTimer Pause;
  vtkSmartPointer<vtkSMSourceProxy> Copy;
};
