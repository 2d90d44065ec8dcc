// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateMaterialsWidget.h"

#include <QComboBox>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QPushButton>
#include <QSignalBlocker>
#include <QTableWidget>
#include <QVBoxLayout>
#include <exception>
#include <set>

#include "pqApplicationCore.h"
#include "pqOutputPort.h"
#include "pqPalpateFetch.h"
#include "pqServerManagerModel.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkPalpateAssignMaterial.h"
#include "vtkSMOutputPort.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMUncheckedPropertyHelper.h"
#include "vtkUnstructuredGrid.h"

namespace
{
enum Column
{
  Value,
  Law,
  Parameters,
  NumberOfColumns
};

/// An array with more different values is not taken for one of regions.
constexpr std::size_t MostValues = 200;
constexpr int VisibleRows = 4;
constexpr const char* FirstLaw = "Neo-Hookean";
}

pqPalpateMaterialsWidget::pqPalpateMaterialsWidget(
  vtkSMProxy* proxy, vtkSMProperty* property, QWidget* parent)
  : Superclass(proxy, parent)
{
  this->setShowLabel(false);
  this->setChangeAvailableAsChangeFinished(true);
  this->Table = new QTableWidget(0, NumberOfColumns, this);
  this->Table->setObjectName("materials");
  this->Table->setHorizontalHeaderLabels({ "Value", "Law", "Parameters" });
  this->Table->verticalHeader()->hide();
  this->Table->horizontalHeader()->setSectionResizeMode(Value, QHeaderView::ResizeToContents);
  this->Table->horizontalHeader()->setSectionResizeMode(Law, QHeaderView::ResizeToContents);
  this->Table->horizontalHeader()->setSectionResizeMode(Parameters, QHeaderView::Stretch);
  this->Table->verticalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
  this->Table->setWordWrap(true);
  this->Table->setMinimumHeight(
    (VisibleRows + 1) * this->Table->verticalHeader()->defaultSectionSize());
  auto* values = new QPushButton("Values of the Body", this);
  values->setObjectName("values");
  values->setToolTip("Adds a row for each value of the region array that has none.");
  auto* add = new QPushButton("Add", this);
  add->setObjectName("add");
  auto* remove = new QPushButton("Remove", this);
  remove->setObjectName("remove");
  this->Message = new QLabel(this);
  this->Message->setObjectName("message");
  this->Message->setWordWrap(true);
  this->Message->hide();
  auto* buttons = new QHBoxLayout();
  buttons->addWidget(values);
  buttons->addWidget(add);
  buttons->addWidget(remove);
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->addWidget(this->Table);
  column->addLayout(buttons);
  column->addWidget(this->Message);
  QObject::connect(
    this->Table, &QTableWidget::cellChanged, this, &pqPalpateMaterialsWidget::rowsChanged);
  QObject::connect(values, &QPushButton::clicked, this, &pqPalpateMaterialsWidget::addValues);
  QObject::connect(add, &QPushButton::clicked, this,
    [this]
    {
      this->addRow("0", FirstLaw, vtkPalpateAssignMaterial::ParametersOfLaw(FirstLaw).c_str());
      Q_EMIT this->rowsChanged();
    });
  QObject::connect(remove, &QPushButton::clicked, this, &pqPalpateMaterialsWidget::removeRow);
  this->addPropertyLink(this, "rows", SIGNAL(rowsChanged()), property);
}

pqPalpateMaterialsWidget::~pqPalpateMaterialsWidget() = default;

QList<QVariant> pqPalpateMaterialsWidget::rows() const
{
  QList<QVariant> all;
  for (int row = 0; row < this->Table->rowCount(); ++row)
  {
    all.push_back(this->Table->item(row, Value)->text());
    all.push_back(qobject_cast<QComboBox*>(this->Table->cellWidget(row, Law))->currentText());
    all.push_back(this->Table->item(row, Parameters)->text());
  }
  return all;
}

void pqPalpateMaterialsWidget::setRows(const QList<QVariant>& rows)
{
  if (rows == this->rows())
  {
    return;
  }
  this->Table->setRowCount(0);
  for (int i = 0; i + NumberOfColumns <= rows.size(); i += NumberOfColumns)
  {
    this->addRow(
      rows[i + Value].toString(), rows[i + Law].toString(), rows[i + Parameters].toString());
  }
  Q_EMIT this->rowsChanged();
}

void pqPalpateMaterialsWidget::addRow(
  const QString& value, const QString& law, const QString& parameters)
{
  const QSignalBlocker blocker(this->Table);
  const int row = this->Table->rowCount();
  this->Table->insertRow(row);
  this->Table->setItem(row, Value, new QTableWidgetItem(value));
  this->Table->setItem(row, Parameters, new QTableWidgetItem(parameters));
  auto* laws = new QComboBox(this->Table);
  // The parameters need the room more than the longest name of a law.
  laws->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  laws->setMinimumContentsLength(9);
  for (const std::string& name : vtkPalpateAssignMaterial::LawNames())
  {
    laws->addItem(name.c_str());
  }
  if (laws->findText(law) < 0)
  {
    // An unknown law is shown as it is; the filter says that there is none.
    laws->addItem(law);
  }
  laws->setCurrentText(law);
  this->Table->setCellWidget(row, Law, laws);
  QObject::connect(laws, QOverload<int>::of(&QComboBox::currentIndexChanged), this,
    [this, laws](int)
    {
      const int changed = this->rowOfCombo(laws);
      if (changed >= 0)
      {
        const QSignalBlocker quiet(this->Table);
        this->Table->item(changed, Parameters)
          ->setText(
            vtkPalpateAssignMaterial::ParametersOfLaw(laws->currentText().toStdString()).c_str());
      }
      Q_EMIT this->rowsChanged();
    });
}

int pqPalpateMaterialsWidget::rowOfCombo(QObject* combo) const
{
  for (int row = 0; row < this->Table->rowCount(); ++row)
  {
    if (this->Table->cellWidget(row, Law) == combo)
    {
      return row;
    }
  }
  return -1;
}

void pqPalpateMaterialsWidget::removeRow()
{
  const int row =
    this->Table->currentRow() >= 0 ? this->Table->currentRow() : this->Table->rowCount() - 1;
  if (row >= 0)
  {
    this->Table->removeRow(row);
    Q_EMIT this->rowsChanged();
  }
}

void pqPalpateMaterialsWidget::addValues()
{
  const auto say = [this](const QString& text)
  {
    this->Message->setText(text);
    this->Message->setVisible(!text.isEmpty());
  };
  say("");
  // This is the choice in the panel, which need not be applied yet.
  const QString name = vtkSMUncheckedPropertyHelper(this->proxy(), "RegionArray").GetAsString(0);
  vtkSMOutputPort* input = vtkSMPropertyHelper(this->proxy(), "Input", true).GetAsOutputPort();
  auto* port = input
    ? pqApplicationCore::instance()->getServerManagerModel()->findItem<pqOutputPort*>(input)
    : nullptr;
  std::set<double> found;
  try
  {
    const auto body = port ? pqPalpateFetchBody(port) : nullptr;
    vtkDataArray* array = body ? body->GetCellData()->GetArray(name.toUtf8().constData()) : nullptr;
    if (!array)
    {
      say("Choose a Region Array of the body first.");
      return;
    }
    for (vtkIdType cell = 0; cell < array->GetNumberOfTuples() && found.size() <= MostValues;
         ++cell)
    {
      found.insert(array->GetComponent(cell, 0));
    }
  }
  catch (const std::exception& error)
  {
    say(error.what());
    return;
  }
  if (found.size() > MostValues)
  {
    say(QString("The array %1 has more than %2 values. Choose one that tells regions apart.")
          .arg(name)
          .arg(MostValues));
    return;
  }
  for (int row = 0; row < this->Table->rowCount(); ++row)
  {
    found.erase(this->Table->item(row, Value)->text().toDouble());
  }
  for (const double value : found)
  {
    this->addRow(QString::number(value, 'g', 15), FirstLaw,
      vtkPalpateAssignMaterial::ParametersOfLaw(FirstLaw).c_str());
  }
  if (!found.empty())
  {
    Q_EMIT this->rowsChanged();
  }
}
