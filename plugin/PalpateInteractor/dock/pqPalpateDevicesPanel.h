// SPDX-License-Identifier: BSD-3-Clause
/// Which device moves which tool. A state space has one tool, and a list of devices; a reduced
/// model has a table with a row and a list for each of its tools, which shows their figures too.
#pragma once

#include <QObject>
#include <QString>
#include <QVector>

#include "pqPalpateReducedTouch.h"

class QComboBox;
class QFormLayout;
class QGroupBox;
class QPushButton;
class QTableWidget;

class pqPalpateDevicesPanel : public QObject
{
  Q_OBJECT
public:
  explicit pqPalpateDevicesPanel(QObject* parent);

  /// Makes the row with the list.
  void addList(QFormLayout* form);
  /// Makes the table in its group.
  void addTable(QGroupBox* group);

  /// Looks for devices. They are opened for that, which must not happen while one touches.
  /// @return What is wrong with those that cannot be opened; empty: nothing.
  QString listDevices();
  /// Shows the list, and hides the table.
  void listOneTool();
  /// Shows the table of so many tools of a reduced model, which keep their devices, and hides the
  /// list.
  void listTools(int number);
  void setRunning(bool runs);

  /// The device of the list, as in pqPalpateDevices.h.
  QString device() const;
  /// The device of each tool in the table; empty: none.
  QVector<QString> devicesOfTools() const;
  /// Shows that a tool has a device, and emits nothing. @param device Empty: none.
  void showDevice(int tool, const QString& device);
  /// Why the chosen device cannot move the tool, which is that another tool has the device; empty:
  /// it can.
  QString whyTaken(int tool) const;
  /// Whether any of the devices that are shown has a button.
  bool hasButton() const;
  /// Whether any of the devices that are shown is a real one.
  bool hasRealDevice() const;

  void showFigures(const QVector<pqPalpateReducedTouch::ToolFigures>& figures);
  void showClosed();

Q_SIGNALS:
  /// Emitted when a person wants devices to be looked for again.
  void refreshed();
  /// Emitted when another device is chosen in the list.
  void deviceChanged();
  /// Emitted when another device is chosen in the table, also while the body is touched.
  void deviceOfToolChanged(int tool);

private:
  void showTable(bool shown);
  void makeRows(int number);
  bool hasDevice(bool (*is)(const QComboBox* devices)) const;

  QComboBox* Device = nullptr;
  QPushButton* Refresh = nullptr;
  QGroupBox* Group = nullptr;
  QTableWidget* Tools = nullptr;
  QVector<QComboBox*> DeviceOfTool;
  bool IsTable = false;
};
