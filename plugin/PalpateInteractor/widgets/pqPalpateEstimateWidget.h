// SPDX-License-Identifier: BSD-3-Clause
/// Shows in the panel of a long filter what Apply will take. The estimate follows the values in the
/// panel, also those that are not applied yet: a copy of the filter gets them and is asked for its
/// estimate.
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
  /// Observes all properties of a proxy, also those of the proxies that it chooses among.
  void follow(vtkSMProxy* proxy);
  void estimate();

  QLabel* Text = nullptr;
  /// Runs for a while after each change, in which the person may go on changing.
  QTimer Pause;
  vtkSmartPointer<vtkSMSourceProxy> Copy;
};
