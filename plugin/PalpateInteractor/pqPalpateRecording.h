// SPDX-License-Identifier: BSD-3-Clause
/// The recording of a servo loop that the dock runs.
#pragma once

#include <QString>

#include "haptic/recording/recorder.h"

namespace palpate
{
class Servo;
}

class pqPalpateRecording
{
public:
  /// @param name Of the file, or of one that is named after it where it is there already:
  ///   run-2.csv, run-3.csv, …
  /// @throws palpate::InputError it cannot be made.
  explicit pqPalpateRecording(const QString& name);

  /// Every tick from now on is in it.
  void Start(const palpate::RecordedSetup& setup, palpate::Servo& servo);
  /// @return Why it is not whole; empty: it is.
  QString Close();

  const QString& GetFile() const { return this->File; }
  quint64 GetWritten() const { return this->Recorder.written(); }
  quint64 GetDropped() const { return this->Recorder.dropped(); }

private:
  QString File;
  palpate::Recorder Recorder;
};
