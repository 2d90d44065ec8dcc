// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateRecordingPanel.h"

#include <QCheckBox>
#include <QDir>
#include <QFormLayout>
#include <QLabel>

#include "pqFileChooserWidget.h"
#include "pqPalpateDockParts.h"

pqPalpateRecordingPanel::pqPalpateRecordingPanel(QFormLayout* form, QObject* parent)
  : QObject(parent)
{
  this->Records = pqPalpateNamed(new QCheckBox("Every tick"), "records",
    "Writes what the device says and what it is sent into a table that ParaView opens, and that "
    "palpate-servo replays.");
  this->RecordingFile = pqPalpateNamed(new pqFileChooserWidget(), "recordingFile",
    "A new file is made at each start: run.csv, run-2.csv, …");
  // The loop runs on the client, and its recording is written there.
  this->RecordingFile->setServer(nullptr);
  this->RecordingFile->setForceSingleFile(true);
  this->RecordingFile->setAcceptAnyFile(true);
  this->RecordingFile->setExtension("Recordings (*.csv)");
  this->RecordingFile->setSingleFilename(QDir::home().filePath("touch.csv"));
  this->RecordingFile->setEnabled(false);
  this->Recorded = pqPalpateNamed(new QLabel(), "recorded");
  this->Recorded->setWordWrap(true);
  form->addRow("Record", this->Records);
  form->addRow("File", this->RecordingFile);
  form->addRow(this->Recorded);
  QObject::connect(this->Records, &QCheckBox::toggled, this,
    [this](bool records) { this->RecordingFile->setEnabled(records); });
}

bool pqPalpateRecordingPanel::records() const
{
  return this->Records->isChecked();
}

QString pqPalpateRecordingPanel::file() const
{
  return this->RecordingFile->singleFilename();
}

void pqPalpateRecordingPanel::setRunning(bool runs)
{
  this->Records->setEnabled(!runs);
  this->RecordingFile->setEnabled(!runs && this->records());
}

void pqPalpateRecordingPanel::clear()
{
  this->Recorded->clear();
}

void pqPalpateRecordingPanel::showTicks(quint64 ticks, quint64 missing)
{
  if (this->records())
  {
    this->Recorded->setText(QString("%1 ticks%2")
                              .arg(ticks)
                              .arg(missing > 0 ? QString(", %1 missing").arg(missing) : QString()));
  }
}

void pqPalpateRecordingPanel::showFile(const QString& file, quint64 ticks, const QString& fault)
{
  this->Recorded->setText(
    QString("%1 ticks in %2%3").arg(ticks).arg(file, fault.isEmpty() ? "" : ". " + fault));
}
