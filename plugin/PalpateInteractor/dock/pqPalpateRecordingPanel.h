// SPDX-License-Identifier: BSD-3-Clause
/// Whether and where the ticks are recorded, and how many are.
#pragma once

#include <QObject>
#include <QString>

class QCheckBox;
class QFormLayout;
class QLabel;
class pqFileChooserWidget;

class pqPalpateRecordingPanel : public QObject
{
  Q_OBJECT
public:
  pqPalpateRecordingPanel(QFormLayout* form, QObject* parent);

  bool records() const;
  /// The file of the next recording; empty: none was named.
  QString file() const;
  void setRunning(bool runs);
  void clear();
  /// Shows what is recorded so far, where there is a recording.
  void showTicks(quint64 ticks, quint64 missing);
  /// Shows a recording that is closed. @param fault Why it is not complete; empty: it is.
  void showFile(const QString& file, quint64 ticks, const QString& fault);

private:
  QCheckBox* Records = nullptr;
  pqFileChooserWidget* RecordingFile = nullptr;
  QLabel* Recorded = nullptr;
};
