// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateDevicesPanel.h"

#include <QComboBox>
#include <QFormLayout>
#include <QGroupBox>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QPushButton>
#include <QSignalBlocker>
#include <QStandardItemModel>
#include <QTableWidget>
#include <QVBoxLayout>
#include <algorithm>
#include <utility>

#include "pqPalpateDevices.h"
#include "pqPalpateDockParts.h"

namespace
{
/// The role of an entry in the list of devices that says whether the device has a button.
constexpr int HasButtonRole = Qt::UserRole + 1;

/// The columns of the table of tools.
enum ToolColumns
{
  ToolColumn,
  DeviceColumn,
  ForceColumn,
  StateColumn,
  NumberOfToolColumns
};

bool HasButton(const QComboBox* devices)
{
  return devices->currentData(HasButtonRole).toBool();
}

bool IsReal(const QComboBox* devices)
{
  const QString device = devices->currentData().toString();
  return !device.isEmpty() && device != pqPalpateMouseDevice && device != pqPalpateHandDevice;
}
}

pqPalpateDevicesPanel::pqPalpateDevicesPanel(QObject* parent)
  : QObject(parent)
{
}

void pqPalpateDevicesPanel::addList(QFormLayout* form)
{
  this->Device = pqPalpateNamed(new QComboBox(), "device",
    "Mouse: press the left button on the body and drag, near a black dot where there is no rigid "
    "tool; the wheel goes in and out; with Ctrl first it moves the camera. Simulated hand: presses "
    "one place again and again.");
  this->Refresh = pqPalpateNamed(new QPushButton("Refresh"), "refresh", "Look for devices again.");
  pqPalpateKeepNarrow(this->Device);
  auto* devices = new QHBoxLayout();
  devices->addWidget(this->Device, 1);
  devices->addWidget(this->Refresh);
  form->addRow("Device", devices);
  QObject::connect(this->Refresh, &QPushButton::clicked, this, &pqPalpateDevicesPanel::refreshed);
  QObject::connect(this->Device, QOverload<int>::of(&QComboBox::currentIndexChanged), this,
    &pqPalpateDevicesPanel::deviceChanged);
}

void pqPalpateDevicesPanel::addTable(QGroupBox* group)
{
  this->Group = group;
  this->Tools = pqPalpateNamed(new QTableWidget(), "tools",
    "The tools of the reduced model. Each device has a loop of its own; they move one body. A tool "
    "that no device has moves with the body. A device that is chosen while the body is touched has "
    "the tool from then on, and the others go on.");
  this->Tools->setColumnCount(NumberOfToolColumns);
  this->Tools->setHorizontalHeaderLabels({ "Tool", "Device", "Force, N", "State" });
  this->Tools->verticalHeader()->hide();
  this->Tools->horizontalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
  // The tool tip has the full text of the state.
  this->Tools->horizontalHeader()->setSectionResizeMode(StateColumn, QHeaderView::Stretch);
  this->Tools->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  this->Tools->setSelectionMode(QAbstractItemView::NoSelection);
  this->Tools->setEditTriggers(QAbstractItemView::NoEditTriggers);
  (new QVBoxLayout(group))->addWidget(this->Tools);
}

QString pqPalpateDevicesPanel::listDevices()
{
  const QString chosen = this->device();
  this->Device->clear();
  auto* items = qobject_cast<QStandardItemModel*>(this->Device->model());
  QString faults;
  for (const pqPalpateDeviceName& device : pqPalpateListDevices())
  {
    this->Device->addItem(device.Name, device.Id);
    const int row = this->Device->count() - 1;
    this->Device->setItemData(row, device.HasButton, HasButtonRole);
    if (!device.Fault.isEmpty())
    {
      items->item(row)->setEnabled(false);
      this->Device->setItemData(row, device.Fault, Qt::ToolTipRole);
      faults += (faults.isEmpty() ? "" : "\n") + device.Name + ": " + device.Fault;
    }
  }
  const int index = this->Device->findData(chosen);
  this->Device->setCurrentIndex(index >= 0 ? index : 0);
  return faults;
}

void pqPalpateDevicesPanel::listOneTool()
{
  this->showTable(false);
  this->makeRows(0);
}

void pqPalpateDevicesPanel::listTools(int number)
{
  this->showTable(true);
  this->makeRows(number);
}

void pqPalpateDevicesPanel::showTable(bool shown)
{
  this->IsTable = shown;
  this->Group->setVisible(shown);
  this->Device->setVisible(!shown);
}

void pqPalpateDevicesPanel::makeRows(int number)
{
  QVector<QString> chosen = this->devicesOfTools();
  if (chosen.isEmpty())
  {
    chosen.push_back(pqPalpateMouseDevice);
  }
  // They are deleted at once, because the table would keep them until the next turn of the event
  // loop.
  qDeleteAll(this->DeviceOfTool);
  this->DeviceOfTool.clear();
  this->Tools->setRowCount(0);
  this->Tools->setRowCount(number);
  for (int tool = 0; tool < number; ++tool)
  {
    auto* devices = new QComboBox();
    pqPalpateKeepNarrow(devices);
    devices->setObjectName(QString("deviceOfTool%1").arg(tool));
    devices->addItem("None", QString());
    for (int i = 0; i < this->Device->count(); ++i)
    {
      devices->addItem(this->Device->itemText(i), this->Device->itemData(i));
      devices->setItemData(i + 1, this->Device->itemData(i, HasButtonRole), HasButtonRole);
      const bool isEnabled =
        qobject_cast<QStandardItemModel*>(this->Device->model())->item(i)->isEnabled();
      qobject_cast<QStandardItemModel*>(devices->model())->item(i + 1)->setEnabled(isEnabled);
    }
    devices->setCurrentIndex(
      std::max(0, devices->findData(tool < chosen.size() ? chosen[tool] : QString())));
    QObject::connect(devices, QOverload<int>::of(&QComboBox::currentIndexChanged), this,
      [this, tool] { Q_EMIT this->deviceOfToolChanged(tool); });
    this->DeviceOfTool.push_back(devices);
    this->Tools->setCellWidget(tool, DeviceColumn, devices);
    this->Tools->setItem(tool, ToolColumn, new QTableWidgetItem(QString::number(tool)));
    this->Tools->setItem(tool, ForceColumn, new QTableWidgetItem());
    this->Tools->setItem(tool, StateColumn, new QTableWidgetItem("closed"));
  }
  constexpr int mostRows = 6;
  const int rowHeight = this->Tools->verticalHeader()->defaultSectionSize();
  this->Tools->setFixedHeight(this->Tools->horizontalHeader()->sizeHint().height() +
    rowHeight * std::min(number, mostRows) + 2 * this->Tools->frameWidth());
}

void pqPalpateDevicesPanel::setRunning(bool runs)
{
  this->Refresh->setEnabled(!runs);
  this->Device->setEnabled(!runs);
}

QString pqPalpateDevicesPanel::device() const
{
  return this->Device->currentData().toString();
}

QVector<QString> pqPalpateDevicesPanel::devicesOfTools() const
{
  QVector<QString> chosen;
  for (const QComboBox* devices : this->DeviceOfTool)
  {
    chosen.push_back(devices->currentData().toString());
  }
  return chosen;
}

void pqPalpateDevicesPanel::showDevice(int tool, const QString& device)
{
  QComboBox* devices = this->DeviceOfTool[tool];
  const QSignalBlocker blocker(devices);
  devices->setCurrentIndex(std::max(0, devices->findData(device)));
}

QString pqPalpateDevicesPanel::whyTaken(int tool) const
{
  const QString device = this->DeviceOfTool[tool]->currentData().toString();
  if (device.isEmpty() || device == pqPalpateHandDevice)
  {
    return {};
  }
  for (int other = 0; other < this->DeviceOfTool.size(); ++other)
  {
    if (other != tool && this->DeviceOfTool[other]->currentData() == device)
    {
      return QString("%1 has tool %2: one device has one tool. Choose another device for tool %3.")
        .arg(this->DeviceOfTool[tool]->currentText())
        .arg(other)
        .arg(tool);
    }
  }
  return {};
}

bool pqPalpateDevicesPanel::hasDevice(bool (*is)(const QComboBox* devices)) const
{
  return this->IsTable ? std::any_of(this->DeviceOfTool.begin(), this->DeviceOfTool.end(), is)
                       : is(this->Device);
}

bool pqPalpateDevicesPanel::hasButton() const
{
  return this->hasDevice(HasButton);
}

bool pqPalpateDevicesPanel::hasRealDevice() const
{
  return this->hasDevice(IsReal);
}

void pqPalpateDevicesPanel::showFigures(const QVector<pqPalpateReducedTouch::ToolFigures>& figures)
{
  for (int tool = 0; tool < std::min<int>(figures.size(), this->Tools->rowCount()); ++tool)
  {
    const pqPalpateReducedTouch::ToolFigures& f = figures[tool];
    this->Tools->item(tool, ToolColumn)->setText(QString("%1 (%2)").arg(tool).arg(f.ActiveNode));
    this->Tools->item(tool, ForceColumn)->setText(QString::number(f.Force, 'f', 3));
    this->Tools->item(tool, ForceColumn)
      ->setToolTip(QString("%1 N at the device, %2 N of the body")
                     .arg(f.Force, 0, 'f', 3)
                     .arg(f.BodyForce, 0, 'f', 3));
    this->Tools->item(tool, StateColumn)->setText(f.State);
    this->Tools->item(tool, StateColumn)->setToolTip(f.State);
  }
}

void pqPalpateDevicesPanel::showClosed()
{
  for (int tool = 0; tool < this->Tools->rowCount(); ++tool)
  {
    this->Tools->item(tool, StateColumn)->setText("closed");
    this->Tools->item(tool, ForceColumn)->setText({});
  }
}
