// SPDX-License-Identifier: BSD-3-Clause
/// The editor of the property Regions of Assign Material. A table has a row for each value of the
/// region array, with its law and the law's parameters; a button makes the rows for the values that
/// the body has.
///
/// In the XML of a property: panel_widget="palpate_materials".
#pragma once

#include <QVariant>

#include "pqPropertyWidget.h"

class QLabel;
class QTableWidget;

class pqPalpateMaterialsWidget : public pqPropertyWidget
{
  Q_OBJECT
  /// The cells of the table, row by row, as text.
  Q_PROPERTY(QList<QVariant> rows READ rows WRITE setRows NOTIFY rowsChanged)
  typedef pqPropertyWidget Superclass;

public:
  pqPalpateMaterialsWidget(vtkSMProxy* proxy, vtkSMProperty* property, QWidget* parent = nullptr);
  ~pqPalpateMaterialsWidget() override;

  QList<QVariant> rows() const;
  void setRows(const QList<QVariant>& rows);

Q_SIGNALS:
  void rowsChanged();

private:
  void addRow(const QString& value, const QString& law, const QString& parameters);
  void removeRow();
  /// Adds the values of the region array that have no row.
  void addValues();
  int rowOfCombo(QObject* combo) const;

  QTableWidget* Table = nullptr;
  QLabel* Message = nullptr;
};
